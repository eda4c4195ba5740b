#include "fast/surface/surface_patches.h"

#include "scene/base/index.h"

#include <algorithm>
#include <limits>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// The normal of the patch's vertex closest to a point.
Vec3 normal_near(const scene::Surface& surface, const Patch& patch, const Vec3& p_m) {
  double closest_m2 = std::numeric_limits<double>::max();
  Vec3 normal = Vec3::UnitZ();
  for (std::int32_t v = patch.begin; v < patch.end; ++v) {
    const double distance_m2 = (surface.points_m.col(v) - p_m).squaredNorm();
    if (distance_m2 < closest_m2) {
      closest_m2 = distance_m2;
      normal = surface.normals.col(v);
    }
  }
  return normal;
}

VertexBlock block_of(const Columns3& rest_W_m, std::int32_t begin, std::int32_t end) {
  VertexBlock block;
  block.begin = begin;
  block.end = end;
  for (int axis = 0; axis < 3; ++axis) {
    const float* column = nth(rest_W_m, axis).data();
    const auto [low, high] = std::minmax_element(column + begin, column + end);
    block.low_W_m[axis] = *low;
    block.high_W_m[axis] = *high;
  }
  return block;
}

void add_blocks(const Columns3& rest_W_m, Patch& patch, std::vector<VertexBlock>& blocks) {
  patch.all = block_of(rest_W_m, patch.begin, patch.end);
  patch.first_block = static_cast<std::int32_t>(blocks.size());
  for (std::int32_t begin = patch.begin; begin < patch.end; begin += block_vertices) {
    blocks.push_back(block_of(rest_W_m, begin, std::min(begin + block_vertices, patch.end)));
  }
  patch.last_block = static_cast<std::int32_t>(blocks.size());
}

}  // namespace

std::size_t SurfacePatches::memory_bytes() const noexcept {
  return patches.size() * sizeof(Patch) + blocks.size() * sizeof(VertexBlock) + 11 * vertex_count() * sizeof(float);
}

SurfacePatches surface_patches(const scene::Surface& surface, const AnchorPoints& anchors) {
  SurfacePatches rest;
  for (int p = 0; p + 1 < static_cast<int>(surface.patch_begin.size()); ++p) {
    Patch patch;
    patch.begin = nth(surface.patch_begin, p);
    patch.end = nth(surface.patch_begin, p + 1);
    patch.corners = anchors.around(p).size();
    patch.anchor = nth(anchors.patches(), p);
    for (std::size_t k = 0; k < patch.anchor.size(); ++k) {
      patch.corner_normal[k] = normal_near(surface, patch, nth(anchors.points_m(), patch.anchor[k]));
    }
    const auto points_m = surface.points_m.middleCols(patch.begin, patch.end - patch.begin);
    patch.center_W_m = 0.5 * (points_m.rowwise().minCoeff() + points_m.rowwise().maxCoeff());
    patch.radius_m = (points_m.colwise() - patch.center_W_m).colwise().norm().maxCoeff();
    for (std::int32_t v = patch.begin; v < patch.end; ++v) {
      const PatchPlace at = anchors.at(p, surface.points_m.col(v));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rest.rest_W_m[axis].push_back(static_cast<float>(surface.points_m(static_cast<Eigen::Index>(axis), v)));
        rest.normal[axis].push_back(static_cast<float>(surface.normals(static_cast<Eigen::Index>(axis), v)));
      }
      for (std::size_t k = 0; k < at.weight.size(); ++k) {
        rest.weight[k].push_back(static_cast<float>(at.weight[k]));
      }
      rest.free.push_back(static_cast<float>(at.free));
    }
    add_blocks(rest.rest_W_m, patch, rest.blocks);
    rest.patches.push_back(patch);
  }
  return rest;
}

SurfaceField::SurfaceField(const Columns3& rest_normal) : normal(rest_normal) {
  for (auto& column : displacement_m) column.assign(rest_normal[0].size(), 0.0f);
}

void SurfaceField::reset(const Columns3& rest_normal) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::fill(displacement_m[axis].begin(), displacement_m[axis].end(), 0.0f);
    std::copy(rest_normal[axis].begin(), rest_normal[axis].end(), normal[axis].begin());
  }
}

Columns3 columns_of(const Eigen::Matrix3Xd& matrix) {
  Columns3 columns;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXf row = matrix.row(axis).transpose().cast<float>();
    nth(columns, axis).assign(row.begin(), row.end());
  }
  return columns;
}

Eigen::Matrix3Xd matrix_of(const Columns3& columns) {
  Eigen::Matrix3Xd matrix(3, static_cast<Eigen::Index>(columns[0].size()));
  for (int axis = 0; axis < 3; ++axis) {
    const auto& column = nth(columns, axis);
    matrix.row(axis) =
        Eigen::Map<const Eigen::RowVectorXf>(column.data(), static_cast<Eigen::Index>(column.size())).cast<double>();
  }
  return matrix;
}

}  // namespace touchstone::fast
