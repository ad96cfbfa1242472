// SPDX-License-Identifier: Apache-2.0
#include "paper/exact_points.h"

#include <Eigen/Dense>

namespace moiregauge::internal::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

// Returns the map through four points (h33 = 1): eight linear equations.
Matrix3d four_point_map(const std::vector<Vector2d>& from, const std::vector<Vector2d>& to) {
  Eigen::Matrix<double, 8, 8> a;
  Eigen::Matrix<double, 8, 1> b;
  for (int i = 0; i < 4; ++i) {
    const auto& p = from[size_t(i)];
    const auto& q = to[size_t(i)];
    a.row(2 * i) << p.x(), p.y(), 1, 0, 0, 0, -q.x() * p.x(), -q.x() * p.y();
    a.row(2 * i + 1) << 0, 0, 0, p.x(), p.y(), 1, -q.y() * p.x(), -q.y() * p.y();
    b(2 * i) = q.x();
    b(2 * i + 1) = q.y();
  }
  const Eigen::Matrix<double, 8, 1> h = a.fullPivLu().solve(b);
  return (Matrix3d() << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1.0).finished();
}

Vector2d mapped(const Matrix3d& h, Vector2d p) { return (h * p.homogeneous()).hnormalized(); }
Vector2d vec(BoardPoint p) { return {p.x, p.y}; }

// Returns the point of the marker's grating at the raster's fixed board point, in mm on the grating. That is what a
// phase measures. `board_from_image` is the stabilisation. A fixed-point iteration converges, because the map is near
// the identity.
Vector2d print_point_at(const simulator::Scenario& scenario, long frame, const Marker& marker,
                        const Matrix3d& board_from_image) {
  const Vector2d fixed = vec(marker.grating->centre);
  Vector2d print = fixed;
  for (int pass = 0; pass < 20; ++pass) {
    const ImagePoint p =
        project(scenario, frame, *simulator::find_marker(scenario, marker.name), BoardPoint{print.x(), print.y()});
    print += fixed - mapped(board_from_image, {p.x, p.y});
  }
  return print;
}

std::vector<Vector2d> circle_images(const simulator::Scenario& scenario, long frame, const Site& site) {
  std::vector<Vector2d> image;
  for (const Marker& m : site.markers) {
    if (m.role != Role::kReference) continue;
    const ImagePoint p = project(scenario, frame, *simulator::find_marker(scenario, m.name), m.circle->centre);
    image.emplace_back(p.x, p.y);
  }
  return image;
}

}  // namespace

Extent<frame::Board> exact_error(const simulator::Scenario& scenario, long frame, long reference_frame, Stages stages) {
  const Site site = simulator::site_of(scenario);
  std::vector<Vector2d> circles;
  for (const Marker& m : site.markers) {
    if (m.role == Role::kReference) circles.push_back(vec(m.circle->centre));
  }
  const Matrix3d then = four_point_map(circle_images(scenario, reference_frame, site), circles);
  Matrix3d now = four_point_map(circle_images(scenario, frame, site), circles);
  if (stages == Stages::kBoth) {
    std::vector<Vector2d> refined;
    for (const Marker& m : site.markers) {
      if (m.role != Role::kReference) continue;
      const Vector2d moved =
          print_point_at(scenario, reference_frame, m, then) - print_point_at(scenario, frame, m, now);
      refined.push_back(vec(m.circle->centre) + moved);
    }
    now = four_point_map(refined, circles) * now;
  }
  for (const Marker& m : site.markers) {
    if (m.role != Role::kTarget) continue;
    const Vector2d moved = print_point_at(scenario, reference_frame, m, then) - print_point_at(scenario, frame, m, now);
    const auto& marker = *simulator::find_marker(scenario, m.name);
    const auto a = truth(scenario, frame, marker), b = truth(scenario, reference_frame, marker);
    return {moved.x() - (a.dx_mm - b.dx_mm), moved.y() - (a.dy_mm - b.dy_mm)};
  }
  return {};
}

}  // namespace moiregauge::internal::test
