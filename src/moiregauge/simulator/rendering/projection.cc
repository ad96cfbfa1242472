// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/projection.h"

#include <cmath>
#include <cstddef>

#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {

Matrix3 product(const Matrix3& a, const Matrix3& b) {
  Matrix3 c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return c;
}

Vector3 product(const Matrix3& a, const Vector3& v) {
  Vector3 w{};
  for (std::size_t i = 0; i < 3; ++i) w[i] = a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2];
  return w;
}

Matrix3 inverse(const Matrix3& m) {
  Matrix3 cofactors{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      cofactors[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    }
  }
  const double determinant = m[0][0] * cofactors[0][0] + m[0][1] * cofactors[1][0] + m[0][2] * cofactors[2][0];
  for (auto& row : cofactors) {
    for (double& entry : row) entry /= determinant;
  }
  return cofactors;
}

Matrix3 rotation_xyz(double x_deg, double y_deg, double z_deg) {
  const double a = radians_from_degrees(x_deg), b = radians_from_degrees(y_deg), c = radians_from_degrees(z_deg);
  const Matrix3 rx{{{1, 0, 0}, {0, std::cos(a), -std::sin(a)}, {0, std::sin(a), std::cos(a)}}};
  const Matrix3 ry{{{std::cos(b), 0, std::sin(b)}, {0, 1, 0}, {-std::sin(b), 0, std::cos(b)}}};
  const Matrix3 rz{{{std::cos(c), -std::sin(c), 0}, {std::sin(c), std::cos(c), 0}, {0, 0, 1}}};
  return product(rx, product(ry, rz));
}

namespace {

struct Distorted {
  double x, y;            // distorted ray
  double xx, xy, yx, yy;  // d(x, y) / d(ray)
};

// Distorts a ray (docs.opencv.org, calib3d): radial 1 + k1 r^2 + k2 r^4 + k3 r^6, tangential p1, p2.
Distorted distort(const Camera& c, Ray ray) {
  const double x = ray.x, y = ray.y, r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  const double slope = 2.0 * (c.k1 + r2 * (2.0 * c.k2 + r2 * 3.0 * c.k3));  // d radial / d r2, times 2
  Distorted d;
  d.x = x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x);
  d.y = y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y;
  d.xx = radial + x * x * slope + 2.0 * c.p1 * y + 6.0 * c.p2 * x;
  d.xy = x * y * slope + 2.0 * c.p1 * x + 2.0 * c.p2 * y;
  d.yx = d.xy;
  d.yy = radial + y * y * slope + 6.0 * c.p1 * y + 2.0 * c.p2 * x;
  return d;
}

}  // namespace

ImagePoint image_of(const Camera& camera, Ray ray) {
  const Distorted d = distort(camera, ray);
  return {camera.fx * d.x + camera.cx, camera.fy * d.y + camera.cy};
}

RayPatch ray_through(const Camera& camera, ImagePoint pixel, Ray start) {
  const double x = (pixel.x - camera.cx) / camera.fx, y = (pixel.y - camera.cy) / camera.fy;
  RayPatch patch{start, 0, 0, 0, 0};
  for (int step = 0; step < 20; ++step) {
    const Distorted d = distort(camera, patch.ray);
    const double ex = x - d.x, ey = y - d.y, determinant = d.xx * d.yy - d.xy * d.yx;
    patch.ray.x += (d.yy * ex - d.xy * ey) / determinant;
    patch.ray.y += (d.xx * ey - d.yx * ex) / determinant;
    patch.dx_du = d.yy / (determinant * camera.fx);
    patch.dx_dv = -d.xy / (determinant * camera.fy);
    patch.dy_du = -d.yx / (determinant * camera.fx);
    patch.dy_dv = d.xx / (determinant * camera.fy);
    // Newton's method squares the error: 1e-8 before this step is 1e-16 after it. A pixel is 3e-4.
    if (ex * ex + ey * ey < 1e-16) break;
  }
  return patch;
}

