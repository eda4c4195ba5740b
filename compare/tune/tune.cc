#include "compare/tune/tune.h"

#include "compare/errors/compute_errors.h"
#include "compare/format/text.h"
#include "fast/run/replay.h"
#include "scene/model/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace touchstone::compare {
namespace {

using scene::Vec3;

constexpr int profile_points = 9;

template <class T>
void keep(std::vector<T>& list, const std::vector<std::size_t>& at) {
  if (list.empty()) return;
  std::vector<T> kept;
  for (const std::size_t k : at) kept.push_back(std::move(list[k]));
  list = std::move(kept);
}

void keep_in_result(reference::Result& result, const std::vector<std::size_t>& at) {
  keep(result.instants, at);
  for (reference::LevelRecord& level : result.levels) keep(level.force_n, at);
}

double peak_force_n(const TuningData& data) {
  double peak_n = 0.0;
  for (const scene::InstantRecord& record : data.result.instants) peak_n = std::max(peak_n, record.force_n().norm());
  return peak_n;
}

double deepest_m(const TuningData& data) {
  double deepest = 0.0;
  for (const scene::InstantRecord& record : data.result.instants) deepest = std::max(deepest, record.depth_m);
  return deepest;
}

/// The reference's own, but no less than the floor, which also stands for one that is not known.
double at_least(double uncertainty, double floor) {
  return std::isfinite(uncertainty) ? std::max(uncertainty, floor) : floor;
}

void set_values(scene::Scene& scene, const std::vector<TuningParameter>& parameters, const Eigen::VectorXd& values) {
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    set_parameter(scene, parameters[k].key, values[static_cast<Eigen::Index>(k)]);
  }
}

/// The training contacts as residuals of one stage.
class Training {
 public:
  /// @param deepest_m  of all contacts, on which the laws must have an answer
  Training(const Tuning& tuning, const TunedModel& model, double deepest_m) : deepest_m_(deepest_m) {
    for (const TuningData& data : tuning.data) {
      if (data.held_out()) continue;
      Contact& one = contacts_.emplace_back();
      one.data = &data;
      one.scene = tuned_scene(data.contact.scene, model);
      one.replay = std::make_unique<fast::Replay>(one.scene);
      one.force_floor_n = tuning.study.force_floor * peak_force_n(data);
      one.shape_uncertainty = at_least(data.result.shape_uncertainty_rel.value_or(INFINITY), tuning.study.shape_floor);
      for (std::size_t t = 0; t < data.instants.size(); ++t) {
        if (data.result.instants[t].depth_m > grazing_depth_m) one.touching.push_back(t);
      }
      for (const std::size_t t : one.touching) {
        const Eigen::Matrix3Xd& u_m = data.result.instants[t].displacement_m;
        for (Eigen::Index i = 0; i < u_m.cols(); ++i) {
          one.shape_scale += data.surface.vertex_area_m2[static_cast<std::size_t>(i)] * u_m.col(i).squaredNorm();
        }
      }
      one.shape_scale = std::sqrt(one.shape_scale / static_cast<double>(one.touching.size()));
      one.weight_per_m =
          Eigen::Map<const Eigen::VectorXd>(data.surface.vertex_area_m2.data(),
                                            static_cast<Eigen::Index>(data.surface.vertex_area_m2.size()))
              .cwiseSqrt() /
          (one.shape_scale * one.shape_uncertainty);
      for (const std::size_t t : one.touching) {
        one.touching_in_track.push_back(data.instants[t]);
        one.weighted_reference.push_back(data.result.instants[t].displacement_m * one.weight_per_m.asDiagonal());
        shape_rows_ += one.weighted_reference.back().size();
      }
      observations_ += static_cast<int>(one.touching.size());
    }
  }

  /// One for every instant in contact: its force, or its whole surface, whose points hang together.
  [[nodiscard]] int observations() const noexcept { return observations_; }

