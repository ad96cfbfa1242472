// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/geometry/camera.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

struct Bent {
  double x, y;                // distorted, in units of the focal length
  double dxx, dxy, dyx, dyy;  // derivatives by the ideal coordinates
};

Bent bend(const Camera& c, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double slope = 2.0 * (c.k1 + r2 * (2.0 * c.k2 + r2 * 3.0 * c.k3));  // d radial / d(r^2), times 2
  return {x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x),
          y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y,
          radial + x * x * slope + 2.0 * c.p1 * y + 6.0 * c.p2 * x,
          x * y * slope + 2.0 * c.p1 * x + 2.0 * c.p2 * y,
          x * y * slope + 2.0 * c.p1 * x + 2.0 * c.p2 * y,
          radial + y * y * slope + 6.0 * c.p1 * y + 2.0 * c.p2 * x};
}

}  // namespace

ImagePoint Camera::distort(IdealPoint ideal) const {
  const Bent b = bend(*this, (ideal.x - cx) / fx, (ideal.y - cy) / fy);
  return {fx * b.x + cx, fy * b.y + cy};
}

std::optional<double> Camera::fold_px() const {
  const double corner = std::hypot(std::max(cx, width - 1.0 - cx) / fx, std::max(cy, height - 1.0 - cy) / fy);
  constexpr double kStep = 1e-3;         // relative to the corner's radius, much finer than a lens bends; chosen
  constexpr double kMaxStretch = 100.0;  // ideal radius divided by seen radius; no image needs more; chosen
  double seen = 0.0;
  for (double r = 0.0; seen < corner && r < kMaxStretch * corner; r += kStep * corner) {
    const double s = r * r;
    if (!(1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3)) > 0.0)) return seen * fx;
    seen = r * (1.0 + s * (k1 + s * (k2 + s * k3)));
  }
  return std::nullopt;
}

IdealPoint Camera::undistort(ImagePoint seen) const {
  const double xd = (seen.x - cx) / fx;
  const double yd = (seen.y - cy) / fy;
  double x = xd;
  double y = yd;
  if (is_distortion_free()) return {seen.x, seen.y};
  constexpr int kPasses = 12;  // quadratic convergence; ends early at rounding
  for (int pass = 0; pass < kPasses; ++pass) {
    const Bent b = bend(*this, x, y);
    const double ex = xd - b.x;
    const double ey = yd - b.y;
    const double det = b.dxx * b.dyy - b.dxy * b.dyx;
    if (std::abs(det) < 1e-9) break;  // no inverse beyond the model's monotone range
    const double sx = (b.dyy * ex - b.dxy * ey) / det;
    const double sy = (b.dxx * ey - b.dyx * ex) / det;
    x += sx;
    y += sy;
    if (std::abs(sx) + std::abs(sy) < 1e-16) break;
  }
  return {fx * x + cx, fy * y + cy};
}

}  // namespace moiregauge::internal
