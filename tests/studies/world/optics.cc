// SPDX-License-Identifier: Apache-2.0
#include "studies/world/optics.h"

#include <cmath>
#include <stdexcept>

namespace world {

Lens::Lens(const DrawFile& draw) {
  const std::string& kind = draw.words("lens.kind").at(0);
  if (kind == "fisheye") radial_ = Radial::kFisheye;
  if (kind == "division") radial_ = Radial::kDivision;
  if (kind != "brown" && radial_ == Radial::kBrown) throw std::runtime_error("unknown lens: " + kind);
  const auto k = draw.numbers("lens.radial", 3), p = draw.numbers("lens.decentring", 2);
  const auto s = draw.numbers("lens.wedge", 2);
  k1_ = k[0], k2_ = k[1], k3_ = k[2], p1_ = p[0], p2_ = p[1], s1_ = s[0], s2_ = s[1];
}

double Lens::radial_factor(double r2) const {
  if (radial_ == Radial::kBrown) return 1.0 + r2 * (k1_ + r2 * (k2_ + r2 * k3_));
  if (r2 < 1e-16) return 1.0;
  const double r = std::sqrt(r2);
  if (radial_ == Radial::kFisheye) {
    const double theta = std::atan(r), t2 = theta * theta;
    return theta * (1.0 + t2 * (k1_ + t2 * (k2_ + t2 * k3_))) / r;
  }
  if (k1_ == 0.0) return 1.0;
  return (1.0 - std::sqrt(1.0 - 4.0 * k1_ * r2)) / (2.0 * k1_ * r2);  // solves r = d / (1 + k1 d^2) for d / r
}

Ray Lens::distorted(const Ray& ray) const {
  const auto [x, y] = ray;
  const double r2 = x * x + y * y, factor = radial_factor(r2);
  return {x * factor + p2_ * (r2 + 2.0 * x * x) + 2.0 * p1_ * x * y + s1_ * r2,
          y * factor + p1_ * (r2 + 2.0 * y * y) + 2.0 * p2_ * x * y + s2_ * r2};
}

Ray Lens::undistorted(const Ray& distorted_ray) const {
  Ray at = distorted_ray;
  for (int step = 0; step < 30; ++step) {
    constexpr double kDelta = 1e-6;
    const Ray here = distorted(at), right = distorted({at.x + kDelta, at.y}), down = distorted({at.x, at.y + kDelta});
    const double ex = distorted_ray.x - here.x, ey = distorted_ray.y - here.y;
    if (std::abs(ex) + std::abs(ey) < 1e-12) break;
    const double a = (right.x - here.x) / kDelta, b = (down.x - here.x) / kDelta;
    const double c = (right.y - here.y) / kDelta, d = (down.y - here.y) / kDelta;
    const double scale = 1.0 / (a * d - b * c);
    at.x += scale * (d * ex - b * ey);
    at.y += scale * (a * ey - c * ex);
  }
  return at;
}

Camera::Camera(const DrawFile& draw)
    : lens_(draw),
      x_mm_(draw.track("camera.x_mm")),
      y_mm_(draw.track("camera.y_mm")),
      z_mm_(draw.track("camera.z_mm")),
      turn_x_rad_(draw.track("camera.turn_x_rad")),
      turn_y_rad_(draw.track("camera.turn_y_rad")),
      turn_z_rad_(draw.track("camera.turn_z_rad")) {
  const auto size = draw.numbers("image", 2), centre = draw.numbers("camera.centre_px", 2);
  width_ = static_cast<int>(size[0]), height_ = static_cast<int>(size[1]);
  focal_px_ = draw.number("camera.focal_px");
  centre_x_px_ = centre[0], centre_y_px_ = centre[1];
  for (int row = -kBorder; row <= height_ + kBorder; ++row) {
    for (int column = -kBorder; column <= width_ + kBorder; ++column) {
      corners_.push_back(
          lens_.undistorted({(column - 0.5 - centre_x_px_) / focal_px_, (row - 0.5 - centre_y_px_) / focal_px_}));
    }
  }
}

Camera::Pose Camera::pose(double time_s) const {
  const Mat3 turned = rotation({turn_x_rad_.at(time_s), turn_y_rad_.at(time_s), turn_z_rad_.at(time_s)});
  const Mat3 facing = {{Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, -1}}};
  return {turned * facing, {x_mm_.at(time_s), y_mm_.at(time_s), z_mm_.at(time_s)}};
}

Ray Camera::pixel_of(const Vec3& in_camera) const {
  const Ray d = lens_.distorted({in_camera.x / in_camera.z, in_camera.y / in_camera.z});
  return {centre_x_px_ + focal_px_ * d.x, centre_y_px_ + focal_px_ * d.y};
}

const Ray& Camera::corner(int column, int row) const {
  const int stride = width_ + 2 * kBorder + 1;
  return corners_[static_cast<std::size_t>(row + kBorder) * static_cast<std::size_t>(stride) +
                  static_cast<std::size_t>(column + kBorder)];
}

}  // namespace world
