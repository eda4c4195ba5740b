#include "compare/errors/figures.h"

#include "compare/format/text.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace touchstone::compare {
namespace {

/// Prefix of a single region's figures; the region's number follows.
constexpr std::string_view region_prefix = "force.region";

struct Meaning {
  std::string_view key, text;
  bool count = false;  ///< a count; other figures without a unit are ratios
  Worst worst = Worst::largest;
};

constexpr Meaning meanings[] = {
    {"force.nrmse", "Root mean square of the force error over all instants, relative to the reference's peak force."},
    {"force.peak_rel", "Error of the largest force of the track; negative: the fast model is too weak."},
    {"force.rel_above_10pct_depth",
     "Root mean square of the relative force error where the depth is above 10 % of its largest."},
    {"force.friction_nrmse",
     "Root mean square of the friction's error over all instants, relative to the reference's peak friction."},
    {"force.friction_work_rel",
     "Error of the work done against friction along the track, the area of the loop where it turns back."},
    {"force.slip_onset_error_m",
     "Slip path at which the fast model begins to slip, minus the reference's; uncertain by the path between "
     "instants."},
    {"force.slip_onset_fast_m", "Slip path at that onset, fast model.", false, Worst::none},
    {"force.slip_onset_reference_m", "Slip path at that onset, reference.", false, Worst::none},
    {"force.torque_nrmse",
     "Root mean square of the torque's error, relative to the reference's peak force times its distance from the mass "
     "centre."},
    {"force.region.nrmse", "As force.nrmse, of this contact region alone; regions are numbered by the reference."},
    {"force.region.peak_rel", "As force.peak_rel, of this contact region alone."},
    {"force.peak_fast_n", "Largest force on the tool, fast model.", false, Worst::none},
    {"force.peak_reference_n", "Largest force on the tool, reference.", false, Worst::none},
    {"shape.rel_l2",
     "Displacement error over displacement, root mean square over the whole surface by area and over all instants."},
    {"shape.points_moved",
     "Rest points that the reference moves by more than 10 % of its largest displacement, at the deepest instant: few "
     "of them say little about the shape.",
     true, Worst::none},
    {"shape.max_over_depth", "Largest displacement error of any point, relative to the depth at that instant."},
    {"shape.inside_r_rel_l2", "As shape.rel_l2, for points nearer to the contact than the local radius fast.r_R_m."},
    {"shape.outside_r_rel_l2", "As shape.rel_l2, for points farther away than that."},
    {"shape.side_faces_rel_l2", "As shape.rel_l2, for the body's faces that are never touched."},
    {"shape.normals_rms_rad", "Angle between the normals of both deformed surfaces, root mean square by area."},
    {"shape.hausdorff_m",
     "Largest distance between the two deformed surfaces, whichever points lie there; from each surface's vertices."},
    {"shape.volume_change_rel",
     "Volume the fast model's body gains or loses; an incompressible body keeps its volume."},
    {"contact.penetration_rel",
     "Largest penetration of the tool that remains in the fast model's deformed surface, relative to the depth."},
    {"contact.pressure_rel_l2",
     "Error of the traction over the traction, root mean square over the surface by area and over all instants."},
    {"contact.pressure_peak_rel", "Error of the largest contact pressure of the track."},
    {"contact.area_iou",
     "Contact area of both sides (intersection) over that of either (union), summed over the track; 100 % is equal.",
     false, Worst::smallest},
    {"reference.force_uncertainty_rel", "Largest uncertainty of the reference's force, relative to its force."},
    {"reference.shape_uncertainty_rel",
     "The reference's own shape uncertainty, relative to its displacement, in the norm of shape.rel_l2."},
    {"reference.pressure_peak_pa",
     "Largest contact pressure at a node of the reference's finest mesh, over all deep instants, per current area."},
    {"reference.pressure_peak_uncertainty_rel", "Its uncertainty, relative."},
    {"reference.contact_long_half_axis_m",
     "Long half axis of the reference's contact where it is largest; of a round contact its radius."},
    {"reference.contact_long_half_axis_uncertainty_rel", "Its uncertainty, relative."},
    {"reference.contact_short_half_axis_m", "Short half axis at the same instant."},
    {"reference.contact_short_half_axis_uncertainty_rel", "Its uncertainty, relative."},
    {"reference.residual_penetration_rel", "Residual penetration of the contact nodes, relative to the depth."},
    {"reference.penetration_between_nodes_rel", "The same between the nodes, where contact is not enforced."},
    {"reference.equilibrium_rel", "Contact force and support reaction should cancel: what is left, relative."},
    {"reference.volume_change_rel", "Volume change of the reference's body, on its own mesh."},
    {"reference.surface_volume_change_rel",
     "The same on the fast model's triangles: the share of shape.volume_change_rel that is due to flat triangles."},
    {"reference.dofs", "Displacement unknowns of the finest level.", true},
    {"reference.levels", "Meshes from coarse to fine, whose differences give the uncertainties.", true},
    {"reference.newton_iterations", "Newton iterations of all levels.", true},
    {"reference.wall_s", "Time the reference took, all levels."},
    {"reference.cpu_s", "Processor time of that, all threads."},
    {"reference.error_asked", "Uncertainty of force and shape at which the refinement may end."},
    {"reference.why_ended", "Why the refinement ended."},
    {"reference.sensitivity.load_step_force_rel",
     "Change of the force at the deepest instant, coarsest level, with load steps half as long."},
    {"reference.sensitivity.load_step_shape_rel", "The same of the shape."},
    {"reference.sensitivity.contact_parameter_force_rel",
     "The same of the force with the active set's parameter ten times as large."},
    {"reference.sensitivity.contact_parameter_shape_rel", "The same of the shape."},
    {"reference.sensitivity.numerical_bulk_force_rel",
     "The same of the force with ten times the bulk modulus that only Newton's tangent sees."},
    {"reference.sensitivity.numerical_bulk_shape_rel", "The same of the shape."},
    {"reference.sensitivity.tool_grid_force_rel",
     "The same of the force with half the spacing of the mesh tool's distance grid."},
    {"reference.sensitivity.tool_grid_shape_rel", "The same of the shape."},
    {"reference.sensitivity.inclusion_cells_force_rel",
     "The same of the force with cells at the inclusions' surfaces half as large."},
    {"reference.sensitivity.inclusion_cells_shape_rel", "The same of the shape."},
    {"reference.sensitivity.far_field_force_rel",
     "The same of the force with cells far from the contact half as large."},
    {"reference.sensitivity.far_field_shape_rel", "The same of the shape."},
    {"reference.model", "What the reference solved."},
    {"fast.step_us.p50", "One whole step of the fast model, median."},
    {"fast.step_us.p99", "99 % of the steps are shorter."},
    {"fast.step_us.p999", "99.9 % of the steps are shorter."},
    {"fast.step_us.max", "Longest step."},
    {"fast.force_us.p50", "From contact detection to the published force, median over steps in contact."},
    {"fast.force_us.p99", "99 % of those are shorter."},
    {"fast.setup_s", "Building the fast model, once."},
    {"fast.memory_bytes", "Memory of the fast model and its state."},
    {"fast.triangles", "Triangles of the body's surface.", true},
    {"fast.regions_max", "Most contact regions at one time.", true},
    {"fast.first_contact_s", "When the tool first meets the body at rest, time of the track."},
    {"fast.order_spread_rel",
     "Largest change of the total force if the regions had been created in another order, relative to it."},
    {"fast.equilibrium_rel",
     "Several regions: force on the tool and force of the support should cancel; what is left."},
    {"fast.status", "Warnings of the fast model over the whole track."},
};

/// Null if the key is none of these figures.
const Meaning* find_meaning(std::string_view given) {
  if (given.ends_with(uncertainty_suffix)) {
    given.remove_suffix(uncertainty_suffix.size());
  }
  std::string key(given);
  if (key.starts_with(region_prefix)) {
    const std::size_t number = region_prefix.size();
    key.erase(number, std::min(key.find('.', number), key.size()) - number);
  }
  const auto found =
      std::find_if(std::begin(meanings), std::end(meanings), [&](const Meaning& m) { return m.key == key; });
  return found == std::end(meanings) ? nullptr : found;
}

class Collector {
 public:
  explicit Collector(std::string absent) : absent_(std::move(absent)) {}

