// What a solver models of a scene, what it leaves out, and why: one line per part.
#pragma once

#include <string>
#include <vector>

namespace touchstone::scene {

struct PlanLine {
  std::string part;       ///< "friction", "quarter symmetry", "pressure unknowns"
  bool modelled = false;  ///< false: left out, and nothing is paid for it
  std::string reason;     ///< from the scene: "tool and track lie on both symmetry planes"
  std::string cost;       ///< expected, in words with units: "about 60,000 unknowns"; may be empty
};
using Plan = std::vector<PlanLine>;

}  // namespace touchstone::scene