  /// Difference of the force vectors over the band, three components an instant.
  std::optional<Eigen::VectorXd> force(const std::vector<TuningParameter>& parameters, const Eigen::VectorXd& values) {
    Eigen::VectorXd out(3 * observations_);
    Eigen::Index row = 0;
    for (Contact& one : contacts_) {
      scene::Scene scene = one.scene;
      set_values(scene, parameters, values);
      if (!scene::broken_constants(scene, deepest_m_).empty()) return std::nullopt;
      const std::vector<Vec3> force_n = one.replay->forces_n(scene);
      for (const std::size_t t : one.touching) {
        const double band_n = at_least(one.data->result.instants[t].force_uncertainty_n, one.force_floor_n);
        out.segment<3>(row) = (force_n[one.data->instants[t]] - one.data->result.instants[t].force_n()) / band_n;
        row += 3;
      }
    }
    return out;
  }

  /// Difference of the displacements times sqrt(area), so scaled that the mean of an instant's sum of squares is
  /// (shape.rel_l2 / the reference's uncertainty of it)^2.
  std::optional<Eigen::VectorXd> shape(const std::vector<TuningParameter>& parameters, const Eigen::VectorXd& values) {
    Eigen::VectorXd out(shape_rows_);
    Eigen::Index row = 0;
    for (Contact& one : contacts_) {
      scene::Scene scene = one.scene;
      set_values(scene, parameters, values);
      if (!scene::broken_constants(scene, deepest_m_).empty()) return std::nullopt;
      if (!one.forces_known) (void)one.replay->forces_n(scene);
      one.forces_known = true;
      one.replay->displacements(scene, one.touching_in_track, [&](std::size_t k, const fast::Columns3& displacement_m) {
        const Eigen::Matrix3Xd& weighted = one.weighted_reference[k];
        for (Eigen::Index i = 0; i < weighted.cols(); ++i) {
          const auto v = static_cast<std::size_t>(i);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            out[row++] = static_cast<double>(displacement_m[axis][v]) * one.weight_per_m[i] -
                         weighted(static_cast<Eigen::Index>(axis), i);
          }
        }
      });
    }
    return out;
  }

 private:
  struct Contact {
    const TuningData* data = nullptr;
    scene::Scene scene;
    std::unique_ptr<fast::Replay> replay;
    std::vector<std::size_t> touching;           ///< of the instants that count
    std::vector<std::size_t> touching_in_track;  ///< the same of all instants
    double force_floor_n = 0.0;
    double shape_uncertainty = 0.0;
    double shape_scale = 0.0;      ///< root mean square over the instants of sqrt(sum A |u|^2) [m^2]
    Eigen::VectorXd weight_per_m;  ///< per rest point: sqrt(A) over the scale and the uncertainty
    std::vector<Eigen::Matrix3Xd> weighted_reference;  ///< per touching instant
    bool forces_known = false;
  };
  double deepest_m_;
  std::vector<Contact> contacts_;
  int observations_ = 0;
  Eigen::Index shape_rows_ = 0;
};

std::string value_text(double value, const std::string& unit) {
  return number_text(value) + (unit.empty() ? "" : std::string(no_break) + unit);
}

