#include "compare/calculix/calculix.h"

#include "scene/base/error.h"
#include "scene/base/stopwatch.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>

namespace touchstone::compare {
namespace {

constexpr int no_such_program = 127;

/// Total force, or one node's displacement, from CalculiX's components.
scene::Vec3 in_world(const scene::Vec3& components, bool axisymmetric) {
  return axisymmetric ? scene::Vec3(components.x(), 0.0, components.y()) : components;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

std::vector<CalculixStep> read_calculix(const std::filesystem::path& dat, const reference::Deck& deck) {
  std::ifstream file(dat);
  std::vector<CalculixStep> steps;
  const auto nodes = static_cast<Eigen::Index>(deck.surface_nodes.size());
  Eigen::Index row = nodes;
  scene::Vec3* total = nullptr;
  for (std::string line; std::getline(file, line);) {
    const auto says = [&](const std::string& what, const char* set) {
      return line.find(what) != std::string::npos && line.find(std::string(" set ") + set + " ") != std::string::npos;
    };
    if (says("total force", reference::deck_tool_set)) {
      // Of a step's two results the force comes first.
      total = &steps.emplace_back().force_n;
    } else if (!steps.empty() && says("displacements", reference::deck_surface_set)) {
      steps.back().displacement_m.resize(3, nodes);
      row = 0;
    } else {
      std::istringstream numbers(line);
      scene::Vec3 components;
      int node = 0;
      if (total && numbers >> components.x() >> components.y() >> components.z()) {
        *total = -deck.whole_body.cwiseProduct(in_world(components, deck.axisymmetric));
        total = nullptr;
      } else if (!total && row < nodes && numbers >> node >> components.x() >> components.y() >> components.z()) {
        if (node != deck.surface_nodes[row]) break;
        steps.back().displacement_m.col(row++) = in_world(components, deck.axisymmetric);
      }
    }
  }
  if (row < nodes || total || (!steps.empty() && steps.back().displacement_m.cols() == 0)) steps.pop_back();
  return steps;
}

CalculixRun run_calculix(const std::filesystem::path& folder, const std::string& name, const reference::Deck& deck) {
  std::filesystem::remove(folder / (name + ".dat"));
  const std::string log = name + ".log";
  const scene::Stopwatch watch;
  const pid_t child = fork();
  if (child == 0) {
    const int out = chdir(folder.c_str()) == 0 ? open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644) : -1;
    if (out >= 0 && dup2(out, STDOUT_FILENO) >= 0 && dup2(out, STDERR_FILENO) >= 0 &&
        setenv("OMP_NUM_THREADS", "1", 1) == 0) {
      execlp("ccx", "ccx", "-i", name.c_str(), nullptr);
    }
    _exit(no_such_program);
  }
  int status = 0;
  rusage usage{};
  while (child > 0 && wait4(child, &status, 0, &usage) < 0 && errno == EINTR) continue;
  if (child < 0 || (WIFEXITED(status) && WEXITSTATUS(status) == no_such_program)) {
    throw scene::InputError("ccx: no such program; expected CalculiX, Debian's package calculix-ccx");
  }
  CalculixRun run;
  run.wall_s = watch.wall_s();
  run.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  run.steps = read_calculix(folder / (name + ".dat"), deck);
  return run;
}

}  // namespace touchstone::compare
