// A mesh together with the content of the file it was read from, which result folders keep a copy of.
#pragma once

#include "scene/triangle_mesh.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::scene {

/// As read_triangle_mesh(). @returns null when there were faults
[[nodiscard]] std::shared_ptr<const TriangleMesh> read_mesh_of_file(const std::filesystem::path& file, double unit_m,
                                                                    std::vector<Fault>& faults);

/// The file's content as it was when the mesh was read, whatever became of the file; null for a mesh that
/// read_mesh_of_file() did not read. It lives as long as the mesh.
[[nodiscard]] const std::string* content_of_file(const std::shared_ptr<const TriangleMesh>& mesh);

}  // namespace touchstone::scene
