#include "reference/calculix/deck.h"

#include "reference/calculix/tool.h"
#include "reference/run/model_choice.h"
#include "reference/tool/tool_gap.h"
#include "scene/base/in_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

namespace touchstone::reference {
namespace {

using scene::Scene;
using scene::Vec3;

/// Nodes of a cell that the serendipity element has: indices in lexicographic order, in CalculiX's order (corners, then
/// edge midpoints).
template <int dim>
struct Kept;
template <>
struct Kept<2> {
  static constexpr std::array places{0, 2, 8, 6, 1, 5, 7, 3};
};
template <>
struct Kept<3> {
  static constexpr std::array places{0, 2, 8, 6, 18, 20, 26, 24, 1, 5, 7, 3, 19, 23, 25, 21, 9, 11, 17, 15};
};
/// Centres of a cell's faces in CalculiX's order.
template <int dim>
constexpr auto side_middles() {
  if constexpr (dim == 2) {
    return std::array{1, 5, 7, 3};
  } else {
    return std::array{4, 22, 10, 14, 16, 12};
  }
}

/// The reference's mesh as serendipity elements.
template <int dim>
class ReducedMesh {
 public:
  /// A displacement as a weighted sum of free ones.
  using Sum = std::map<int, double>;

  explicit ReducedMesh(Mesh<dim> mesh) : mesh_(std::move(mesh)), kept_(mesh_.node_count()) {
    for (const auto& cell : mesh_.cells) {
      for (const int place : Kept<dim>::places) kept_[cell[place]] = true;
    }
    for (const auto& hanging : mesh_.hanging) hanging_.emplace(hanging.node, &hanging);
    if constexpr (dim == 3) find_side_middles();
    for (int node = 0; node < mesh_.node_count(); ++node) {
      if (!kept_[node] || (!hanging_.contains(node) && !around_.contains(node))) continue;
      Sum& sum = ties_[node];
      add(node, 1.0, sum);
      std::erase_if(sum, [](const auto& term) { return std::abs(term.second) < 1e-12; });
    }
    for (const auto& [node, sum] : ties_) {
      mesh_.points_m.col(node).setZero();
      for (const auto& [master, weight] : sum) mesh_.points_m.col(node) += weight * mesh_.points_m.col(master);
    }
  }

  [[nodiscard]] const Mesh<dim>& mesh() const { return mesh_; }
  [[nodiscard]] bool kept(int node) const { return kept_[node] != 0; }
  /// A node of the deck that is not tied to others.
  [[nodiscard]] bool free(int node) const { return kept_[node] && !ties_.contains(node); }
  [[nodiscard]] const std::map<int, Sum>& ties() const { return ties_; }

 private:
  /// The eight nodes around the centre of every face, corners first.
  void find_side_middles() {
    for (const auto& cell : mesh_.cells) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const int layer : {0, 2}) {
          std::array<int, 9> side;
          int next = 0;
          for (int a = 0; a < 27; ++a) {
            const int place[3] = {a % 3, a / 3 % 3, a / 9};
            if (place[axis] == layer) side[next++] = cell[a];
          }
          // A node that is in the deck only as a corner of smaller cells on the other side, or as the master of a
          // hanging node.
          if (!hanging_.contains(side[4])) {
            around_[side[4]] = {side[0], side[2], side[6], side[8], side[1], side[3], side[5], side[7]};
          }
        }
      }
    }
  }

  /// The trace of a serendipity element equals that of the nine-node element whose centre node has the interpolated
  /// value.
  void add(int node, double weight, Sum& sum) const {
    if (const auto found = hanging_.find(node); found != hanging_.end()) {
      for (const auto& [master, share] : found->second->masters) add(master, weight * share, sum);
    } else if (const auto side = around_.find(node); side != around_.end()) {
      for (int k = 0; k < 8; ++k) add(side->second[k], weight * (k < 4 ? -0.25 : 0.5), sum);
    } else {
      sum[node] += weight;
    }
  }

  Mesh<dim> mesh_;
  std::vector<char> kept_;
  std::map<int, const typename Mesh<dim>::Hanging*> hanging_;
  std::map<int, std::array<int, 8>> around_;
  std::map<int, Sum> ties_;
};

constexpr const char* support_set = "SUPPORT";

/// Instants of the deck: from the first one in contact, and the pose before it.
struct Path {
  scene::Pose start;
  std::vector<int> instants;
  std::vector<scene::Pose> poses;
  double deepest_m = 0.0;
};