  void number(std::string key, double value, std::string unit = "") {
    figures_.push_back({std::move(key), value, "", std::move(unit)});
  }
  void number_or_why(std::string key, const std::optional<double>& value, const std::string& why) {
    if (value) return number(std::move(key), *value);
    absent(std::move(key), why);
  }
  void number_or_absent(std::string key, const std::optional<double>& value) {
    number_or_why(std::move(key), value, absent_);
  }
  void measure(const std::string& key, const Measure& measure, const std::string& unit = "") {
    measure_or_why(key, measure, absent_, unit);
  }
  void measure_or_why(const std::string& key, const Measure& measure, const std::string& why,
                      const std::string& unit = "") {
    if (!measure.value) {
      absent(key, why, unit);
      return absent(key + std::string(uncertainty_suffix), why, unit);
    }
    number(key, *measure.value, unit);
    if (measure.uncertainty) return number(key + std::string(uncertainty_suffix), *measure.uncertainty, unit);
    absent(key + std::string(uncertainty_suffix), "unknown", unit);
  }
  /// @param why  reason for the missing number
  void absent(std::string key, std::string why, std::string unit = "") {
    figures_.push_back({std::move(key), NAN, std::move(why), std::move(unit)});
  }
  [[nodiscard]] scene::Figures take() { return std::move(figures_); }

