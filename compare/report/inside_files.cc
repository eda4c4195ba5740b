#include "compare/report/inside_files.h"

#include "compare/report/vtk_out.h"
#include "scene/base/files.h"
#include "scene/base/text.h"

#include <array>

namespace touchstone::compare {
namespace {

constexpr const char* probes_head =
    "time_s,probe,x_m,y_m,z_m,displacement_x_m,displacement_y_m,displacement_z_m,displacement_uncertainty_m,"
    "stress_xx_pa,stress_yy_pa,stress_zz_pa,stress_xy_pa,stress_yz_pa,stress_xz_pa,stress_uncertainty_pa,"
    "pressure_pa,pressure_uncertainty_pa\n";

std::string probes_csv(const scene::Scene& scene, const reference::Result& result, const reference::Inside& inside) {
  std::string text = probes_head;
  const auto add = [&text](double number) { text += "," + scene::number_text(number); };
  const std::vector<reference::ProbeInstant> probes = inside.probes();
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const reference::ProbeInstant& now = probes[i];
    const Eigen::RowVectorXd pressures_pa = reference::pressure_pa(now.values.stress_pa);
    for (Eigen::Index k = 0; k < now.values.displacement_m.cols(); ++k) {
      const scene::Probe& probe = scene.probes[static_cast<std::size_t>(k)];
      text += scene::number_text(result.instants[i].time_s) + "," + probe.name;
      for (const double x_m : probe.position_m) add(x_m);
      for (const double u_m : now.values.displacement_m.col(k)) add(u_m);
      add(now.displacement_uncertainty_m[k]);
      for (const int row : {0, 4, 8, 1, 5, 2}) add(now.values.stress_pa(row, k));
      add(now.stress_uncertainty_pa[k]);
      add(pressures_pa[k]);
      add(now.pressure_uncertainty_pa()[k]);
      text += "\n";
    }
  }
  return text;
}

}  // namespace

std::string write_inside(const std::filesystem::path& folder, const scene::Scene& scene,
                         const reference::Result& result, const reference::Inside& inside, bool volume) {
  std::string lines;
  const std::filesystem::path probes = folder / "probes.csv";
  if (scene.probes.empty()) {
    std::filesystem::remove(probes);
  } else {
    scene::write_file(probes, probes_csv(scene, result, inside));
    lines += "Probes: " + probes.string() + "\n";
  }
  if (volume) {
    write_volume(folder, result.instants, inside);
    lines += "Volume: " + (folder / "volume.pvd").string() + " (what is solved: " + result.model + ")\n";
  } else {
    write_volume(folder, std::vector<scene::InstantRecord>{}, inside);
    std::filesystem::remove(folder / "volume.pvd");
  }
  return lines;
}

}  // namespace touchstone::compare