Path path_of(const Scene& scene) {
  constexpr double shallowest_share = 1e-6;  // of the largest depth; smaller ones are round-off
  const auto body = scene::body_shape(scene.body);
  std::vector<double> depths_m;
  Path path;
  for (const double time_s : scene::instants_s(scene)) {
    const scene::Pose pose = scene::pose_at(scene.track, time_s);
    path.poses.push_back(pose);
    depths_m.push_back(scene::rest_depth_m(*body, scene.tool, pose));
  }
  path.deepest_m = *std::max_element(depths_m.begin(), depths_m.end());
  const auto touches = [&](double depth_m) { return depth_m > shallowest_share * path.deepest_m; };
  const auto first = std::find_if(depths_m.begin(), depths_m.end(), touches) - depths_m.begin();
  // A scene begins without contact.
  path.start = path.poses[std::max<std::ptrdiff_t>(first - 1, 0)];
  path.poses.erase(path.poses.begin(), path.poses.begin() + first);
  path.instants.resize(path.poses.size());
  std::iota(path.instants.begin(), path.instants.end(), static_cast<int>(first));
  return path;
}

/// Pressure over overclosure. The depth lost is Hertz's mean pressure 4 E* d / (3 pi a) divided by this.
double contact_stiffness_pa_per_m(const Scene& scene, const ModelChoice& choice) {
  constexpr double share = 1000.0;
  return share * scene.body.material.contact_modulus_pa() / choice.half_width_m;
}

template <int dim>
class Writer {
 public:
  using Point = Eigen::Matrix<double, dim, 1>;

  Writer(const Scene& scene, const ModelChoice& choice, const DeckOptions& options)
      : scene_(scene),
        choice_(choice),
        options_(options),
        path_(path_of(scene)),
        body_(level_mesh<dim>(scene, choice, options.level)),
        small_(scene.reference.kinematics == scene::Kinematics::small),
        // Observed with version 2.20: a face that the axis reduces to an edge carries no contact, and its nodes
        // penetrate the tool.
        bore_m_(1e-3 * element_size_m(scene, choice, options.level)) {
    text_ << std::setprecision(12);
  }

  Deck deck() {
    deck_.model = (dim == 2 ? std::string("axisymmetric CAX8R ") : sector_name() + " C3D20R ") +
                  (small_ ? "small strain" : "finite strain");
    deck_.axisymmetric = dim == 2;
    deck_.instants = path_.instants;
    // CalculiX models the meridian plane as a sector of two degrees.
    constexpr double sectors = 180.0;
    const double images = dim == 2 ? sectors : (choice_.mirror_x ? 2.0 : 1.0) * (choice_.mirror_y ? 2.0 : 1.0);
    deck_.whole_body = Vec3::Constant(images);
    if (dim == 2 || choice_.mirror_x) deck_.whole_body.x() = 0.0;
    if (dim == 2 || choice_.mirror_y) deck_.whole_body.y() = 0.0;
    header(images);
    body_elements();
    boundary();
    tool_elements();
    materials();
    contact();
    steps();
    deck_.text = text_.str();
    return std::move(deck_);
  }

 private:
  [[nodiscard]] std::string sector_name() const {
    return choice_.mirror_x && choice_.mirror_y ? "quarter" : (choice_.mirror_x || choice_.mirror_y ? "half" : "full");
  }

  void header(double images) {
    text_ << "** " << (scene_.title.empty() ? scene_.name : scene_.title) << "\n"
          << "** " << deck_.model << ", SI units, written by touchstone export\n**\n"
          << "** Run it as: ccx -i NAME, where this file is NAME.inp. The results are in NAME.dat.\n"
          << "** Step k ends at the time in its comment. \"total force ... for set " << deck_tool_set
          << "\" holds the tool in its place\n"
          << "** in this model; minus " << images
          << " times as much acts on the tool from the whole body. (The sum of the "
          << "support's reactions\n** lacks what tied nodes pass on to it.)\n";
    if (dim == 2) {
      text_ << "** (A sector of two degrees is solved. The second component is along the axis. The axis is a bore of "
            << bore_m_ << " m.)\n";
    }
    if (choice_.dim == 3 && (choice_.mirror_x || choice_.mirror_y)) {
      text_ << "** (Components across a symmetry plane cancel in the whole body.)\n";
    }
    if (!scene_.body.inclusions.empty()) text_ << "** Every element has the material at its centre.\n";
    if (scene_.contact.friction) {
      text_
          << "** Friction is Coulomb's with the scene's mu_D alone; the static limit K F_n^beta has no counterpart.\n";
    }
  }

