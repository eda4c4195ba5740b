// The fast model's answers on scenes in both formulations, in full precision, for comparing what compilers make of
// them.
//
//   compiler_answers FOLDER SCENE...
//
// Writes FOLDER/<scene>-<formulation>.bin, doubles: the numbers of instants and rest points, the status bits, and how
// far the tool reaches from its mass centre [m]; then per instant force [N] and torque about the mass centre [N m] on
// the tool, and the displacement of every rest point [m].
#include "fast/run/run.h"
#include "scene/base/error.h"
#include "scene/input/scene_io.h"
#include "scene/shape/surface.h"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

using namespace touchstone;

void write(std::ofstream& out, const double* numbers, Eigen::Index count) {
  out.write(reinterpret_cast<const char*>(numbers), count * static_cast<Eigen::Index>(sizeof(double)));
}

void write_answers(const std::filesystem::path& file, const scene::Scene& scene) {
  const fast::Run run = fast::run(scene);
  std::ofstream out(file, std::ios::binary);
  const double reach_m = scene::tool_surface(scene.tool, 200).points_m.colwise().norm().maxCoeff();
  const double head[] = {static_cast<double>(run.instants.size()), static_cast<double>(run.surface.vertex_count()),
                         static_cast<double>(run.status), reach_m};
  write(out, head, 4);
  for (const scene::InstantRecord& instant : run.instants) {
    const scene::Vec3 force_n = instant.force_n();
    scene::Vec3 torque_nm = scene::Vec3::Zero();
    for (const scene::RegionRecord& region : instant.regions) torque_nm += region.torque_nm;
    write(out, force_n.data(), 3);
    write(out, torque_nm.data(), 3);
    write(out, instant.displacement_m.data(), instant.displacement_m.size());
  }
  if (!out.flush()) throw scene::InputError(file.string() + " cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("compiler_answers FOLDER SCENE...\n", stderr);
    return 2;
  }
  try {
    for (int i = 2; i < argc; ++i) {
      const std::filesystem::path file = argv[i];
      for (const std::string formulation : {"published", "corrected"}) {
        const scene::Scene scene = scene::load_scene(file, {"fast.formulation=" + formulation});
        write_answers(std::filesystem::path(argv[1]) / (file.stem().string() + "-" + formulation + ".bin"), scene);
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