std::vector<std::string> notes_of(const StageFit& stage) {
  std::vector<std::string> notes;
  const Fit& fit = stage.fit;
  for (std::size_t k = 0; k < stage.parameters.size(); ++k) {
    const TuningParameter& one = stage.parameters[k];
    const Determination& found = fit.parameters[k];
    if (found.at_bound != AtBound::no) {
      const bool low = found.at_bound == AtBound::low;
      notes.push_back(fmt::format(
          "{} ended at its {} bound, {}: the data want it {}, no error can be given for it, and the errors of the "
          "others "
          "hold only while it stays there.",
          one.key, low ? "lower" : "upper", value_text(low ? one.low : one.high, one.unit), low ? "lower" : "higher"));
    } else if (found.open) {
      notes.push_back(fmt::format(
          "These data cannot determine {}: it is known no better than its bounds say already, {} to {}; {} is where "
          "the "
          "search ended.",
          one.key, value_text(one.low, one.unit), value_text(one.high, one.unit), value_text(found.value, one.unit)));
    }
  }
  for (const std::vector<std::size_t>& direction : fit.open_directions) {
    if (direction.size() < 2) continue;
    std::string names;
    for (const std::size_t k : direction) names += (names.empty() ? "" : " and ") + stage.parameters[k].key;
    notes.push_back("Only a combination of " + names + " is determined: one can be traded for the other.");
  }
  if (fit.rank < fit.free) {
    notes.push_back(
        fmt::format("The fit is rank deficient: {} of {} parameters away from their bounds have an effect of "
                    "their own.",
                    fit.rank, fit.free));
  }
  for (const Profile& profile : stage.profiles) {
    const TuningParameter& one = stage.parameters[profile.parameter];
    const Determination& found = fit.parameters[profile.parameter];
    if (found.open || found.at_bound != AtBound::no) continue;
    if (profile.open_low && profile.open_high) {
      notes.push_back(
          fmt::format("The profile of {} stays flat from bound to bound: these data cannot determine it.", one.key));
    } else if (profile.open_low || profile.open_high) {
      notes.push_back(fmt::format("By its profile {} is known only to be {} {}.", one.key,
                                  profile.open_low ? "below" : "above",
                                  value_text(profile.open_low ? profile.high : profile.low, one.unit)));
    }
  }
  return notes;
}

StageFit fit_stage(const Tuning& tuning, const TunedModel& model, TuningStage stage, double deepest) {
  StageFit out;
  out.stage = stage;
  for (const TuningParameter& one : tuning.study.parameters) {
    if (one.stage != stage || !applies(one, model.formulation, model.law)) continue;
    out.parameters.push_back(one);
    out.searched.push_back({one.key, one.low, one.high, one.start, one.log});
  }
  if (out.parameters.empty()) return out;
  Training training(tuning, model, deepest);
  const Residuals residuals = [&](const Eigen::VectorXd& values) {
    return stage == TuningStage::force ? training.force(out.parameters, values)
                                       : training.shape(out.parameters, values);
  };
  FitOptions options;
  options.starts = tuning.study.starts;
  options.observations = training.observations();
  std::vector<std::size_t> profiled;
  for (std::size_t k = 0; k < out.parameters.size(); ++k) {
    if (out.parameters[k].profile) profiled.push_back(k);
  }
  ProfiledFit found = fit_through_profiles(out.searched, residuals, options, profiled, profile_points);
  out.fit = std::move(found.fit);
  out.profiles = std::move(found.profiles);
  out.notes = notes_of(out);
  return out;
}

/// Points of the rest surface under the reference's regions.
std::vector<Vec3> contact_points_m(const TuningData& data, std::size_t t) {
  const auto body = scene::body_shape(data.contact.scene.body);
  std::vector<Vec3> points_m = data.result.instants[t].region_middles_m;
  if (points_m.empty()) points_m.push_back(data.result.instants[t].tool.position_m);
  for (Vec3& p_m : points_m) p_m = body->query(p_m).point_m;
  return points_m;
}

double contact_area_m2(const scene::InstantRecord& record) {
  double area_m2 = 0.0;
  for (const scene::RegionRecord& region : record.regions) area_m2 += region.area_m2;
  return area_m2;
}

