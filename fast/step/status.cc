#include "fast/step/status.h"

namespace touchstone::fast {

std::string status_text(std::uint32_t status) {
  std::string text;
  const auto add = [&](StepStatus bit, const char* words) {
    if ((status & static_cast<std::uint32_t>(bit)) == 0) return;
    text += (text.empty() ? "" : ", ") + std::string(words);
  };
  add(StepStatus::not_finite, "pose not finite, last good answer held");
  add(StepStatus::depth_limited, "depth limited to half of the body's thickness");
  add(StepStatus::law_saturated, "contact law saturated at its peak");
  add(StepStatus::regions_full, "more contact regions than fast.max_regions, the smallest dropped");
  add(StepStatus::contact_missed,
      "contact missed: the tool is inside the body, no sample of it is (raise fast.tool_samples)");
  add(StepStatus::anchors_limited, "anchor displacement limited to that of the contact (raise fast.s_c_m2)");
  add(StepStatus::outside_grid, "outside the grid of the response");
  add(StepStatus::tip_exceeded, "deeper than the tool's tip is high");
  add(StepStatus::tilted, "a flat tip that does not lie flat");
  add(StepStatus::depth_unchecked, "deeper, over the tip's radius, than was compared with the reference");
  add(StepStatus::size_unchecked, "a larger contact, over the body's size, than was compared with the reference");
  add(StepStatus::edge_unchecked, "nearer to an edge, over the contact's radius, than was compared with the reference");
  add(StepStatus::regions_unchecked,
      "two contacts nearer to each other, over their radii, than were compared with the reference");
  add(StepStatus::curvature_unchecked,
      "a more curved body, over the tip's radius, than was compared with the reference");
  add(StepStatus::material_unchecked,
      "a Poisson's ratio below 0.5, not compared with the reference for this tool or with friction");
  add(StepStatus::inclusion_unchecked, "inclusions, which were not compared with the reference");
  return text.empty() ? "ok" : text;
}

}  // namespace touchstone::fast
