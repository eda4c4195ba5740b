#include "fast/step/status.h"

namespace touchstone::fast {

std::string status_text(std::uint32_t status) {
  std::string text;
  const auto add = [&](StepStatus bit, const char* words) {
    if ((status & static_cast<std::uint32_t>(bit)) == 0) return;
    text += (text.empty() ? "" : "; ") + std::string(words);
  };
  add(StepStatus::not_finite, "the tool's pose was not finite, and the last valid result was kept");
  add(StepStatus::depth_limited, "the tool was deeper than half of the body's thickness, and its depth was limited");
  add(StepStatus::law_saturated, "the depth exceeded the peak of the contact law, and the peak force was kept");
  add(StepStatus::regions_full,
      "there were more contact regions than fast.max_regions, and the smallest were left out");
  add(StepStatus::contact_missed,
      "the tool was inside the body but none of its samples was, so there was no force (raise fast.tool_samples)");
  add(StepStatus::anchors_limited,
      "the beams were too soft for the force, and the displacement of an anchor point was limited to that of the "
      "contact (raise fast.s_c_m2)");
  add(StepStatus::outside_grid,
      "the load was outside the places for which the body's response is known, and the nearest was used");
  add(StepStatus::tip_exceeded, "the tool was deeper than its tip is high, and the model sees only the tip");
  add(StepStatus::tilted, "a flat tip was tilted, and the model takes it to lie flat");
  add(StepStatus::depth_unchecked,
      "the tool was deeper, over its tip's radius or the body's radius of curvature, than in any contact compared with "
      "the reference");
  add(StepStatus::size_unchecked,
      "the contact was larger, over the body's size, than any that was compared with the reference");
  add(StepStatus::edge_unchecked,
      "the contact was nearer to an edge, over its radius, than any that was compared with the reference");
  add(StepStatus::regions_unchecked,
      "two contacts were nearer to each other, over their radii, than any that were compared with the reference");
  add(StepStatus::curvature_unchecked,
      "the body was more curved, over the tip's radius, than any that was compared with the reference");
  add(StepStatus::material_unchecked,
      "the body's Poisson's ratio is below 0.5, which was not compared with the reference for this tool or with "
      "friction");
  add(StepStatus::inclusion_unchecked,
      "the body has inclusions, and only two such bodies, each with a soft ball, were compared with the reference");
  return text.empty() ? "ok" : text;
}

}  // namespace touchstone::fast
