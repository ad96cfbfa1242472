// SPDX-License-Identifier: Apache-2.0
// The camera: lens, pose over time, and the rays of its pixels.
#pragma once

#include <vector>

#include "studies/world/draw.h"
#include "studies/world/space.h"

namespace world {

// A direction as x / z and y / z in the axes of the camera (x right, y down, z forward).
struct Ray {
  double x = 0.0, y = 0.0;
};

// A radial model (Brown 1971, Kannala and Brandt 2006, or Fitzgibbon's division model of 2001), then decentring and
// a thin wedge.
class Lens {
 public:
  explicit Lens(const DrawFile& draw);
  [[nodiscard]] Ray distorted(const Ray& ray) const;
  // Inverts `distorted` by Newton's method with a numerical Jacobian, to 1e-12.
  [[nodiscard]] Ray undistorted(const Ray& distorted_ray) const;

 private:
  enum class Radial { kBrown, kFisheye, kDivision };
  [[nodiscard]] double radial_factor(double r2) const;
  Radial radial_ = Radial::kBrown;
  double k1_, k2_, k3_, p1_, p2_, s1_, s2_;
};

class Camera {
 public:
  explicit Camera(const DrawFile& draw);

  // The map from a board point (mm; x right, y up, z towards the camera) to camera axes: rotation and origin.
  struct Pose {
    Mat3 camera_from_board;
    Vec3 position_mm;
  };
  [[nodiscard]] Pose pose(double time_s) const;
  [[nodiscard]] Ray pixel_of(const Vec3& in_camera) const;  // x and y in px; pixel centres are whole numbers
  // Returns the ray of a pixel's corner: column -0.5 is the left edge of the image. Valid for kBorder px beyond it.
  [[nodiscard]] const Ray& corner(int column, int row) const;
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  static constexpr int kBorder = 16;  // px

 private:
  Lens lens_;
  int width_, height_;
  double focal_px_, centre_x_px_, centre_y_px_;
  Track x_mm_, y_mm_, z_mm_, turn_x_rad_, turn_y_rad_, turn_z_rad_;
  std::vector<Ray> corners_;
};

}  // namespace world
