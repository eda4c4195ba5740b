#include "scene/shape/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

using Vec2 = Eigen::Vector2d;

std::string corner(const Profile& profile, std::size_t i) {
  const Vec2& p = profile.rz_m[i];
  return fmt::format("corner {} at (r, z) = ({:.6g}, {:.6g}) m", i, p.x(), p.y());
}

/// Normal of a piece of the profile at its start or end, as the angle above the horizontal. It increases along a convex
/// one.
RevolutionPiece piece_between(const Vec2& start_m, const Vec2& end_m, double radius_m) noexcept {
  RevolutionPiece piece;
  piece.start_m = start_m;
  piece.end_m = end_m;
  const Vec2 chord = end_m - start_m;
  const double chord_m = chord.norm();
  if (radius_m == 0.0) {
    piece.length_m = chord_m;
    piece.start_angle = piece.end_angle = std::atan2(-chord.x(), chord.y());
    return piece;
  }
  piece.radius_m = radius_m;
  const Vec2 inward = Vec2(-chord.y(), chord.x()) / chord_m;
  const double height_m = std::sqrt(std::max(0.0, (radius_m - 0.5 * chord_m) * (radius_m + 0.5 * chord_m)));
  piece.center_m = 0.5 * (start_m + end_m) + height_m * inward;
  const Vec2 out = start_m - piece.center_m, last = end_m - piece.center_m;
  piece.start_angle = std::atan2(out.y(), out.x());
  // Counted on from the start, so that an arc beyond half a turn is distinguished from its complement.
  const double turn = std::atan2(cross(out, last), out.dot(last));
  piece.end_angle = piece.start_angle + turn;
  piece.length_m = radius_m * turn;
  return piece;
}

void check_corners(const Profile& profile, std::vector<std::string>& faults) {
  const std::size_t last = profile.rz_m.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const double r = profile.rz_m[i].x();
    if (!profile.rz_m[i].allFinite()) {
      faults.push_back(corner(profile, i) + " is not finite");
    } else if ((i == 0 || i == last) && r != 0.0) {
      faults.push_back(corner(profile, i) + " is off the axis; a profile starts and ends at r = 0");
    } else if (i > 0 && i < last && r <= 0.0) {
      faults.push_back(corner(profile, i) + (r < 0.0 ? " lies" : " touches the axis; it should lie") +
                       (r < 0.0 ? " at a negative radius" : " at r > 0, only the ends are on the axis"));
    }
  }
}

void check_pieces(const Profile& profile, std::vector<std::string>& faults) {
  for (std::size_t i = 0; i + 1 < profile.rz_m.size(); ++i) {
    const double chord_m = (profile.rz_m[i + 1] - profile.rz_m[i]).norm();
    const double radius_m = profile.arc_radius_m.empty() ? 0.0 : profile.arc_radius_m[i];
    const std::string piece = "the piece after " + corner(profile, i);
    if (chord_m == 0.0) {
      faults.push_back(piece + " has no length");
    } else if (!(radius_m >= 0.0) || !std::isfinite(radius_m)) {
      faults.push_back(fmt::format("{} has arc radius {:.6g} m; expected 0 for straight, or more", piece, radius_m));
    } else if (radius_m > 0.0 && radius_m <= 0.5 * chord_m) {
      faults.push_back(fmt::format(
          "{} has arc radius {:.6g} m; expected more than half its chord, {:.6g} m (divide a half circle in two)",
          piece, radius_m, 0.5 * chord_m));
    }
  }
}

/// The normal must turn monotonically from straight down to straight up, or the body is concave.
void check_convex(const Profile& profile, std::vector<std::string>& faults) {
  double before = -quarter;
  const std::size_t pieces = profile.rz_m.size() - 1;
  for (std::size_t i = 0; i < pieces; ++i) {
    const RevolutionPiece piece = profile_piece(profile, i);
    if (piece.start_angle < before - smooth_turn || piece.start_angle > before + std::numbers::pi) {
      faults.push_back(corner(profile, i) + " turns inwards; the body would not be convex");
      return;
    }
    before = piece.end_angle;
  }
  if (before > quarter + smooth_turn) {
    faults.push_back(corner(profile, pieces) + " dips inwards at the axis; the body would not be convex");
  }
}

Profile without_empty_pieces(std::initializer_list<std::pair<Vec2, double>> corners_and_arcs) {
  Profile profile;
  double arc_m = 0.0;
  for (const auto& [corner_m, next_arc_m] : corners_and_arcs) {
    if (profile.rz_m.empty() || profile.rz_m.back() != corner_m) {
      if (!profile.rz_m.empty()) profile.arc_radius_m.push_back(arc_m);
      profile.rz_m.push_back(corner_m);
    }
    arc_m = next_arc_m;
  }
  return profile;
}

}  // namespace

RevolutionPiece profile_piece(const Profile& profile, std::size_t index) noexcept {
  return piece_between(profile.rz_m[index], profile.rz_m[index + 1],
                       profile.arc_radius_m.empty() ? 0.0 : profile.arc_radius_m[index]);
}

std::vector<std::string> profile_faults(const Profile& profile) {
  std::vector<std::string> faults;
  if (profile.rz_m.size() < 3) {
    return {"a profile needs at least three corners, found " + std::to_string(profile.rz_m.size())};
  }
  if (!profile.arc_radius_m.empty() && profile.arc_radius_m.size() + 1 != profile.rz_m.size()) {
    return {"expected one arc radius per piece, " + std::to_string(profile.rz_m.size() - 1) + ", found " +
            std::to_string(profile.arc_radius_m.size())};
  }
  check_corners(profile, faults);
  check_pieces(profile, faults);
  if (faults.empty()) check_convex(profile, faults);
  return faults;
}

bool flat_bottom(const Profile& profile) noexcept {
  if (profile.rz_m.size() < 2) return false;
  const RevolutionPiece first = profile_piece(profile, 0);
  return first.straight() && first.start_angle <= smooth_turn - quarter;
}

Profile capsule_profile(double radius_m, double length_m) {
  const double half_m = 0.5 * length_m;
  return without_empty_pieces({{Vec2(0.0, -half_m - radius_m), radius_m},
                               {Vec2(radius_m, -half_m), 0.0},
                               {Vec2(radius_m, half_m), radius_m},
                               {Vec2(0.0, half_m + radius_m), 0.0}});
}

Profile cylinder_profile(double radius_m, double length_m, double edge_radius_m) {
  const double half_m = 0.5 * length_m, face_m = radius_m - edge_radius_m;
  // Not half_m - edge_radius_m twice: without a straight side both corners in the middle coincide.
  const double side_m = std::max(0.0, half_m - edge_radius_m);
  return without_empty_pieces({{Vec2(0.0, -half_m), 0.0},
                               {Vec2(face_m, -half_m), edge_radius_m},
                               {Vec2(radius_m, -side_m), 0.0},
                               {Vec2(radius_m, side_m), edge_radius_m},
                               {Vec2(face_m, half_m), 0.0},
                               {Vec2(0.0, half_m), 0.0}});
}

}  // namespace touchstone::scene
