#include "scene/mesh/mesh_file.h"
#include "scene/mesh/mesh_formats.h"
#include "scene/mesh/triangle_mesh.h"
#include "support/source_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>

#include <unistd.h>

namespace touchstone::scene {
namespace {

using testing::HasSubstr;

/// A regular grid of triangles on the sides of a box, without repeated vertices.
RawMesh box_mesh(const Vec3& lower, const Vec3& upper) {
  RawMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.points.push_back(
        {i & 1 ? upper.x() : lower.x(), i & 2 ? upper.y() : lower.y(), i & 4 ? upper.z() : lower.z()});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

void append(RawMesh& mesh, const RawMesh& other) {
  const auto shift = static_cast<std::int32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + shift, b + shift, c + shift});
}

std::string obj(const RawMesh& mesh) {
  std::ostringstream out;
  out.precision(17);
  for (const Vec3& p : mesh.points) out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  for (const auto& [a, b, c] : mesh.triangles) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return out.str();
}

std::string stl_text(const RawMesh& mesh) {
  std::ostringstream out;
  out << "solid box\n";
  for (const auto& triangle : mesh.triangles) {
    out << " facet normal 0 0 0\n  outer loop\n";
    for (const std::int32_t i : triangle) {
      const Vec3& p = mesh.points[static_cast<std::size_t>(i)];
      out << "   vertex " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
    out << "  endloop\n endfacet\n";
  }
  out << "endsolid box\n";
  return out.str();
}

template <class T>
void put(std::string& bytes, T value, bool big) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  if (big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// With properties and an additional element between the needed ones.
std::string ply(const RawMesh& mesh, const std::string& format) {
  std::ostringstream out;
  out << "ply\nformat " << format << " 1.0\ncomment none\nelement vertex " << mesh.points.size()
      << "\nproperty uchar red\nproperty double x\nproperty double y\nproperty float z\n"
      << "element material 1\nproperty list uchar short codes\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nproperty ushort flags\nend_header\n";
  if (format == "ascii") {
    for (const Vec3& p : mesh.points) out << "7 " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    out << "2 5 -5\n";
    for (const auto& [a, b, c] : mesh.triangles) out << "3 " << a << ' ' << b << ' ' << c << " 9\n";
    return out.str();
  }
  const bool big = format == "binary_big_endian";
  std::string bytes = out.str();
  for (const Vec3& p : mesh.points) {
    put(bytes, std::uint8_t{7}, big);
    put(bytes, p.x(), big);
    put(bytes, p.y(), big);
    put(bytes, static_cast<float>(p.z()), big);
  }
  put(bytes, std::uint8_t{2}, big);
  put(bytes, std::int16_t{5}, big);
  put(bytes, std::int16_t{-5}, big);
  for (const auto& triangle : mesh.triangles) {
    put(bytes, std::uint8_t{3}, big);
    for (const std::int32_t i : triangle) put(bytes, i, big);
    put(bytes, std::uint16_t{9}, big);
  }
  return bytes;
}

class MeshFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("touchstone-mesh-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::optional<TriangleMesh> read(const std::string& name, const std::string& bytes, double unit_m = 1.0) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    faults_.clear();
    return read_triangle_mesh(folder_ / name, unit_m, faults_);
  }
  /// The message with which the file is refused.
  std::string refusal(const std::string& name, const std::string& bytes) {
    const auto mesh = read(name, bytes);
    EXPECT_FALSE(mesh.has_value());
    EXPECT_EQ(faults_.size(), 1u);
    if (faults_.empty()) return "";
    EXPECT_EQ(faults_[0].file, (folder_ / name).string());
    return faults_[0].text();
  }
  std::string refusal(const RawMesh& mesh) { return refusal("mesh.obj", obj(mesh)); }

  std::filesystem::path folder_;
  std::vector<Fault> faults_;
  const RawMesh box_ = box_mesh(Vec3(-1, -2, 0), Vec3(1, 2, 3));
};

TEST_F(MeshFile, EveryFormatGivesTheSameBox) {
  TriangleMesh first;
  first.points_m.resize(3, 8);
  for (int i = 0; i < 8; ++i) first.points_m.col(i) = 1e-3 * box_.points[static_cast<std::size_t>(i)];
  first.triangles = box_.triangles;
  write_stl(first, folder_ / "written.stl", 1e-3);
  write_obj(first, folder_ / "written.obj", 1e-3);
  const auto bytes_of = [&](const char* name) {
    std::ifstream in(folder_ / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  std::string solid = bytes_of("written.stl");
  solid.replace(0, 6, "solid ");
  const std::vector<std::pair<std::string, std::string>> files = {{"a.obj", obj(box_)},
                                                                  {"a.stl", stl_text(box_)},
                                                                  {"b.STL", bytes_of("written.stl")},
                                                                  {"c.stl", solid},
                                                                  {"b.obj", bytes_of("written.obj")},
                                                                  {"a.ply", ply(box_, "ascii")},
                                                                  {"b.ply", ply(box_, "binary_little_endian")},
                                                                  {"c.ply", ply(box_, "binary_big_endian")}};
  for (const auto& [name, bytes] : files) {
    const auto mesh = read(name, bytes, 1e-3);
    ASSERT_TRUE(mesh.has_value()) << name << (faults_.empty() ? "" : faults_[0].text());
    EXPECT_EQ(mesh->points_m.cols(), 8) << name;
    EXPECT_EQ(mesh->triangles.size(), 12u) << name;
    EXPECT_NEAR(mesh->volume_m3(), 24e-9, 1e-21) << name;
    EXPECT_NEAR(mesh->area_m2(), 52e-6, 1e-18) << name;
    EXPECT_LT((mesh->centroid_m() - Vec3(0, 0, 1.5e-3)).norm(), 1e-15) << name;
    EXPECT_LT((mesh->bounds().lower_m - Vec3(-1e-3, -2e-3, 0)).norm(), 1e-15) << name;
  }
}

TEST_F(MeshFile, ObjFacesTakeEveryFormOfIndexAndPolygons) {
  const std::string points =
      "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv +1 1 1e0 1.0\n";
  const auto mesh = read("a.obj", "# a cube\nmtllib x.mtl\no cube\n" + points +
                                      "vt 0 0\nvn 0 0 1\ng side\nusemtl y\ns off\n"
                                      "f 1/1 3/1 4/1 2/1\nf 5//1 6//1 8//1 7//1\nf 1/1/1 2/1/1 6/1/1 5/1/1\n"
                                      "f 3 7 8 4\nf -8 -4 -2 -6\nf -7 -5 -1 -3\n");
  ASSERT_TRUE(mesh.has_value()) << faults_[0].text();
  EXPECT_EQ(mesh->triangles.size(), 12u);
  EXPECT_NEAR(mesh->volume_m3(), 8.0, 1e-14);
}

TEST_F(MeshFile, TurnsTrianglesOutwardsPieceByPiece) {
  RawMesh mesh = box_;
  append(mesh, box_mesh(Vec3(5, 0, 0), Vec3(6, 1, 1)));
  for (std::size_t t = 12; t < 24; ++t) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  std::swap(mesh.triangles[7][1], mesh.triangles[7][2]);
  const auto read_back = read("a.obj", obj(mesh));
  ASSERT_TRUE(read_back.has_value());
  EXPECT_NEAR(read_back->volume_m3(), 25.0, 1e-13);
}

TEST_F(MeshFile, WeldsNearDuplicatesAndDropsTrianglesWithoutArea) {
  RawMesh mesh;
  for (const auto& triangle : box_.triangles) {
    for (const std::int32_t i : triangle) {
      // The diagonal is 5.4: half the tolerance away.
      mesh.points.push_back(box_.points[static_cast<std::size_t>(i)] + 2.5e-9 * Vec3::Unit(mesh.points.size() % 3));
    }
    const auto last = static_cast<std::int32_t>(mesh.points.size()) - 1;
    mesh.triangles.push_back({last - 2, last - 1, last});
    mesh.triangles.push_back({last, last - 1, last});
  }
  const auto read_back = read("a.obj", obj(mesh));
  ASSERT_TRUE(read_back.has_value()) << faults_[0].text();
  EXPECT_EQ(read_back->points_m.cols(), 8);
  EXPECT_EQ(read_back->triangles.size(), 12u);
}

TEST_F(MeshFile, RefusesWhatBoundsNoSolid) {
  RawMesh open = box_;
  open.triangles.pop_back();
  EXPECT_THAT(refusal(open), HasSubstr("the surface is open: the edge from (1, "));

  RawMesh fin = box_;
  fin.points.push_back({0, 0, 9});
  fin.triangles.push_back({4, 5, 8});
  fin.triangles.push_back({5, 4, 8});
  EXPECT_THAT(refusal(fin), HasSubstr("has 4 triangles; expected 2"));
  EXPECT_THAT(refusal(fin), HasSubstr("(-1, -2, 3) to (1, -2, 3)"));

  RawMesh crossing = box_;
  append(crossing, box_mesh(Vec3(0.9, 0.1, 1.1), Vec3(4, 0.3, 1.3)));
  EXPECT_THAT(refusal(crossing), HasSubstr("the surface cuts or touches itself near (1, 0."));

  RawMesh touching = box_;
  append(touching, box_mesh(Vec3(1, 0.1, 1.1), Vec3(4, 0.3, 1.3)));
  EXPECT_THAT(refusal(touching), HasSubstr("cuts or touches itself near (1, 0."));

  RawMesh nested = box_;
  append(nested, box_mesh(Vec3(-0.5, -0.5, 1), Vec3(0.5, 0.5, 2)));
  EXPECT_THAT(refusal(nested), HasSubstr("lies inside another; cavities are not supported"));

  RawMesh flat;
  flat.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_THAT(refusal(flat), HasSubstr("encloses no volume"));

  EXPECT_THAT(refusal(RawMesh{}), HasSubstr("holds no triangle"));
}

TEST_F(MeshFile, RefusesATubeThatMeetsItselfInsideOut) {
  // The topology of a Klein bottle: a square grid, closed one way directly and the other way mirrored. With random
  // positions it intersects itself too, but first it is not orientable.
  constexpr int n = 5;
  RawMesh mesh;
  for (int i = 0; i < n * n; ++i)
    mesh.points.push_back({std::sin(7.0 * i), std::sin(11.0 * i + 1), std::sin(13.0 * i)});
  const auto at = [&](int i, int j) {
    if (i == n) return ((n - j) % n) + 0;
    return i * n + j % n;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  EXPECT_THAT(refusal(mesh), HasSubstr("not orientable"));
}

TEST_F(MeshFile, RefusesBrokenFilesWithThePlace) {
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\n"), HasSubstr("a.obj:3: a coordinate is not finite"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 x 0\n"), HasSubstr("a.obj:2: 'x' is not a number"));
  EXPECT_THAT(refusal("a.obj", "v 0 0\n"), HasSubstr("a.obj:1: the line is too short"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n"),
              HasSubstr("a.obj:5: vertex index 4 is out of"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n"), HasSubstr("vertex index -4 is out of"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"), HasSubstr("vertex index 0 is out of"));
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nf 1 1\n"), HasSubstr("a.obj:2: a face has fewer"));
  EXPECT_THAT(refusal("a.stl", ""), HasSubstr("byte 0: the file ends here"));
  EXPECT_THAT(refusal("a.stl", "solid x\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n endloop\n"),
              HasSubstr("a.stl:6: a facet has 2 vertices"));
  EXPECT_THAT(refusal("a.stl", "solid x\n vertex 0 0 0\n"), HasSubstr("ends within a facet"));
  EXPECT_THAT(refusal("a.xyz", "v 0 0 0\n"), HasSubstr("expected .stl, .obj or .ply"));
  EXPECT_THAT(refusal("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 1\n"),
              HasSubstr("a.ply:7: a vertex has no finite x, y and z"));
  EXPECT_THAT(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\n"),
              HasSubstr("a.ply:3: the header has no end"));

  std::string text = ply(box_, "ascii");
  text.replace(text.find("3 3 7 5 9"), 9, "3 3 8 5 9");
  EXPECT_THAT(refusal("a.ply", text), HasSubstr("a.ply:35: vertex index 8 is out of range; there are 8 vertices"));

  std::string binary = ply(box_, "binary_big_endian");
  binary.resize(binary.size() - 3);
  EXPECT_THAT(refusal("a.ply", binary),
              HasSubstr("byte " + std::to_string(binary.size()) + ": the file ends too early"));

  std::string stl(84 + 50 * 2, '\0');
  stl[80] = 3;
  stl.replace(0, 5, "solid");
  EXPECT_THAT(refusal("a.stl", stl), HasSubstr("byte 184: the file ends here; its count of triangles asks for 234"));
  stl[80] = 2;
  const float bad = INFINITY;
  std::memcpy(stl.data() + 84 + 12, &bad, sizeof bad);
  EXPECT_THAT(refusal("a.stl", stl), HasSubstr("byte 100: a coordinate is not finite"));
}

TEST_F(MeshFile, ElementsWithoutPropertiesAreRefusedAtOnce) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (int i = 0; i < 30; ++i) header += "element foo 1000000000\n";
  EXPECT_THAT(refusal("loop.ply", header + "end_header\n"),
              HasSubstr("loop.ply:33: element \"foo\" has no property; expected at least one"));
}

TEST_F(MeshFile, AByteOrderMarkIsPassedOver) {
  EXPECT_TRUE(read("marked.obj", "\xef\xbb\xbf" + obj(box_)).has_value());
  EXPECT_EQ(read_obj("\xef\xbb\xbf" + obj(box_), "marked.obj").points.size(), 8u);
}

TEST_F(MeshFile, LargerThanOtherToolsIsRefused) {
  for (const double reach : {1.1e4, 1e30, 1e155, 1e300}) {
    EXPECT_FALSE(read("huge.obj", obj(box_mesh(Vec3::Constant(-reach), Vec3::Constant(reach))), 1e-3).has_value());
    ASSERT_EQ(faults_.size(), 1u);
    EXPECT_THAT(faults_[0].text(), HasSubstr("expected at most 10.0 m (tool.unit)"));
  }
  EXPECT_TRUE(read("large.obj", obj(box_mesh(Vec3::Constant(-1e4), Vec3::Constant(1e4))), 1e-3).has_value());
}

/// Two cones on a ring of `count` points, each with all its triangles at one point.
RawMesh fan(int count) {
  RawMesh mesh;
  mesh.points = {Vec3(0.0, 0.0, 5.0), Vec3(0.0, 0.0, -5.0)};
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    mesh.points.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    const std::int32_t here = 2 + i, next = 2 + (i + 1) % count;
    mesh.triangles.push_back({0, here, next});
    mesh.triangles.push_back({1, next, here});
  }
  return mesh;
}

/// Separate tetrahedra.
RawMesh scattered(int count) {
  RawMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 at(0.003 * (i % 30), 0.003 * (i / 30 % 30), 0.003 * (i / 900));
    const std::int32_t first = 4 * i;
    for (const Vec3& off : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      mesh.points.push_back(at + 0.001 * off);
    for (const std::array<std::int32_t, 3>& t :
         {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{1, 2, 3}, std::array{0, 3, 2}})
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return mesh;
}

TEST_F(MeshFile, ThatWouldTakeLongToCheckIsRefusedByAStatedLimit) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(refusal(scattered(20000)), HasSubstr("20000 separate pieces; expected at most 1000"));
  EXPECT_THAT(refusal(fan(20000)), HasSubstr("too many long thin triangles side by side"));
  // Triangles without an area count too: they are in the file.
  std::string bytes(84 + 50 * 500'001, '\0');
  const std::uint32_t count = 500'001;
  std::memcpy(bytes.data() + 80, &count, sizeof count);
  EXPECT_THAT(refusal("many.stl", bytes), HasSubstr("the mesh has 500001 triangles; expected at most 500000"));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 10.0);
  EXPECT_TRUE(read("fan.obj", obj(fan(400)))->convex);
  EXPECT_TRUE(read("scattered.obj", obj(scattered(900))).has_value());
}

TEST_F(MeshFile, MissingFileIsNamed) {
  std::vector<Fault> faults;
  EXPECT_FALSE(read_triangle_mesh(folder_ / "none.stl", 1.0, faults).has_value());
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_THAT(faults[0].text(), HasSubstr("none.stl: cannot read the mesh: there is no such file"));
}

TEST_F(MeshFile, TakesTwentyThousandTriangles) {
  // A wavy torus: most boxes overlap another.
  constexpr int around = 200, across = 50;
  RawMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2.0 * std::numbers::pi * i / around, b = 2.0 * std::numbers::pi * j / across;
      const double radius = 3.0 + (1.0 + 0.1 * std::sin(9.0 * a)) * std::cos(b);
      mesh.points.push_back({radius * std::cos(a), radius * std::sin(a), std::sin(b)});
    }
  }
  const auto at = [&](int i, int j) { return (i % around) * across + j % across; };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  ASSERT_TRUE(read("a.obj", obj(mesh)).has_value()) << faults_[0].text();
}

TEST_F(MeshFile, ShippedToolsComeFromTheirGenerator) {
  ASSERT_EQ(std::system((std::string(TOUCHSTONE_MAKE_TOOLS) + " " + folder_.string() + " > /dev/null").c_str()), 0);
  for (const char* name : {"mallet.stl", "compass.obj", "stylus.stl"}) {
    const auto bytes_of = [&](const std::filesystem::path& file) {
      std::ifstream in(file, std::ios::binary);
      return std::string(std::istreambuf_iterator<char>(in), {});
    };
    const std::filesystem::path shipped = std::filesystem::path(source_folder()) / "meshes/tools" / name;
    EXPECT_TRUE(bytes_of(folder_ / name) == bytes_of(shipped)) << name;
    const auto mesh = read_triangle_mesh(shipped, 1e-3, faults_);
    ASSERT_TRUE(mesh.has_value()) << faults_[0].text();
    // A closed surface without handles.
    EXPECT_EQ(2 * mesh->points_m.cols(), static_cast<Eigen::Index>(mesh->triangles.size()) + 4) << name;
  }
}

}  // namespace
}  // namespace touchstone::scene
