// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/traced_outline.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>

#include "moiregauge/detection/circles/radial_profile.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr int kMaxRays = 96;
constexpr int kMinRays = 24;
constexpr double kRaysPerPixel = 1.5;  // rays per px of diameter: points 2 px apart, so that noise adds little length
constexpr double kRayStep = 0.5;       // px along a ray
constexpr double kMinReach = 2.5;      // px to either side of the edge: more than the blur of a sharp lens
constexpr double kMaxReach = 6.0;      // px: keeps neighbouring markers out
constexpr double kReachShare = 0.22;   // relative to the diameter
constexpr double kMaxMissing = 0.08;   // share of rays without an edge: tolerates dirt, but no touching object (chosen)
constexpr int kMaxRounds = 7;
constexpr double kSettled = 0.003;      // px, movement of the outline between two rounds at convergence
constexpr double kMaxGrowth = 1.6;      // ratio to the candidate's diameter, either way (chosen)
constexpr int kMaxSamples = 4 * 6 + 1;  // 2 kMaxReach / kRayStep + 1
// Samples: one vector more than needed, because a crossing compares each sample with the next one.
constexpr int kProfile = (kMaxSamples / kRayLanes + 2) * kRayLanes;

struct Ray {
  Eigen::Vector2d unit;                    // on the unit circle
  double length = 0.0;                     // px from the centre to the ellipse
  double inside = 0.0;                     // grey level at the inner end
  double outside = 0.0;                    // grey level at the outer end
  std::array<double, kProfile> profile{};  // grey levels along the ray
  std::optional<double> edge;              // px beyond the ellipse
  double slope = 0.0;                      // grey levels per px at the edge
};

struct Round {
  std::vector<Ray> rays;
  int samples = 0;     // per ray
  double reach = 0.0;  // px to either side of the ellipse
};

// Median of one value per ray, in an array of fixed size.
class Numbers {
 public:
  void add(double value) { values_[count_++] = value; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] double median() const { return markers_detail::median(values_, static_cast<int>(count_)); }

 private:
  static_assert(kMaxRays % kRayLanes == 0);
  std::size_t count_ = 0;
  double values_[kMaxRays] = {};
};

void aim_rays(std::size_t count, std::vector<Ray>& rays) {
  if (rays.size() == count) return;  // directions depend on the count only
  rays.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = kTwoPi * static_cast<double>(i) / static_cast<double>(count);
    rays[i].unit = {std::cos(angle), std::sin(angle)};
  }
}

template <typename Grey>
bool sample(const ImageView<Grey>& view, const Ellipse& ellipse, Round& round) {
  const double diameter = ellipse.diameter();
  const auto count = std::clamp(static_cast<int>(std::lround(kRaysPerPixel * diameter)), kMinRays, kMaxRays);
  const double reach = std::clamp(kReachShare * diameter, kMinReach, kMaxReach);
  round.samples = static_cast<int>(2.0 * reach / kRayStep) + 1;
  round.reach = 0.5 * kRayStep * (round.samples - 1);
  aim_rays(static_cast<std::size_t>(count), round.rays);
  const auto inside = [right = view.width - 1, bottom = view.height - 1](const RaySteps& s, int j) {
    const double along = s.first + s.step * j, x = s.x + along * s.dx, y = s.y + along * s.dy;
    return x >= 0.0 && y >= 0.0 && x <= right && y <= bottom;
  };
  for (Ray& ray : round.rays) {
    const Eigen::Vector2d spoke = ellipse.axes * ray.unit;
    ray.length = spoke.norm();
    const Eigen::Vector2d direction = spoke / ray.length;
    const RaySteps steps{ellipse.centre.x(),       ellipse.centre.y(), direction.x(), direction.y(),
                         ray.length - round.reach, kRayStep,           round.samples};
    if (!inside(steps, 0) || !inside(steps, round.samples - 1)) return false;  // both ends inside: all are inside
    sample_ray(view, steps, ray.profile.data());
    ray.inside = 0.5 * (ray.profile[0] + ray.profile[1]);
    const auto last = static_cast<std::size_t>(round.samples - 1);
    ray.outside = 0.5 * (ray.profile[last] + ray.profile[last - 1]);
  }
  return true;
}

// Finds the crossing of `level` nearest to the ellipse, in the direction from inside to outside.
void find_edge(Ray& ray, const Round& round, double step, double level) {
  ray.edge.reset();
  const double sign = step > 0.0 ? 1.0 : -1.0;
  for (std::uint32_t left = rises(ray.profile.data(), round.samples, level, sign); left != 0; left &= left - 1) {
    const int j = std::countr_zero(left);
    const double a = sign * (ray.profile[static_cast<std::size_t>(j)] - level);
    const double b = sign * (ray.profile[static_cast<std::size_t>(j) + 1] - level);
    const double edge = -round.reach + kRayStep * (j + a / (a - b));
    if (ray.edge && std::abs(*ray.edge) <= std::abs(edge)) continue;
    ray.edge = edge;
    ray.slope = (b - a) / kRayStep;
  }
}

