// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/markers/traced_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "moiregauge/units/units.h"

namespace moiregauge::markers_detail {
namespace {

constexpr int kMaxRays = 96;
constexpr int kMinRays = 24;
constexpr double kRaysPerPixel = 1.5;  // of diameter: outline points 2 px apart, so that noise does not lengthen it
constexpr double kStep = 0.5;          // px along a ray
constexpr double kMinReach = 2.5;      // px to either side of the edge: past the blur of a sharp lens
constexpr double kMaxReach = 6.0;      // px: no further than needed, neighbours may be close
constexpr double kReachShare = 0.22;   // of the diameter
constexpr double kMaxMissing = 0.08;   // share of rays without an edge: dirt is forgiven, a corner's neighbour is not
constexpr int kMaxRounds = 7;
constexpr double kSettled = 0.003;  // px, movement of the outline between two rounds
constexpr double kMaxGrowth = 1.6;  // from the candidate's size, either way
constexpr int kMaxSamples = 4 * 6 + 1;

template <typename Grey>
double bilinear(const ImageView<Grey>& view, double x, double y) {
  const int ix = std::min(static_cast<int>(x), view.width - 2), iy = std::min(static_cast<int>(y), view.height - 2);
  const double fx = x - ix, fy = y - iy;
  const Grey* p = view.data + iy * view.stride + ix;
  const double top = p[0] + fx * (p[1] - p[0]);
  const double low = p[view.stride] + fx * (p[view.stride + 1] - p[view.stride]);
  return top + fy * (low - top);
}

struct Ray {
  Eigen::Vector2d unit;  // on the unit circle
  double length = 0.0;   // px from the centre to the ellipse
  double inside = 0.0;   // grey levels at the two ends
  double outside = 0.0;
  std::array<double, kMaxSamples> profile{};
  std::optional<double> edge;  // px beyond the ellipse
  double slope = 0.0;          // grey levels per px at the edge
};

struct Round {
  std::vector<Ray> rays;
  int samples = 0;
  double reach = 0.0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <typename Grey>
bool sample(const ImageView<Grey>& view, const Ellipse& ellipse, Round& round) {
  const double diameter = ellipse.diameter();
  const auto count = std::clamp(static_cast<int>(std::lround(kRaysPerPixel * diameter)), kMinRays, kMaxRays);
  const double reach = std::clamp(kReachShare * diameter, kMinReach, kMaxReach);
  round.samples = static_cast<int>(2.0 * reach / kStep) + 1;
  round.reach = 0.5 * kStep * (round.samples - 1);
  round.rays.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Ray& ray = round.rays[static_cast<std::size_t>(i)];
    const double angle = kTurn * i / count;
    ray.unit = {std::cos(angle), std::sin(angle)};
    const Eigen::Vector2d spoke = ellipse.axes * ray.unit;
    ray.length = spoke.norm();
    const Eigen::Vector2d direction = spoke / ray.length;
    for (int j = 0; j < round.samples; ++j) {
      const Eigen::Vector2d p = ellipse.centre + (ray.length - round.reach + kStep * j) * direction;
      if (!(p.x() >= 0.0 && p.y() >= 0.0 && p.x() <= view.width - 1 && p.y() <= view.height - 1)) return false;
      ray.profile[static_cast<std::size_t>(j)] = bilinear(view, p.x(), p.y());
    }
    ray.inside = 0.5 * (ray.profile[0] + ray.profile[1]);
    const auto last = static_cast<std::size_t>(round.samples - 1);
    ray.outside = 0.5 * (ray.profile[last] + ray.profile[last - 1]);
  }
  return true;
}

// The crossing of half-way that is nearest to the ellipse, going from inside to outside.
void find_edge(Ray& ray, const Round& round, double step, double level) {
  ray.edge.reset();
  const double sign = step > 0.0 ? 1.0 : -1.0;
  for (int j = 0; j + 1 < round.samples; ++j) {
    const double a = sign * (ray.profile[static_cast<std::size_t>(j)] - level);
    const double b = sign * (ray.profile[static_cast<std::size_t>(j) + 1] - level);
    if (a >= 0.0 || b < 0.0) continue;
    const double edge = -round.reach + kStep * (j + a / (a - b));
    if (ray.edge && std::abs(*ray.edge) <= std::abs(edge)) continue;
    ray.edge = edge;
    ray.slope = (b - a) / kStep;
  }
}

// Half-way is each ray's own, so that shading does not shift the outline, but within reason, so that a neighbour
// touching one ray does not.
int find_edges(Round& round, TracedOutline& out) {
  std::vector<double> inside, outside, slopes;
  for (const Ray& ray : round.rays) {
    inside.push_back(ray.inside);
    outside.push_back(ray.outside);
  }
  out.background = median(outside);
  const double dark_or_light = median(inside);
  out.contrast = dark_or_light - out.background;
  const double slack = 0.3 * std::abs(out.contrast);
  const double middle = 0.5 * (dark_or_light + out.background);
  int missing = 0;
  for (Ray& ray : round.rays) {
    const double level = std::clamp(0.5 * (ray.inside + ray.outside), middle - slack, middle + slack);
    find_edge(ray, round, -out.contrast, level);
    if (ray.edge) {
      slopes.push_back(ray.slope);
    } else {
      ++missing;
    }
  }
  const double slope = slopes.empty() ? 0.0 : median(slopes);
  out.blur_px = slope > 0.0 ? std::abs(out.contrast) / (slope * std::sqrt(kTurn)) : 1.0;
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
    normal += row * row.transpose();
    right += row * (*ray.edge / ray.length);
  }
  return normal.ldlt().solve(right);
}

// Eq. (6) on the polygon through the edges. A regular n-gon inscribed in a circle has W = (pi / n) / tan(pi / n) < 1:
// that factor is the sampling's, not the outline's, and is taken out.
void judge(const Round& round, const Correction& k, TracedOutline& out) {
  std::vector<Eigen::Vector2d> points;
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
      out.problem = "cut off by the picture's edge";
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
    // Far from the outline the correction is not small against 1 and must not turn the ellipse inside out.
    out.ellipse = out.ellipse.corrected(k * std::min(1.0, 0.4 / k.norm()));
    const double growth = out.ellipse.diameter() / start.diameter();
    if (growth > kMaxGrowth || growth < 1.0 / kMaxGrowth ||
        (out.ellipse.centre - start.centre).norm() > 0.5 * start.diameter()) {
      out.problem = "no outline where the threshold saw one";
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

}  // namespace moiregauge::markers_detail
