#include "compare/model/response_model.h"

#include "fast/response/response_step.h"
#include "reference/response/prepare.h"
#include "reference/tool/tool_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace touchstone::compare {
namespace {

class ResponseContactModel final : public ContactModel {
 public:
  ResponseContactModel(const scene::Scene& scene, const scene::Surface& surface, reference::Prepared prepared)
      : note_(fmt::format("{} columns, {} unknowns; displacements only, no normals", prepared.response.grid.count(),
                          prepared.response.unknowns)),
        triangles_(surface.triangle_count()),
        tool_(reference::tool_distance(scene.tool)),
        model_(scene, surface, std::move(prepared.response)),
        state_(model_) {}

  void step(const scene::Pose& pose) override { status_ = status_ | fast::response_step(model_, pose, state_); }

  void answer(scene::Answer& asked) override {
    status_ = fast::ResponseStatus::ok;
    for (scene::InstantRecord& instant : asked.instants) {
      step(instant.tool);
      for (Eigen::Index i = 0; i < 3; ++i) {
        const std::vector<float>& column = state_.displacement_m[static_cast<std::size_t>(i)];
        instant.displacement_m.row(i) =
            Eigen::Map<const Eigen::RowVectorXf>(column.data(), std::ssize(column)).cast<double>();
      }
      const fast::ResponseContact& contact = state_.contact;
      instant.traction_pa.setZero(3, instant.displacement_m.cols());
      if (!(contact.load.force_n > 0.0)) continue;
      add_tractions(asked.surface, contact.load, instant);
      instant.support_force_n = -state_.wrench.force_n;
      instant.regions.push_back({.depth_m = instant.depth_m,
                                 .force_n = state_.wrench.force_n,
                                 .torque_nm = state_.wrench.torque_nm,
                                 .area_m2 = std::numbers::pi * contact.load.radius_m * contact.load.radius_m});
    }
  }

  /// The load's pressure at the deformed places, along the tool's own normal there.
  void add_tractions(const scene::Surface& surface, const fast::SpreadLoad& load, scene::InstantRecord& instant) const {
    constexpr double steepest = 0.1;  // cosine between the two normals
    for (Eigen::Index i = 0; i < instant.traction_pa.cols(); ++i) {
      if (surface.normals.col(i).dot(load.normal) <= 0.0) continue;
      const scene::Vec3 x_m = surface.points_m.col(i) + instant.displacement_m.col(i);
      const double pressure_pa = fast::spread_pressure_pa(load, x_m);
      if (pressure_pa == 0.0) continue;
      const scene::Vec3 out =
          instant.tool.orientation *
          tool_->at(instant.tool.orientation.conjugate() * (x_m - instant.tool.position_m)).gradient;
      instant.traction_pa.col(i) = pressure_pa / std::max(-out.dot(load.normal), steepest) * out;
    }
    instant.pressure_peak_pa = fast::spread_pressure_pa(load, load.center_m);
  }

  [[nodiscard]] int size() const override { return triangles_; }
  [[nodiscard]] std::optional<double> memory_bytes() const override {
    return static_cast<double>(model_.memory_bytes() + state_.memory_bytes());
  }
  [[nodiscard]] std::string note() const override { return note_; }
  [[nodiscard]] std::string trouble() const override {
    return status_ == fast::ResponseStatus::ok ? "" : "status of its steps: " + fast::status_text(status_);
  }

 private:
  std::string note_;
  int triangles_;
  std::shared_ptr<const reference::ToolDistance> tool_;
  fast::ResponseModel model_;
  fast::ResponseState state_;
  fast::ResponseStatus status_ = fast::ResponseStatus::ok;
};

std::unique_ptr<ContactModel> set_up(const scene::Scene& scene, const std::filesystem::path& store,
                                     const std::function<void(const std::string&)>& say) {
  if (const std::string needs = fast::response_needs(scene); !needs.empty()) {
    throw Unavailable("the response model needs that " + needs);
  }
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  const auto tell = [&](const std::string& line) {
    if (say) say(line);
  };
  try {
    reference::Prepared prepared = reference::prepare_response(
        scene, surface, store, [&] { tell("preparing the body's response, once, for the response model"); });
    if (prepared.computed) {
      tell(fmt::format("prepared {} columns in {:.3g} s: {}", prepared.response.grid.count(), prepared.seconds,
                       prepared.file.string()));
    }
    return std::make_unique<ResponseContactModel>(scene, surface, std::move(prepared));
  } catch (const scene::InputError& error) {
    throw Unavailable(error.what());
  }
}

}  // namespace

std::vector<ModelEntry> response_models(const ModelRequest& request) {
  return {{.name = "response, from the material and the body's linear response",
           .key = "response",
           .label = "response",
           .family = ModelFamily::response,
           .set_up = [store = request.store, say = request.say](const scene::Scene& scene) {
             return set_up(scene, store, say);
           }}};
}

}  // namespace touchstone::compare
