// "touchstone new": a first scene file from a few options.
#pragma once

#include "fast/command/command.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::fast {

struct NewOptions {
  std::filesystem::path file;
  std::vector<std::string> body, tool;  ///< shape and size
  std::string unit;                     ///< of a mesh tool's coordinates
  std::string youngs_modulus, depth, slide, title;
  double poissons_ratio = 0.0;
  std::string place;  ///< "10x5mm"
  std::optional<double> friction;
};

/// A length with its unit in metres: "3mm", "0.5cm", "0.06m", "200um", "2in". @throws scene::InputError
[[nodiscard]] double length_m(const std::string& text, const std::string& option);

/// Lengths joined by "x" or ",", the last unit for all that have none: "60x60x40mm". @throws scene::InputError
[[nodiscard]] std::vector<double> lengths_m(const std::string& text, const std::string& option);

/// A stress with its unit in pascals: "3MPa", "3e6Pa", "50kPa", "2GPa". @throws scene::InputError
[[nodiscard]] double stress_pa(const std::string& text, const std::string& option);

/// Writes the scene file. @returns an exit code; @throws scene::InputError, and then no file is written
[[nodiscard]] int write_new_scene(const NewOptions& options, const std::string& program);

Command add_new_verb(Command& program, NewOptions& options);

}  // namespace touchstone::fast
