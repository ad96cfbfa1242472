// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/select_references.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "moiregauge/detection/identity/grating_elements.h"
#include "moiregauge/detection/identity/matching_sheets.h"

namespace moiregauge::internal {
namespace {

constexpr double kOneSize = 0.25;       // in ln(diameter): effect of perspective
constexpr double kConcentric = 0.3;     // relative to the diameter, largest distance of concentric circles
constexpr double kNearHull = 0.5;       // diameters
constexpr double kFarOutOfRound = 0.2;  // in ln(major / minor); perspective causes 0.13, see is_round_on_some_plane
constexpr std::size_t kEnough = 4;      // references

double cross(ImagePoint o, ImagePoint a, ImagePoint b) { return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x); }

// Returns the convex hull without repeated points (Andrew's monotone chain, 1979).
std::vector<ImagePoint> hull_of(std::vector<ImagePoint> p) {
  std::sort(p.begin(), p.end(), [](ImagePoint a, ImagePoint b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<ImagePoint> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t base = hull.size();
    for (const ImagePoint& q : p) {
      while (hull.size() >= base + 2 && cross(hull[hull.size() - 2], hull.back(), q) <= 0) hull.pop_back();
      hull.push_back(q);
    }
    hull.pop_back();
    std::reverse(p.begin(), p.end());
  }
  return hull;
}

// Returns true for a circle that is round on the plane of one of the gratings, or if there are no gratings. Perspective
// changes the shape far from a grating: ln(major / minor) is 0.13 at 40 degrees of tilt, 8 degrees away in the image.
bool is_round_on_some_plane(const DetectedCircle& c, std::span<const DetectedPatch> patches) {
  return patches.empty() || std::any_of(patches.begin(), patches.end(), [&](const DetectedPatch& p) {
           return out_of_round(c, p) < std::hypot(kFarOutOfRound, kRoundPx / c.diameter_px);
         });
}

std::vector<DetectedCircle> outer_candidates(std::span<const DetectedCircle> circles,
                                             std::span<const DetectedPatch> patches) {
  std::vector<DetectedCircle> out = without_elements(circles, patches);
  std::erase_if(out, [&](const DetectedCircle& c) { return !is_round_on_some_plane(c, patches); });
  return out;
}

// Returns the circles of c's size, one per position: that of the highest contrast.
std::vector<DetectedCircle> like(const DetectedCircle& c, const std::vector<DetectedCircle>& all) {
  std::vector<DetectedCircle> out;
  for (const DetectedCircle& o : all) {
    if (std::abs(std::log(o.diameter_px / c.diameter_px)) > kOneSize) continue;
    const auto same = std::find_if(out.begin(), out.end(), [&](const DetectedCircle& k) {
      return length(o.centre - k.centre) < kConcentric * k.diameter_px;
    });
    if (same == out.end())
      out.push_back(o);
    else if (std::abs(o.contrast) > std::abs(same->contrast))
      *same = o;
  }
  return out;
}

// Returns the circles on or near the hull of all.
std::vector<DetectedCircle> round_all(const std::vector<DetectedCircle>& circles) {
  std::vector<ImagePoint> places;
  double diameter = 0.0;
  for (const DetectedCircle& c : circles) {
    places.push_back(c.centre);
    diameter = std::max(diameter, c.diameter_px);
  }
  std::vector<DetectedCircle> out;
  for (const std::size_t i : on_hull(places, kNearHull * diameter)) out.push_back(circles[i]);
  return out;
}

// Returns true if some outermost circle is next to a grating, unless the outermost are the sheets and one more. Three
// sheets inside four bare circles are three targets.
bool are_mixed(const std::vector<DetectedCircle>& select_references, const std::vector<DetectedCircle>& sheets,
               std::span<const DetectedPatch> patches) {
  const auto is_outermost = [&](const DetectedCircle& s) {
    return std::any_of(select_references.begin(), select_references.end(),
                       [&](const auto& c) { return length(c.centre - s.centre) == 0.0; });
  };
  if (select_references.size() == kEnough && std::all_of(sheets.begin(), sheets.end(), is_outermost)) return false;
  return std::any_of(select_references.begin(), select_references.end(), [&](const DetectedCircle& c) {
    return std::any_of(patches.begin(), patches.end(), [&](const DetectedPatch& p) {
      return distance_px(p, c.centre) < kGratingReach * c.diameter_px;
    });
  });
}

}  // namespace

std::vector<std::size_t> on_hull(std::span<const ImagePoint> points, double slack) {
  std::vector<std::size_t> out(points.size());
  std::iota(out.begin(), out.end(), 0U);
  if (points.size() < 4) return out;
  const std::vector<ImagePoint> hull = hull_of({points.begin(), points.end()});
  std::erase_if(out, [&](std::size_t i) {
    double nearest = 1e300;
    for (std::size_t k = 0; k < hull.size(); ++k) {
      const ImagePoint a = hull[k], b = hull[(k + 1) % hull.size()];
      nearest = std::min(nearest, std::abs(cross(a, b, points[i])) / std::max(length(b - a), 1e-12));
    }
    return nearest > slack;
  });
  return out;
}

OutermostCircles outermost_circles(std::span<const DetectedCircle> circles, std::span<const DetectedPatch> patches) {
  const std::vector<DetectedCircle> all = outer_candidates(circles, patches);
  std::vector<DetectedCircle> most, sheets;
  for (const DetectedCircle& c : all) {
    std::vector<DetectedCircle> group = like(c, all);
    const std::vector<LikeSheet> alike = matching_sheets(group, patches);
    if (alike.size() > sheets.size()) {
      sheets.clear();
      for (const LikeSheet& sheet : alike) sheets.push_back(group[sheet.circle]);
    }
    if (group.size() > most.size() || (group.size() == most.size() && c.diameter_px > most.front().diameter_px))
      most = std::move(group);
  }
  if (sheets.size() >= kEnough) return {round_all(sheets), false};
  OutermostCircles out{round_all(most), false};
  out.doubtful = sheets.size() + 1 == kEnough && are_mixed(out.circles, sheets, patches);
  return out;
}

}  // namespace moiregauge::internal