std::vector<RegimePoint> regime_of(const Tuning& tuning, const TuningData& data, const Errors& errors) {
  std::vector<Vec3> trained_m;
  for (const TuningData& other : tuning.data) {
    if (other.held_out()) continue;
    for (std::size_t t = 0; t < other.result.instants.size(); ++t) {
      if (other.result.instants[t].depth_m <= grazing_depth_m) continue;
      for (const Vec3& p_m : contact_points_m(other, t)) trained_m.push_back(p_m);
    }
  }
  const scene::Tool& tool = data.contact.scene.tool;
  std::vector<RegimePoint> regime;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    const InstantErrors& e = errors.instants[t];
    if (!e.deep || !e.force_error_rel) continue;
    RegimePoint point;
    point.depth_m = e.depth_m;
    point.area_m2 = contact_area_m2(data.result.instants[t]);
    const double radius_m = tool.radius_m > 0.0 ? tool.radius_m : std::sqrt(point.area_m2 / std::numbers::pi);
    point.depth_over_radius = e.depth_m / radius_m;
    point.force_error_rel = *e.force_error_rel;
    point.place_m = INFINITY;
    for (const Vec3& p_m : contact_points_m(data, t)) {
      for (const Vec3& q_m : trained_m) point.place_m = std::min(point.place_m, (p_m - q_m).norm());
    }
    regime.push_back(point);
  }
  return regime;
}

TuningOutcome outcome_of(const Tuning& tuning, const TunedModel& model, std::size_t at) {
  const TuningData& data = tuning.data[at];
  const scene::Scene scene = tuned_scene(data.contact.scene, model);
  TuningOutcome out{at, fast::run(scene), {}, {}};
  keep_instants(out.run, data.instants);
  out.errors = compute_errors(scene, out.run, data.result.instants);
  out.regime = regime_of(tuning, data, out.errors);
  return out;
}

/// shape.rel_l2 over the instants that count.
double shape_error_rel(const TuningData& data, const scene::Scene& scene, fast::Replay& replay) {
  double error2 = 0.0, scale2 = 0.0;
  (void)replay.forces_n(scene);
  replay.displacements(scene, data.instants, [&](std::size_t t, const fast::Columns3& fast_m) {
    const Eigen::Matrix3Xd& reference_m = data.result.instants[t].displacement_m;
    const auto area_m2 = Eigen::Map<const Eigen::VectorXd>(data.surface.vertex_area_m2.data(), reference_m.cols());
    error2 += area_m2.dot((fast::matrix_of(fast_m) - reference_m).colwise().squaredNorm().transpose());
    scale2 += area_m2.dot(reference_m.colwise().squaredNorm().transpose());
  });
  return std::sqrt(error2 / scale2);
}

ShapeParts shape_parts_of(const TuningData& data, const TunedModel& model) {
  // A million square metres: no beam gives.
  constexpr double stiff_s_c_m2 = 1e6;
  const scene::Scene whole = tuned_scene(data.contact.scene, model);
  fast::Replay replay(whole);
  const auto with = [&](bool factor, bool anchors) {
    scene::Scene scene = whole;
    if (!factor) scene.fast.C_n = 0.0;
    if (!anchors) scene.fast.s_c_m2 = stiff_s_c_m2;
    return shape_error_rel(data, scene, replay);
  };
  return {with(true, true), with(false, true), with(true, false), with(false, false)};
}

/// The reference's and the model's force at one depth on a way in, between its instants; nothing where it never is.
std::optional<std::array<double, 2>> forces_at_n(const TuningOutcome& outcome, double depth_m) {
  const std::vector<InstantErrors>& e = outcome.errors.instants;
  for (std::size_t t = 1; t < e.size(); ++t) {
    if (e[t - 1].depth_m > depth_m || e[t].depth_m < depth_m || e[t].depth_m <= e[t - 1].depth_m) continue;
    const double share = (depth_m - e[t - 1].depth_m) / (e[t].depth_m - e[t - 1].depth_m);
    const auto between = [&](double a, double b) { return a + share * (b - a); };
    return std::array{between(e[t - 1].force_reference_n, e[t].force_reference_n),
                      between(e[t - 1].force_fast_n, e[t].force_fast_n)};
  }
  return std::nullopt;
}

