// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/solved_scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include "moiregauge/geometry/symmetric_eigen.h"

namespace moiregauge::internal {
namespace {

BoardPoint turned_about(BoardPoint middle, BoardPoint p, double angle_rad, double scale) {
  const auto d = p - middle;
  const double c = scale * std::cos(angle_rad), s = scale * std::sin(angle_rad);
  return middle + Extent<frame::Board>{c * d.x - s * d.y, s * d.x + c * d.y};
}

// Returns the root of the largest eigenvalue of the covariance of these parameters. Returns `given` if none was solved.
double width_over(const Scene& scene, const std::vector<int>& rows, double given) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  if (n == 0) return given;
  const Eigen::MatrixXd& covariance = scene.stated_covariance();
  Eigen::MatrixXd block(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b)
      block(a, b) = covariance(rows[static_cast<std::size_t>(a)], rows[static_cast<std::size_t>(b)]);
  }
  const SymmetricEigenX eigen = eigen_of(block);
  return std::sqrt(std::max(0.0, eigen.values(n - 1)));
}

bool is_solved(const Scene& scene, std::size_t marker, int parameter) {
  return scene.covariance(shape_row(marker, parameter), shape_row(marker, parameter)) > 0.0;
}

// Returns true if the height was solved at least as well as the site states heights. A target with a more uncertain
// depth keeps the stated one.
bool has_new_height(const Site& site, const Scene& scene, std::size_t marker) {
  const double u = u_of_marker(scene, marker).value[MarkerShape::kHeight];
  return u > 0.0 && u <= site.known_to.height_mm;
}

}  // namespace

std::array<double, kCameraParameters> u_of_camera(const Scene& scene) {
  std::array<double, kCameraParameters> u;
  for (int k = 0; k < kCameraParameters; ++k)
    u[static_cast<std::size_t>(k)] = std::sqrt(scene.stated_covariance()(k, k));
  return u;
}

MarkerShape u_of_marker(const Scene& scene, std::size_t marker) {
  MarkerShape u;
  for (int k = 0; k < MarkerShape::kParameters; ++k) {
    const int row = shape_row(marker, k);
    if (is_solved(scene, marker, k))
      u.value[static_cast<std::size_t>(k)] = std::sqrt(scene.stated_covariance()(row, row));
  }
  return u;
}

Marker solved_marker(const Site& site, const Scene& scene, std::size_t marker) {
  Marker solved = site.markers[marker];
  const auto& shape = scene.markers[marker].value;
  const Extent<frame::Board> moved{shape[MarkerShape::kX], shape[MarkerShape::kY]};
  if (solved.grating) {
    Grating& print = *solved.grating;
    if (solved.circle)
      solved.circle->centre = turned_about(print.centre, solved.circle->centre, shape[MarkerShape::kRotation],
                                           1.0 + shape[MarkerShape::kScale]) +
                              moved;
    print.centre = print.centre + moved;
    print.angle_rad += shape[MarkerShape::kRotation];
    print.pitch_mm *= 1.0 + shape[MarkerShape::kScale];
  } else if (solved.circle) {
    solved.circle->centre = solved.circle->centre + moved;
  }
  if (has_new_height(site, scene, marker)) solved.z_mm = shape[MarkerShape::kHeight];
  return solved;
}

Site solved_site(const Site& site, const Scene& scene) {
  Site solved;
  std::vector<int> places, turns, scales, heights;
  bool stated_only = false;  // a height that was not solved
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    solved.markers.push_back(solved_marker(site, scene, i));
    for (const int k : {MarkerShape::kX, MarkerShape::kY}) {
      if (is_solved(scene, i, k)) places.push_back(shape_row(i, k));
    }
    if (is_solved(scene, i, MarkerShape::kRotation)) turns.push_back(shape_row(i, MarkerShape::kRotation));
    if (is_solved(scene, i, MarkerShape::kScale)) scales.push_back(shape_row(i, MarkerShape::kScale));
    if (has_new_height(site, scene, i))
      heights.push_back(shape_row(i, MarkerShape::kHeight));
    else
      stated_only |= site.markers[i].role == Role::kReference || site.markers[i].z_mm.has_value();
  }
  const KnownTo& known = site.known_to;
  const double height_mm = width_over(scene, heights, known.height_mm);
  // A solution only adds information, so values above the stated ones are rounding errors.
  const auto at_most = [&](const std::vector<int>& rows, double given) {
    return std::min(given, width_over(scene, rows, given));
  };
  solved.known_to = {at_most(places, known.position_mm), at_most(turns, known.rotation_rad),
                     stated_only ? std::max(height_mm, known.height_mm) : height_mm,
                     at_most(scales, known.print_scale)};
  return solved;
}

}  // namespace moiregauge::internal
