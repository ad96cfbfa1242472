// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/matching_sheets.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

namespace moiregauge::internal {
namespace {

// Tolerances for sheets of one template, viewed at up to 40 degrees. They cover the perspective between a grating's
// centre, where its lattice is known, and its circle a few pitches away.
constexpr double kSameSize = 0.12;      // relative, of the circle's diameter
constexpr double kSameDistance = 0.12;  // relative, of the distance of the two centres
constexpr double kPlaceSpread = 0.4;    // pitches: error of a patch's centre if its edge is not sharp
constexpr double kExtentSpread = 0.8;   // pitches: an outline may end half a pitch inside the grating on either side
constexpr double kRound = 0.10;         // in ln(major / minor) on the plane

// A circle and its grating, measured in pitches of the grating.
struct Pair {
  LikeSheet sheet;
  double diameter = 0.0, distance = 0.0;  // pitches
  double shorter = 0.0, longer = 0.0;     // pitches, sides of the grating
  bool dark = true;
  double edge_px = 0.0;  // px, from the circle's centre to the grating's edge
};

// Returns the lattice in pitches per px. A line grating determines one axis; the other is assumed equal and square to
// it.
Eigen::Matrix2d lattice_of(const DetectedPatch& p) {
  Eigen::Matrix2d k;
  k << p.k_x.x, p.k_x.y, p.k_y.x, p.k_y.y;
  if (p.pattern == Pattern::kLinesX) k.row(1) << p.k_x.y, -p.k_x.x;
  if (p.pattern == Pattern::kLinesY) k.row(0) << -p.k_y.y, p.k_y.x;
  return k;
}

bool shows_the_plane(const DetectedPatch& p) { return p.pattern != Pattern::kLinesX && p.pattern != Pattern::kLinesY; }

// Returns the diameters of the circle along its axes on the grating's plane, in pitches, larger first.
Eigen::Vector2d on_plane(const DetectedCircle& circle, const DetectedPatch& patch) {
  const double c = std::cos(circle.angle_rad), s = std::sin(circle.angle_rad);
  const double major = circle.diameter_px / std::sqrt(circle.axis_ratio), minor = major * circle.axis_ratio;
  Eigen::Matrix2d axes;  // the ellipse's, as columns
  axes << c * major, -s * minor, s * major, c * minor;
  return Eigen::JacobiSVD<Eigen::Matrix2d>(lattice_of(patch) * axes).singularValues();
}

std::optional<Pair> pair_of(const DetectedCircle& circle, const DetectedPatch& patch) {
  Pair pair;
  pair.edge_px = distance_px(patch, circle.centre);
  if (pair.edge_px > kGratingReach * circle.diameter_px || holds(patch, circle.centre)) return std::nullopt;
  if (out_of_round(circle, patch) > std::hypot(kRound, kRoundPx / circle.diameter_px)) return std::nullopt;
  const Eigen::Vector2d diameters = on_plane(circle, patch);
  pair.diameter = std::sqrt(diameters[0] * diameters[1]);
  pair.distance =
      (lattice_of(patch) * Eigen::Vector2d(circle.centre.x - patch.centre.x, circle.centre.y - patch.centre.y)).norm();
  pair.shorter = std::min(patch.periods_x, patch.periods_y);
  pair.longer = std::max(patch.periods_x, patch.periods_y);
  pair.dark = circle.contrast < 0.0;
  return pair;
}

// Pairs circles and gratings by increasing distance; each circle and each grating is in one pair at most.
std::vector<Pair> nearest_pairs(std::span<const DetectedCircle> circles, std::span<const DetectedPatch> patches) {
  std::vector<Pair> all;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    for (std::size_t j = 0; j < patches.size(); ++j) {
      auto pair = pair_of(circles[i], patches[j]);
      if (!pair) continue;
      pair->sheet = {i, j};
      all.push_back(*pair);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Pair& a, const Pair& b) { return a.edge_px < b.edge_px; });
  std::vector<Pair> out;
  for (const Pair& p : all) {
    const bool taken = std::any_of(out.begin(), out.end(), [&](const Pair& o) {
      return o.sheet.circle == p.sheet.circle || o.sheet.patch == p.sheet.patch;
    });
    if (!taken) out.push_back(p);
  }
  return out;
}

bool alike_pairs(const Pair& a, const Pair& b) {
  return a.dark == b.dark && std::abs(std::log(a.diameter / b.diameter)) < kSameSize &&
         std::abs(a.distance - b.distance) < kPlaceSpread + kSameDistance * b.distance &&
         std::abs(a.shorter - b.shorter) < kExtentSpread && std::abs(a.longer - b.longer) < kExtentSpread;
}

}  // namespace

double out_of_round(const DetectedCircle& circle, const DetectedPatch& patch) {
  if (!shows_the_plane(patch)) return 0.0;
  const Eigen::Vector2d diameters = on_plane(circle, patch);
  return std::log(diameters[0] / diameters[1]);
}

std::vector<LikeSheet> matching_sheets(std::span<const DetectedCircle> circles,
                                       std::span<const DetectedPatch> patches) {
  const std::vector<Pair> pairs = nearest_pairs(circles, patches);
  std::vector<LikeSheet> best;
  for (const Pair& first : pairs) {
    std::vector<LikeSheet> set;
    for (const Pair& other : pairs) {
      if (alike_pairs(other, first)) set.push_back(other.sheet);
    }
    if (set.size() > best.size()) best = std::move(set);
  }
  return best.size() < 2 ? std::vector<LikeSheet>{} : best;
}

}  // namespace moiregauge::internal