  template <class Numbers>
  void list(const Numbers& numbers) {
    int column = 0;
    for (const int number : numbers) text_ << number << (++column % 12 == 0 ? ",\n" : ", ");
    if (column % 12 != 0) text_ << '\n';
  }

  template <class Nodes>
  void element(int number, const Nodes& nodes) {
    text_ << number;
    int column = 1;
    for (const int node : nodes) text_ << (column++ % 12 == 0 ? ",\n" : ", ") << node;
    text_ << '\n';
  }

  /// @param bore_m  smallest distance of a meridian's node from the axis
  void node(int number, Point place_m, double bore_m) {
    if (dim == 2) place_m[0] = std::max(place_m[0], bore_m);
    text_ << number;
    for (const double x_m : place_m) text_ << ", " << x_m;
    text_ << '\n';
  }

  void body_elements() {
    const Mesh<dim>& mesh = body_.mesh();
    text_ << "*NODE, NSET=BODY\n";
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (!body_.kept(n)) continue;
      node(n + 1, mesh.points_m.col(n), bore_m_);
      ++deck_.nodes;
    }
    text_ << "*ELEMENT, TYPE=" << (dim == 2 ? "CAX8R" : "C3D20R") << ", ELSET=BODY\n";
    for (int c = 0; c < mesh.cell_count(); ++c) {
      std::array<int, Kept<dim>::places.size()> nodes;
      for (std::size_t k = 0; k < nodes.size(); ++k) nodes[k] = mesh.cells[c][Kept<dim>::places[k]] + 1;
      element(c + 1, nodes);
    }
    text_ << "** nodes on the side of a larger element\n";
    for (const auto& [tied, sum] : body_.ties()) {
      for (int d = 1; d <= dim; ++d) {
        text_ << "*EQUATION\n" << sum.size() + 1 << '\n' << tied + 1 << ", " << d << ", -1.";
        int term = 1;
        for (const auto& [master, weight] : sum) {
          text_ << (term++ % 4 == 0 ? ",\n" : ", ") << master + 1 << ", " << d << ", " << weight;
        }
        text_ << '\n';
      }
    }
  }

  void boundary() {
    const Mesh<dim>& mesh = body_.mesh();
    std::map<Boundary, std::set<int>> nodes;
    for (const auto& face : mesh.faces) {
      for (const int n : face.nodes) {
        if (body_.free(n)) nodes[face.boundary].insert(n + 1);
      }
    }
    const std::set<int>& held = nodes[Boundary::held];
    set(support_set, held);
    for (const auto& [plane, name] :
         {std::pair(Boundary::plane_x, "PLANE_X"), std::pair(Boundary::plane_y, "PLANE_Y")}) {
      std::erase_if(nodes[plane], [&](int n) { return held.contains(n); });
      if (!nodes[plane].empty()) set(name, nodes[plane]);
    }
    set(deck_surface_set, nodes[Boundary::free]);
    deck_.surface_nodes.assign(nodes[Boundary::free].begin(), nodes[Boundary::free].end());
    deck_.surface_points_m.resize(3, static_cast<Eigen::Index>(deck_.surface_nodes.size()));
    for (std::size_t k = 0; k < deck_.surface_nodes.size(); ++k) {
      deck_.surface_points_m.col(k) = scene::in_space<dim>(mesh.points_m.col(deck_.surface_nodes[k] - 1));
    }
    text_ << "*BOUNDARY\n" << support_set << ", 1, " << dim << '\n';
    if (!nodes[Boundary::plane_x].empty()) text_ << "PLANE_X, 1, 1\n";
    if (!nodes[Boundary::plane_y].empty()) text_ << "PLANE_Y, 2, 2\n";
    contact_faces(mesh);
  }

  void set(const std::string& name, const std::set<int>& nodes) {
    text_ << "*NSET, NSET=" << name << '\n';
    list(nodes);
  }

  /// Whether the tool ever comes as close to a point of the body at rest as its largest depth.
  [[nodiscard]] bool reached(const Vec3& place_m) const {
    return std::any_of(path_.poses.begin(), path_.poses.end(), [&](const scene::Pose& pose) {
      return choice_.tool->at(pose.orientation.conjugate() * (place_m - pose.position_m)).value_m < path_.deepest_m;
    });
  }

  void contact_faces(const Mesh<dim>& mesh) {
    std::map<int, std::pair<int, int>> sides;  // by the face's centre: element and its face, counted from 1
    for (int c = 0; c < mesh.cell_count(); ++c) {
      constexpr auto middles = side_middles<dim>();
      for (std::size_t side = 0; side < middles.size(); ++side) {
        sides[mesh.cells[c][middles[side]]] = {c + 1, static_cast<int>(side) + 1};
      }
    }
    text_ << "*SURFACE, NAME=BODY_CONTACT, TYPE=ELEMENT\n";
    for (const auto& face : mesh.faces) {
      if (face.boundary != Boundary::free) continue;
      if (std::none_of(face.nodes.begin(), face.nodes.end(),
                       [&](int n) { return reached(scene::in_space<dim>(mesh.points_m.col(n))); })) {
        continue;
      }
      const auto [cell, side] = sides.at(face.nodes[Mesh<dim>::nodes_per_face / 2]);
      text_ << cell << ", S" << side << '\n';
    }
  }

  /// The tool at its first pose.
  void tool_elements() {
    first_tool_node_ = body_.mesh().node_count() + 1;
    const scene::Pose& start = path_.start;
    if constexpr (dim == 2) {
      coat_ = meridian_coat(scene_.tool, start.orientation, choice_);
    } else {
      const auto body = scene::body_shape(scene_.body);
      coat_ = surface_coat(scene_.tool, choice_, [&](const Vec3& p_T_m) {
        return std::any_of(path_.poses.begin(), path_.poses.end(), [&](const scene::Pose& pose) {
          return body->signed_distance_m(pose.orientation * p_T_m + pose.position_m) < path_.deepest_m;
        });
      });
    }
    text_ << "*NODE, NSET=" << deck_tool_set << '\n';
    for (Eigen::Index n = 0; n < coat_.points_m.cols(); ++n) {
      node(first_tool_node_ + static_cast<int>(n), placed(coat_.points_m.col(n), start), 0.25 * bore_m_);
    }
    text_ << "*ELEMENT, TYPE=" << (dim == 2 ? "CAX8R" : "C3D15") << ", ELSET=TOOL\n";
    int number = body_.mesh().cell_count();
    const int first = number + 1;
    for (auto nodes : coat_.elements) {
      for (int& n : nodes) n += first_tool_node_;
      element(++number, nodes);
    }
    text_ << "*SURFACE, NAME=TOOL_CONTACT, TYPE=ELEMENT\n";
    for (int e = first; e <= number; ++e) text_ << e << ", S" << ToolCoat<dim>::surface_face << '\n';
  }

  [[nodiscard]] static Point placed(const Point& p_T_m, const scene::Pose& pose) {
    if constexpr (dim == 3) {
      return pose.orientation * p_T_m + pose.position_m;
    } else {
      return p_T_m + Point(0.0, pose.position_m.z());
    }
  }

  void material(const std::string& name, const scene::Material& material) {
    text_ << "*MATERIAL, NAME=" << name << '\n';
    if (small_) {
      text_ << "*ELASTIC\n" << material.youngs_modulus_pa << ", " << material.poissons_ratio << '\n';
    } else {
      text_ << "*HYPERELASTIC, NEO HOOKE\n"
            << 0.5 * material.shear_modulus_pa() << ", " << 2.0 / material.bulk_modulus_pa() << '\n';
    }
  }

  void materials() {
    const Mesh<dim>& mesh = body_.mesh();
    std::vector<std::vector<int>> cells(mesh.inclusion_materials.size() + 1);
    for (int c = 0; c < mesh.cell_count(); ++c) {
      // The middle Gauss point is the cell's centre.
      const auto* materials = mesh.materials_of(c);
      cells[materials ? (*materials)[Mesh<dim>::nodes_per_cell / 2] : 0].push_back(c + 1);
    }
    for (std::size_t m = 0; m < cells.size(); ++m) {
      const std::string name = m == 0 ? "OF_BODY" : "OF_INCLUSION_" + std::to_string(m);
      if (cells[m].empty()) continue;
      text_ << "*ELSET, ELSET=" << name << '\n';
      list(cells[m]);
      material(name, m == 0 ? scene_.body.material : mesh.inclusion_materials[m - 1]);
      text_ << "*SOLID SECTION, ELSET=" << name << ", MATERIAL=" << name << '\n';
    }
    text_ << "** every node of the tool is moved: its material does not matter\n"
          << "*MATERIAL, NAME=OF_TOOL\n*ELASTIC\n"
          << scene_.body.material.youngs_modulus_pa << ", 0.\n*SOLID SECTION, ELSET=TOOL, MATERIAL=OF_TOOL\n";
  }

  void contact() {
    const double stiffness_pa_per_m =
        options_.contact_stiffness_pa_per_m.value_or(contact_stiffness_pa_per_m(scene_, choice_));
    text_ << "*SURFACE INTERACTION, NAME=CONTACT\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n"
          << stiffness_pa_per_m << '\n';
    if (scene_.contact.friction) {
      constexpr double stick_share = 0.1;
      text_ << "*FRICTION\n" << scene_.contact.friction->mu_D << ", " << stick_share * stiffness_pa_per_m << '\n';
    }
    text_ << "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE\nBODY_CONTACT, TOOL_CONTACT\n";
  }

  void steps() {
    const std::vector<double> times_s = scene::instants_s(scene_);
    const bool turns = dim == 3 && std::any_of(path_.poses.begin(), path_.poses.end(), [&](const scene::Pose& pose) {
                         return pose.orientation.angularDistance(path_.start.orientation) > 1e-12;
                       });
    for (std::size_t step = 0; step < path_.instants.size(); ++step) {
      text_ << "** step " << step + 1 << ": time " << times_s[path_.instants[step]] << " s\n"
            << "*STEP, INC=1000" << (small_ ? "" : ", NLGEOM") << "\n*STATIC\n1., 1.\n*BOUNDARY\n";
      const scene::Pose& pose = path_.poses[step];
      if (turns) {
        for (Eigen::Index n = 0; n < coat_.points_m.cols(); ++n) {
          const Point moved_m = placed(coat_.points_m.col(n), pose) - placed(coat_.points_m.col(n), path_.start);
          move(std::to_string(first_tool_node_ + static_cast<int>(n)), moved_m);
        }
      } else {
        move(deck_tool_set, placed(Point::Zero(), pose) - placed(Point::Zero(), path_.start));
      }
      text_ << "*NODE PRINT, NSET=" << deck_tool_set << ", FREQUENCY=1000, TOTALS=ONLY\nRF\n"
            << "*NODE PRINT, NSET=" << deck_surface_set << ", FREQUENCY=1000\nU\n*END STEP\n";
    }
  }

  void move(const std::string& nodes, const Point& by_m) {
    for (int d = 0; d < dim; ++d) text_ << nodes << ", " << d + 1 << ", " << d + 1 << ", " << by_m[d] << '\n';
  }

  const Scene& scene_;
  const ModelChoice& choice_;
  const DeckOptions& options_;
  Path path_;
  ReducedMesh<dim> body_;
  bool small_;
  double bore_m_;
  ToolCoat<dim> coat_;
  int first_tool_node_ = 0;
  std::ostringstream text_;
  Deck deck_;
};

}  // namespace

