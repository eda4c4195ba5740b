#include "compare/model/replay.h"

#include "compare/model/judge.h"

namespace touchstone::compare {
namespace {

class SetUpAnew final : public ModelReplay {
 public:
  SetUpAnew(const ModelEntry& entry, const scene::Scene& scene) : entry_(entry), unanswered_(unanswered(scene)) {}

  std::vector<scene::Vec3> forces_n(const scene::Scene& scene) override {
    std::vector<scene::Vec3> force_n;
    const scene::Answer answered = answer(scene);
    for (const scene::InstantRecord& instant : answered.instants) force_n.push_back(instant.force_n());
    return force_n;
  }
  void displacements(const scene::Scene& scene, std::span<const std::size_t> instants, const Visit& visit) override {
    const scene::Answer answered = answer(scene);
    for (std::size_t k = 0; k < instants.size(); ++k) visit(k, answered.instants[instants[k]].displacement_m);
  }

 private:
  [[nodiscard]] scene::Answer answer(const scene::Scene& scene) const {
    scene::Answer asked = unanswered_;
    entry_.set_up(scene)->answer(asked);
    return asked;
  }

  ModelEntry entry_;
  scene::Answer unanswered_;
};

}  // namespace

std::unique_ptr<ModelReplay> replay_of(const ModelEntry& entry, const scene::Scene& scene) {
  if (entry.replay) return entry.replay(scene);
  return std::make_unique<SetUpAnew>(entry, scene);
}

}  // namespace touchstone::compare
