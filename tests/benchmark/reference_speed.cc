// Processor time of a reference solve by parts: reference_speed SCENE LEVEL INSTANTS
// LEVEL counts from 1; the first INSTANTS in which the tool is inside the body at rest are solved.
#include "reference/contact/contact_problem.h"
#include "reference/contact/load_path.h"
#include "reference/run/model_choice.h"
#include "scene/base/stopwatch.h"
#include "scene/input/scene_io.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

namespace {

using namespace touchstone;
using namespace touchstone::reference;

template <int dim>
void measure(const scene::Scene& scene, const ModelChoice& choice, int level, int instants) {
  double all_s = 0.0, observed_n = 0.0;
  int solved_count = 0, newton = 0, halvings = 0, indefinite = 0;
  ContactProblem<dim> problem(level_mesh<dim>(scene, choice, level), scene.body.material, scene.reference.kinematics,
                              choice.mirror_x, choice.mirror_y);
  const std::unique_ptr<const scene::Shape> body = scene::body_shape(scene.body);
  const auto depth_m = [&](double time_s) {
    return scene::rest_depth_m(*body, scene.tool, scene::pose_at(scene.track, time_s));
  };
  {
    const scene::CpuTimeAdder watch(all_s);
    LoadPath<dim> path(problem, [&](double time_s) -> std::optional<RigidTool<dim>> {
      if (depth_m(time_s) <= 0.0) return std::nullopt;
      return RigidTool<dim>(choice.tool, scene::pose_at(scene.track, time_s));
    });
    const std::vector<double> times_s = scene::instants_s(scene);
    std::optional<Solved<dim>> before;
    Solved<dim> current{2.0 * times_s[0] - times_s[1], problem.rest(), false};
    for (const double time_s : times_s) {
      if (solved_count == instants) break;
      Solved<dim> next{time_s, problem.rest(), false};
      const AdvanceReport report = path.advance(before ? &*before : nullptr, current, time_s, next, {}, [](double) {});
      newton += report.newton_iterations;
      halvings += report.halvings;
      indefinite += report.indefinite;
      if (!report.converged) {
        std::printf("instant at %g s did not converge: %s\n", time_s, report.last.trouble.c_str());
        break;
      }
      before = std::move(current);
      current = std::move(next);
      if (!current.touching) continue;
      ++solved_count;
      observed_n = problem.observe(current.state).force_n.norm();
    }
  }
  const LinearWork work = problem.linear_work();
  std::printf("%s, mesh %d, %d unknowns, %d instants, %s\n", scene.name.c_str(), level + 1, problem.unknowns(),
              solved_count, problem.linear_solver().c_str());
  std::printf("force %.12g N, %d Newton iterations, %d halvings, %d indefinite\n", observed_n, newton, halvings,
              indefinite);
  std::printf("processor time %.2f s: assembly %.2f, analysis %.2f, factorisation %.2f, iteration %.2f\n", all_s,
              problem.assembly_s(), work.analysis_s, work.factorisation_s, work.iteration_s);
  std::printf("%d factorisations, %d iterations\n", work.factorisations, work.iterations);
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 4) {
    std::fprintf(stderr, "usage: reference_speed SCENE LEVEL INSTANTS\n");
    return 2;
  }
  try {
    const scene::Scene scene = scene::load_scene(arguments[1]);
    const int level = std::atoi(arguments[2]) - 1, instants = std::atoi(arguments[3]);
    if (level < 0 || level > 9 || instants < 1) {
      std::fprintf(stderr, "LEVEL is 1 to 10, INSTANTS at least 1\n");
      return 2;
    }
    const ModelChoice choice = choose_model(scene);
    if (choice.dim == 2) {
      measure<2>(scene, choice, level, instants);
    } else {
      measure<3>(scene, choice, level, instants);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