std::vector<scene::Fault> unsupported_in_deck(const Scene& scene) {
  std::vector<scene::Fault> faults;
  const auto check = [&](const std::string& key, const scene::Material& material) {
    if (material.poissons_ratio <= largest_deck_poissons_ratio) return;
    faults.push_back({"", 0, 0,
                      fmt::format("{0}: CalculiX needs a finite bulk modulus; expected at most {1:g}, found {2:g}; "
                                  "--set {0}={1:g} writes the scene nearest to it",
                                  key, largest_deck_poissons_ratio, material.poissons_ratio)});
  };
  check("body.material.poissons_ratio", scene.body.material);
  for (std::size_t i = 0; i < scene.body.inclusions.size(); ++i) {
    check("body.inclusion[" + std::to_string(i) + "].material.poissons_ratio", scene.body.inclusions[i].material);
  }
  return faults;
}

Deck calculix_deck(const Scene& scene, const DeckOptions& options) {
  if (std::vector<scene::Fault> faults = unsupported_in_deck(scene); !faults.empty()) {
    throw scene::InputError(std::move(faults));
  }
  const ModelChoice choice = choose_model(scene);
  if (choice.contacts.empty()) throw scene::InputError("track: the tool never touches the body");
  return choice.dim == 2 ? Writer<2>(scene, choice, options).deck() : Writer<3>(scene, choice, options).deck();
}

}  // namespace touchstone::reference