std::string in_what(const std::string& differs) {
  return differs == "tool"    ? "another tool"
         : differs == "depth" ? "another depth"
         : differs == "place" ? "another place"
         : differs == "track" ? "another track"
                              : "another body";
}

std::vector<std::string> limits_of(const Tuning& tuning, const TunedModel& model) {
  std::vector<std::string> limits;
  const TuningOutcome& trained = model.outcomes.front();
  for (const char* differs : {"place", "tool", "depth", "track", "body"}) {
    const TuningOutcome* worst = nullptr;
    for (const TuningOutcome& one : model.outcomes) {
      if (tuning.data[one.data].contact.differs != differs || !one.errors.force_nrmse.value) continue;
      if (worst == nullptr || *one.errors.force_nrmse.value > *worst->errors.force_nrmse.value) worst = &one;
    }
    if (worst == nullptr) continue;
    const Errors& e = worst->errors;
    std::string text = fmt::format("Force at {} (worst: {}): off by {} of the peak, {} at the peak.", in_what(differs),
                                   tuning.data[worst->data].contact.name, percent_text(*e.force_nrmse.value),
                                   *e.force_peak_rel.value < 0.0
                                       ? fmt::format("{} too weak", percent_text(-*e.force_peak_rel.value))
                                       : fmt::format("{} too strong", percent_text(*e.force_peak_rel.value)));
    const double depth_m = std::min(e.depth_max_m, trained.errors.depth_max_m);
    const auto here = forces_at_n(*worst, depth_m), there = forces_at_n(trained, depth_m);
    if (here && there && (*there)[0] > 0.0 && (*there)[1] > 0.0) {
      text += fmt::format(
          " From the training contact {} to this one, at {} depth, the reference's force changes by a factor of {}, "
          "the model's by {}.",
          tuning.data[trained.data].contact.name, quantity_text(depth_m, "m"), number_text((*here)[0] / (*there)[0]),
          number_text((*here)[1] / (*there)[1]));
    }
    if (!e.force_nrmse.distinguishable()) text += " That is not distinguishable from the reference's own uncertainty.";
    limits.push_back(std::move(text));
  }
  const TuningOutcome* worst = nullptr;
  for (const TuningOutcome& one : model.outcomes) {
    if (!tuning.data[one.data].held_out() || !one.errors.shape_rel_l2.value) continue;
    if (worst == nullptr || *one.errors.shape_rel_l2.value > *worst->errors.shape_rel_l2.value) worst = &one;
  }
  if (worst != nullptr && trained.errors.shape_rel_l2.value) {
    const Errors& e = worst->errors;
    std::string text =
        fmt::format("Shape: off by {} of the displacement on the training contact {}, and by up to {} held out ({}).",
                    percent_text(*trained.errors.shape_rel_l2.value), tuning.data[trained.data].contact.name,
                    percent_text(*e.shape_rel_l2.value), tuning.data[worst->data].contact.name);
    if (e.shape_inside_r_rel_l2.value && e.shape_outside_r_rel_l2.value && e.shape_error_outside_share) {
      text += fmt::format(
          " There it is {} within the local radius and {} beyond it, where {} of the squared error lies: only "
          "the anchor points move the surface there, whatever the local factor is.",
          percent_text(*e.shape_inside_r_rel_l2.value), percent_text(*e.shape_outside_r_rel_l2.value),
          percent_text(*e.shape_error_outside_share));
    }
    if (e.shape_side_faces_rel_l2.value) {
      text += fmt::format(" On the faces that are not touched, which hear only the anchor points, it is {}.",
                          percent_text(*e.shape_side_faces_rel_l2.value));
    }
    limits.push_back(std::move(text));
    const ShapeParts& parts = model.shape_parts;
    limits.push_back(fmt::format(
        "What its parts are good for, on the training contact {}: {} with the contact point's hat alone, {} with the "
        "anchor points' movement on top, {} with the local factor in its place, {} with both.",
        tuning.data[trained.data].contact.name, percent_text(parts.hat_alone), percent_text(parts.without_local_factor),
        percent_text(parts.anchors_at_rest), percent_text(parts.whole)));
  }
  return limits;
}

}  // namespace

