// SPDX-License-Identifier: Apache-2.0
// Where a marker's plane falls on the sensor at one instant, and back. Shares nothing with the instrument's geometry.
#pragma once

#include <array>

#include "moiregauge/simulator/scenario/scenario.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal::simulator {

using Matrix3 = std::array<std::array<double, 3>, 3>;
using Vector3 = std::array<double, 3>;

[[nodiscard]] Matrix3 product(const Matrix3& a, const Matrix3& b);
[[nodiscard]] Vector3 product(const Matrix3& a, const Vector3& v);
[[nodiscard]] Matrix3 inverse(const Matrix3& m);
// Rx Ry Rz, degrees.
[[nodiscard]] Matrix3 rotation_xyz(double x_deg, double y_deg, double z_deg);

// A direction of sight: (X/Z, Y/Z).
struct Ray {
  double x = 0.0;
  double y = 0.0;
};
// A ray and how it changes from pixel to pixel.
struct RayPatch {
  Ray ray;
  double dx_du = 0.0, dx_dv = 0.0, dy_du = 0.0, dy_dv = 0.0;
};

[[nodiscard]] ImagePoint image_of(const Camera& camera, Ray ray);
// The inverse of image_of by Newton from `start`; from a neighbour's ray two steps reach 1e-13.
[[nodiscard]] RayPatch ray_through(const Camera& camera, ImagePoint pixel, Ray start);

// From (x, y, 1) of a marker's print, as site.toml has it, to the camera's millimetres.
[[nodiscard]] Matrix3 camera_from_print(const Scenario& scenario, const SceneMarker& marker, double time_s);

[[nodiscard]] Ray ray_of(const Matrix3& camera_from_print, BoardPoint point);

// The middle of a marker's print, about which its `place` turns and stretches it.
[[nodiscard]] BoardPoint centre_of(const Marker& marker);

}  // namespace moiregauge::internal::simulator
