// SPDX-License-Identifier: Apache-2.0
// Projection of a marker's plane onto the sensor at one instant, and its inverse. Shares no code with the instrument.
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
// Returns Rx Ry Rz; angles in degrees.
[[nodiscard]] Matrix3 rotation_xyz(double x_deg, double y_deg, double z_deg);

// Direction of view: (X/Z, Y/Z).
struct Ray {
  double x = 0.0;
  double y = 0.0;
};
// Ray of a pixel and its derivatives, per px.
struct RayPatch {
  Ray ray;
  double dx_du = 0.0, dx_dv = 0.0, dy_du = 0.0, dy_dv = 0.0;
};

// Projects a ray through the lens to a pixel.
[[nodiscard]] ImagePoint image_of(const Camera& camera, Ray ray);
// Returns the ray of a pixel, by Newton's method from `start`. Two steps from the ray of a neighbour reach 1e-13.
[[nodiscard]] RayPatch ray_through(const Camera& camera, ImagePoint pixel, Ray start);

// Returns the map from (x, y, 1) of a point on a marker's sheet (board mm as stated in site.toml) to camera mm.
[[nodiscard]] Matrix3 camera_from_print(const Scenario& scenario, const SceneMarker& marker, double time_s);

// Returns the ray to a point on a marker's sheet.
[[nodiscard]] Ray ray_of(const Matrix3& camera_from_print, BoardPoint point);

// Returns the centre of a marker, about which its `place` rotates and stretches it.
[[nodiscard]] BoardPoint centre_of(const Marker& marker);

}  // namespace moiregauge::internal::simulator