TuningData tuning_data(const TuningContact& contact, const SolveReference& solve) {
  TuningData data{
      contact, {}, {}, scene::tessellate(*scene::body_shape(contact.scene.body), contact.scene.fast.triangles)};
  data.result = solve(contact.scene, data.surface);
  for (std::size_t t = 0; t < data.result.instants.size(); ++t) {
    const double depth_m = data.result.instants[t].depth_m;
    const bool from_rest = contact.depth_m[0] == 0.0;
    if ((from_rest || depth_m > contact.depth_m[0]) && depth_m <= contact.depth_m[1]) data.instants.push_back(t);
  }
  keep_in_result(data.result, data.instants);
  const auto touches = [](const scene::InstantRecord& record) {
    return record.depth_m > grazing_depth_m && record.force_n().norm() > 0.0;
  };
  if (std::none_of(data.result.instants.begin(), data.result.instants.end(), touches)) {
    throw scene::InputError(
        fmt::format("contact \"{}\": the reference is never in contact at an instant that counts; "
                    "expected some with a depth in depth_m",
                    contact.name));
  }
  return data;
}

void keep_instants(scene::Answer& answer, const std::vector<std::size_t>& instants) { keep(answer.instants, instants); }

std::string TunedModel::name() const {
  return std::string(formulation == scene::Formulation::published ? "published" : "corrected") +
         (law == scene::ContactLaw::duffing ? " duffing" : " area-aware");
}

std::string TunedModel::key() const {
  std::string key = name();
  std::replace(key.begin(), key.end(), '-', '_');
  std::replace(key.begin(), key.end(), ' ', '-');
  return key;
}

scene::Scene tuned_scene(const scene::Scene& scene, const TunedModel& model) {
  scene::Scene out = scene;
  out.fast.formulation = model.formulation;
  out.contact.law = model.law;
  for (const StageFit& stage : model.stages) set_values(out, stage.parameters, stage.fit.value);
  return out;
}

Tuning tune(const TuningStudy& study, const SolveReference& solve, const std::function<void(const std::string&)>& say) {
  const auto tell = [&](const std::string& line) {
    if (say) say(line);
  };
  Tuning tuning{study, {}, {}};
  double deepest = 0.0;
  for (const auto* list : {&study.training, &study.held_out}) {
    for (const TuningContact& contact : *list) {
      tell("reference of \"" + contact.name + "\"");
      tuning.data.push_back(tuning_data(contact, solve));
      deepest = std::max(deepest, deepest_m(tuning.data.back()));
    }
  }
  for (const scene::Formulation formulation : study.formulations) {
    for (const scene::ContactLaw law : study.laws) {
      TunedModel model{
          .formulation = formulation, .law = law, .stages = {}, .outcomes = {}, .shape_parts = {}, .limits = {}};
      for (const TuningStage stage : {TuningStage::force, TuningStage::shape}) {
        tell(fmt::format("{}: fitting the {}", model.name(), stage == TuningStage::force ? "force" : "shape"));
        StageFit fitted = fit_stage(tuning, model, stage, deepest);
        if (!fitted.parameters.empty()) model.stages.push_back(std::move(fitted));
      }
      tell(model.name() + ": errors on every contact");
      for (std::size_t k = 0; k < tuning.data.size(); ++k) model.outcomes.push_back(outcome_of(tuning, model, k));
      model.shape_parts = shape_parts_of(tuning.data.front(), model);
      model.limits = limits_of(tuning, model);
      tuning.models.push_back(std::move(model));
    }
  }
  return tuning;
}

}  // namespace touchstone::compare