BoardPoint centre_of(const Marker& marker) {
  if (marker.grating) return marker.grating->centre;
  return marker.circle ? marker.circle->centre : BoardPoint{};
}

namespace {

// Returns the marker jitter in mm: the apparent movement of a marker beyond its displacement.
BoardPoint wander_of(const Scenario& scenario, const SceneMarker& marker, double time_s) {
  BoardPoint wander{marker.wander_x.at(time_s), marker.wander_y.at(time_s)};
  if (scenario.haze.rms_mm == 0.0 || marker.print.name.empty()) return wander;
  const double widest = std::sqrt(3.0) * scenario.haze.rms_mm;  // half range of a uniform distribution of this rms
  Track haze{.random = widest, .random_step_s = scenario.haze.step_s, .random_seed = own_seed(scenario, marker)};
  wander.x += haze.at(time_s);
  ++haze.random_seed;
  wander.y += haze.at(time_s);
  return wander;
}

// Applies zoom and lens shift to a map into camera mm.
Matrix3 through(const Scenario& scenario, double time_s, Matrix3 seen) {
  const Optics& optics = scenario.optics;
  const double scale = 1.0 + optics.zoom.at(time_s);
  const double x = optics.shift_x.at(time_s) / scenario.camera.fx, y = optics.shift_y.at(time_s) / scenario.camera.fy;
  for (std::size_t j = 0; j < 3; ++j) {
    seen[0][j] = scale * seen[0][j] + x * seen[2][j];
    seen[1][j] = scale * seen[1][j] + y * seen[2][j];
  }
  return seen;
}

}  // namespace

Matrix3 camera_from_print(const Scenario& scenario, const SceneMarker& marker, double time_s) {
  const Mount& m = scenario.mount;
  const SceneMarker::Place place = true_place(scenario, marker);
  const BoardPoint centre = centre_of(marker.print);
  const double turn = radians_from_degrees(place.rotation_deg), scale = 1.0 + place.print_scale;
  const double c = scale * std::cos(turn), s = scale * std::sin(turn);
  const double cx = c * (1.0 + place.stretch_x), sx = s * (1.0 + place.stretch_x);
  const BoardPoint wander = wander_of(scenario, marker, time_s);
  const double x0 = centre.x - cx * centre.x + s * centre.y + place.x_mm + marker.dx.at(time_s) + wander.x;
  const double y0 = centre.y - sx * centre.x - c * centre.y + place.y_mm + marker.dy.at(time_s) + wander.y;
  const double z0 = marker.print.z_mm.value_or(0.0) + place.z_mm + marker.dz.at(time_s);
  // The board's y points up and its z to the camera. The camera's axes have the opposite signs.
  const Matrix3 turned_over{{{cx, -s, x0}, {-sx, -c, -y0}, {0, 0, -z0}}};
  Matrix3 at_rest = product(rotation_xyz(m.board_x_deg, m.board_y_deg, m.board_z_deg), turned_over);
  const Vector3 pivot{m.pivot_x_mm, m.pivot_y_mm, m.pivot_z_mm};
  at_rest[2][2] += m.distance_mm;
  for (std::size_t i = 0; i < 3; ++i) at_rest[i][2] -= pivot[i];
  const Matrix3 turned = rotation_xyz(m.rotation_x.at(time_s), m.rotation_y.at(time_s), m.rotation_z.at(time_s));
  Matrix3 seen = product(turned, at_rest);
  const Vector3 shift{m.shift_x.at(time_s), m.shift_y.at(time_s), m.shift_z.at(time_s)};
  for (std::size_t i = 0; i < 3; ++i) seen[i][2] += pivot[i] + shift[i];
  return through(scenario, time_s, seen);
}

Ray ray_of(const Matrix3& camera_from_print, BoardPoint point) {
  const Vector3 seen = product(camera_from_print, Vector3{point.x, point.y, 1.0});
  return {seen[0] / seen[2], seen[1] / seen[2]};
}

}  // namespace moiregauge::internal::simulator
