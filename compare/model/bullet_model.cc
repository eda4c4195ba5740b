#include "compare/model/bullet_model.h"

#ifdef TOUCHSTONE_BULLET
#include "compare/format/text.h"
#include "fast/bench/bullet_peer.h"

#include <fmt/format.h>

#include <algorithm>
#endif

namespace touchstone::compare {

#ifdef TOUCHSTONE_BULLET
namespace {

constexpr double step_s = 1.0e-3;

bench::BulletScene bullet_scene(const scene::Scene& scene, int cells) {
  bench::BulletScene out;
  out.cells = cells;
  out.edge_m = scene.body.size_m.x();
  out.ball_radius_m = scene.tool.radius_m;
  out.youngs_modulus_pa = scene.body.material.youngs_modulus_pa;
  out.poissons_ratio = std::min(scene.body.material.poissons_ratio, 0.45);
  out.step_s = step_s;
  return out;
}

class BulletModel final : public ContactModel {
 public:
  BulletModel(const scene::Scene& scene, int cells)
      : scene_(scene), setting_(bullet_scene(scene, cells)), body_(setting_) {}

  void step(const scene::Pose& pose) override { body_.step(pose.position_m); }

  void answer(scene::Answer& asked) override {
    bench::BulletPeer body(setting_);
    double time_s = scene_.track.front().time_s;
    for (scene::InstantRecord& instant : asked.instants) {
      for (; time_s < instant.time_s + 0.5 * step_s; time_s += step_s) {
        body.step(scene::pose_at(scene_.track, time_s).position_m);
      }
      instant.displacement_m = body.displacement_m(asked.surface.points_m);
      if (!body.sound()) throw Unavailable("the simulation became unstable");
    }
  }

  [[nodiscard]] int size() const override { return body_.surface_triangles(); }
  [[nodiscard]] std::string note() const override {
    return fmt::format(
        "implicit steps of 1 ms with Poisson's ratio {}; it gives neither the force on the tool nor its "
        "memory",
        number_text(setting_.poissons_ratio));
  }

 private:
  scene::Scene scene_;
  bench::BulletScene setting_;
  bench::BulletPeer body_;
};

/// Why Bullet's block cannot represent a scene's body; empty if it can.
std::string unlike_bullet(const scene::Scene& scene) {
  const scene::Body& body = scene.body;
  if (body.shape != scene::BodyShape::box || (body.size_m.array() != body.size_m.x()).any())
    return "its body is a cube";
  if (scene.tool.shape != scene::ToolShape::sphere) return "its tool is a ball";
  if (!body.inclusions.empty()) return "its body is of one material";
  if (scene.contact.friction) return "it runs without friction";
  if (scene.track.back().time_s - scene.track.front().time_s > 5.0) return "the track is longer than 5 s";
  return "";
}

}  // namespace

std::vector<ModelEntry> bullet_models(const ModelRequest& request) {
  const std::string name = "deformable body of " + bench::bullet_version();
  std::string why = unlike_bullet(request.scene);
  for (const scene::Scene& contact : request.contacts) {
    if (why.empty()) why = unlike_bullet(contact);
  }
  if (!why.empty()) {
    return {{.name = name, .key = "bullet", .family = ModelFamily::simulator, .absent = "not this scene: " + why}};
  }
  std::vector<ModelEntry> models;
  for (const int cells : request.quick ? std::vector{4} : std::vector{6, 9}) {
    const int triangles = 12 * cells * cells;
    models.push_back(
        {.name = fmt::format("{}, {} triangles", name, triangles),
         .key = fmt::format("bullet-{}", triangles),
         .label = "Bullet " + thousands_text(triangles),
         .family = ModelFamily::simulator,
         .set_up = [cells](const scene::Scene& scene) { return std::make_unique<BulletModel>(scene, cells); },
         .gives_force = false});
  }
  return models;
}
#else
std::vector<ModelEntry> bullet_models(const ModelRequest&) {
  return {{.name = "Bullet's deformable body",
           .key = "bullet",
           .family = ModelFamily::simulator,
           .absent = "built without Bullet"}};
}
#endif

}  // namespace touchstone::compare