// Finds the edge on all rays and returns the number of rays without one. Each ray has its own mid-level, so that
// shading does not shift the outline. The level is limited, so that an object at the end of one ray does not shift it
// either.
int find_edges(Round& round, TracedOutline& out) {
  Numbers inside, outside, slopes;
  for (const Ray& ray : round.rays) {
    inside.add(ray.inside);
    outside.add(ray.outside);
  }
  out.background = outside.median();
  const double dark_or_light = inside.median();
  out.contrast = dark_or_light - out.background;
  const double slack = 0.3 * std::abs(out.contrast);
  const double middle = 0.5 * (dark_or_light + out.background);
  int missing = 0;
  for (Ray& ray : round.rays) {
    const double level = std::clamp(0.5 * (ray.inside + ray.outside), middle - slack, middle + slack);
    find_edge(ray, round, -out.contrast, level);
    if (ray.edge) {
      slopes.add(ray.slope);
    } else {
      ++missing;
    }
  }
  const double slope = slopes.empty() ? 0.0 : slopes.median();
  out.blur_px = slope > 0.0 ? std::abs(out.contrast) / (slope * std::sqrt(kTwoPi)) : 1.0;
  return missing;
}

using Correction = Eigen::Matrix<double, 5, 1>;

Correction row_of(const Ray& ray) {
  const double c = ray.unit.x(), s = ray.unit.y();
  return (Correction() << 1.0, c, s, c * c - s * s, 2.0 * c * s).finished();
}

Correction correction_of(const Round& round) {
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Correction right = Correction::Zero();
  for (const Ray& ray : round.rays) {
    if (!ray.edge) continue;
    const Correction row = row_of(ray);
    normal.noalias() += row * row.transpose();
    right += row * (*ray.edge / ray.length);
  }
  return normal.ldlt().solve(right);
}

// Computes W (paper Eq. 6) of the polygon through the edges. A regular n-gon inscribed in a circle has
// W = (pi / n) / tan(pi / n) < 1. The result is divided by this factor, which is caused by the sampling.
void judge(const Round& round, const Correction& k, TracedOutline& out) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(round.rays.size());
  double squares = 0.0;
  for (const Ray& ray : round.rays) {
    if (!ray.edge) continue;
    points.push_back(out.ellipse.axes * ((1.0 + *ray.edge / ray.length) * ray.unit));
    const double off = *ray.edge - ray.length * row_of(ray).dot(k);
    squares += off * off;
  }
  double area = 0.0, length = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d &p = points[i], &q = points[(i + 1) % points.size()];
    area += 0.5 * (p.x() * q.y() - p.y() * q.x());
    length += (q - p).norm();
  }
  const auto n = static_cast<double>(points.size());
  out.circularity = 4.0 * kPi * area / (length * length) * (n / kPi) * std::tan(kPi / n);
  out.residual_px = std::sqrt(squares / std::max(1.0, n - 5.0));
}

template <typename Grey>
TracedOutline trace(const ImageView<Grey>& view, const Ellipse& start) {
  TracedOutline out;
  out.ellipse = start;
  Round round;
  for (int i = 0; i < kMaxRounds; ++i) {
    if (!sample(view, out.ellipse, round)) {
      out.problem = "cut off by the image edge";
      return out;
    }
    const int missing = find_edges(round, out);
    if (missing > kMaxMissing * static_cast<double>(round.rays.size())) {
      out.problem = "not a closed outline";
      return out;
    }
    const Correction k = correction_of(round);
    judge(round, k, out);
    const double moved = k.norm() * 0.5 * out.ellipse.diameter();
    // Far from the outline the correction is not small, and a full step could invert the ellipse.
    out.ellipse = out.ellipse.corrected(k * std::min(1.0, 0.4 / k.norm()));
    const double growth = out.ellipse.diameter() / start.diameter();
    if (growth > kMaxGrowth || growth < 1.0 / kMaxGrowth ||
        (out.ellipse.centre - start.centre).norm() > 0.5 * start.diameter()) {
      out.problem = "no clear outline";
      out.circularity = 0.0;
      return out;
    }
    if (moved < kSettled) break;
  }
  return out;
}

}  // namespace

TracedOutline trace_outline(const LumaView& luma, const Ellipse& start) {
  return std::visit([&](const auto& view) { return trace(view, start); }, luma);
}

}  // namespace moiregauge::internal::markers_detail