 private:
  std::string absent_;  ///< reason why a figure that needs contact is missing
  scene::Figures figures_;
};

/// Reason why there is no difference of slip onsets.
std::string without_slip(const Errors& errors) {
  if (errors.slip_onset_reference_m) return "undefined: the fast model never slips";
  return errors.slip_onset_fast_m ? "undefined: the reference never slips" : "undefined: neither side ever slips";
}

/// Friction if the scene has it, torque, and single regions if there are several.
void add_contact_figures(const Errors& errors, Collector& out) {
  if (errors.friction) {
    out.measure("force.friction_nrmse", errors.force_friction_nrmse);
    out.measure("force.friction_work_rel", errors.force_friction_work_rel);
    out.measure_or_why("force.slip_onset_error_m", errors.slip_onset_error_m, without_slip(errors), "m");
    if (errors.slip_onset_fast_m) out.number("force.slip_onset_fast_m", *errors.slip_onset_fast_m, "m");
    if (errors.slip_onset_reference_m) out.number("force.slip_onset_reference_m", *errors.slip_onset_reference_m, "m");
  } else {
    for (const char* key : {"force.friction_nrmse", "force.friction_work_rel", "force.slip_onset_error_m"}) {
      out.measure_or_why(key, {}, "undefined: the scene has no friction");
    }
  }
  out.measure("force.torque_nrmse", errors.force_torque_nrmse);
  for (const RegionErrors& region : errors.regions) {
    const std::string key = std::string(region_prefix) + std::to_string(region.id);
    out.measure(key + ".nrmse", region.force_nrmse);
    out.measure(key + ".peak_rel", region.force_peak_rel);
  }
}

}  // namespace

scene::Figures error_figures(const Errors& errors) {
  const bool contact = errors.force_peak_reference_n > 0.0;
  const std::string apart = "undefined: the reference is never in contact";
  Collector out(contact ? "undefined: there is no reference value to divide by" : apart);
  out.measure("force.nrmse", errors.force_nrmse);
  out.measure("force.peak_rel", errors.force_peak_rel);
  out.measure("force.rel_above_10pct_depth", errors.force_rel_deep);
  add_contact_figures(errors, out);
  out.number("force.peak_fast_n", errors.force_peak_fast_n, "N");
  out.number("force.peak_reference_n", errors.force_peak_reference_n, "N");
  out.measure("shape.rel_l2", errors.shape_rel_l2);
  out.number("shape.points_moved", errors.shape_points_moved);
  out.measure("shape.max_over_depth", errors.shape_max_over_depth);
  out.measure("shape.inside_r_rel_l2", errors.shape_inside_r_rel_l2);
  out.measure("shape.outside_r_rel_l2", errors.shape_outside_r_rel_l2);
  out.measure_or_why("shape.side_faces_rel_l2", errors.shape_side_faces_rel_l2,
                     contact ? "undefined: every face is touched" : apart);
  out.measure("shape.normals_rms_rad", errors.shape_normals_rms_rad, "rad");
  out.measure("shape.hausdorff_m", errors.shape_hausdorff_m, "m");
  out.number("shape.volume_change_rel", errors.volume_change_fast_rel);
  out.number_or_absent("contact.penetration_rel", errors.penetration_fast_rel);
  const std::string no_traction = "undefined: the model gives no traction";
  out.measure_or_why("contact.pressure_rel_l2", errors.contact_pressure_rel_l2, contact ? no_traction : apart);
  out.measure_or_why("contact.pressure_peak_rel", errors.contact_pressure_peak_rel, contact ? no_traction : apart);
  out.number_or_why("contact.area_iou", errors.contact_area_iou, "undefined: neither side is ever in contact");
  return out.take();
}

scene::Figures make_figures(const Errors& errors, const reference::Result& result, scene::Figures of_model) {
  scene::Figures out = error_figures(errors);
  std::ranges::move(reference_figures(result, errors.reference), std::back_inserter(out));
  out.push_back({"reference.surface_volume_change_rel", errors.volume_change_reference_surface_rel, "", ""});
  std::ranges::move(of_model, std::back_inserter(out));
  return out;
}

Worst worst_of(std::string_view key) {
  const Meaning* meaning = find_meaning(key);
  return meaning == nullptr ? Worst::largest : meaning->worst;
}

std::string_view figure_meaning(std::string_view key) {
  const Meaning* meaning = find_meaning(key);
  return meaning == nullptr ? std::string_view() : meaning->text;
}

std::string figure_text(const scene::Figure& figure) {
  if (!figure.text.empty()) return figure.text;
  const Meaning* meaning = find_meaning(figure.key);
  if (meaning != nullptr && meaning->count) return number_text(figure.number);
  return quantity_text(figure.number, figure.unit);
}

}  // namespace touchstone::compare
