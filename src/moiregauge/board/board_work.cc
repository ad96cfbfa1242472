// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/board/board_work.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "moiregauge/geometry/conic.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kOutlier = 5.0;        // standard deviations of a point; chosen
constexpr double kMinOutlier_px = 0.1;  // least limit of an outlier; chosen
// Median length of a vector of two normal coordinates, in standard deviations of one (Rayleigh distribution).
constexpr double kMedianLength = 1.1774;

// Returns the offset from the image of a dot's centre to the centre of its outline, px. Perspective displaces the
// ellipse, and the lens bends the outline. Let the outline move by w, with normals n of the unit circle. The fitted
// ellipse then moves by 2 mean(n (n . w)).
Extent<frame::Image> ellipse_offset(const IdealFromBoard& view, const Camera& lens, const BoardPointSeen& dot) {
  constexpr int kOutline = 12;  // points on the outline
  const IdealPoint centre = ellipse_centre(view, dot.board, dot.diameter_mm);
  const ImagePoint middle = lens.distort(centre);
  const Matrix2 ideal_axes = 0.5 * dot.diameter_mm * view.jacobian(dot.board);
  std::array<Eigen::Vector2d, kOutline> normal, out;
  Matrix2 axes = Matrix2::Zero();
  for (std::size_t k = 0; k < kOutline; ++k) {
    const double angle = kTwoPi * static_cast<double>(k) / kOutline;
    normal[k] = {std::cos(angle), std::sin(angle)};
    const Eigen::Vector2d ideal = ideal_axes * normal[k];
    const auto off = lens.distort({centre.x + ideal.x(), centre.y + ideal.y()}) - middle;
    out[k] = {off.x, off.y};
    axes += 2.0 / kOutline * out[k] * normal[k].transpose();
  }
  Eigen::Vector2d moved{0, 0};
  for (std::size_t k = 0; k < kOutline; ++k)
    moved += 2.0 / kOutline * normal[k] * normal[k].dot(axes.inverse() * out[k]);
  const Eigen::Vector2d off = axes * moved;
  return middle + Extent<frame::Image>{off.x(), off.y()} - lens.distort(view(dot.board));
}

}  // namespace

Camera camera_of(const CameraBlock& b, int width, int height) {
  return {width, height, b[0], b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]};
}

IdealFromBoard view_of_pose(const Pose& pose, const CameraBlock& camera) {
  return view_of(pose, camera_of(camera, 0, 0));
}

BoardData data_of(const BoardWork& work) {
  BoardData data;
  data.places = work.places;
  data.print_mm = work.print_mm;
  for (std::size_t v = 0; v < work.views.size(); ++v) {
    const IdealFromBoard view = view_of_pose(work.state.poses[v], work.state.camera);
    const Camera lens = camera_of(work.state.camera, work.views[v]->width, work.views[v]->height);
    auto& points = data.views.emplace_back();
    auto& u = data.u_px.emplace_back();
    auto& place = data.place.emplace_back();
    for (std::size_t i = 0; i < work.views[v]->points.size(); ++i) {
      if (work.is_outlier[v][i]) continue;
      BoardPointSeen p = work.views[v]->points[i];
      for (int k = 0; k < work.turns[v]; ++k) p.board = {-p.board.y, p.board.x};
      if (p.diameter_mm > 0.0) {
        const auto off = ellipse_offset(view, lens, p);
        p.at = {p.at.x - off.x, p.at.y - off.y};
      }
      points.push_back(p);
      u.push_back(std::hypot(p.u_px, work.point_px));
      place.push_back(work.place[v][i]);
    }
  }
  return data;
}

BoardScatter scatter_of(const BoardWork& work, const BoardModel& model, double point_px) {
  const auto is_free = free_of(model);
  BoardScatter s;
  s.dof = -static_cast<double>(std::count(is_free.begin(), is_free.end(), true)) -
          6.0 * static_cast<double>(work.views.size());
  for (std::size_t v = 0; v < work.data.views.size(); ++v) {
    for (const BoardPointSeen& p : work.data.views[v]) {
      const auto r = residual_of(work.state, v, p);
      s.chi2 += (r.x * r.x + r.y * r.y) / (p.u_px * p.u_px + point_px * point_px);
      s.dof += 2.0;
    }
  }
  return s;
}

double scatter_beyond_noise(const BoardWork& work, const BoardModel& model) {
  if (const BoardScatter s = scatter_of(work, model, 0.0); s.chi2 <= s.dof || s.dof <= 0.0) return 0.0;
  double low = 1e-6, high = 100.0;  // px
  for (int k = 0; k < 50; ++k) {
    const double middle = std::sqrt(low * high);
    const BoardScatter s = scatter_of(work, model, middle);
    (s.chi2 > s.dof ? low : high) = middle;
  }
  return low;
}

void find_outliers(BoardWork& work) {
  for (std::size_t v = 0; v < work.views.size(); ++v) work.is_outlier[v].assign(work.views[v]->points.size(), false);
  const BoardData every = data_of(work);
  std::vector<double> all;
  for (std::size_t v = 0; v < work.views.size(); ++v) {
    for (const BoardPointSeen& p : every.views[v]) all.push_back(length(residual_of(work.state, v, p)));
  }
  std::vector<double> sorted = all;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double limit = std::max(kMinOutlier_px, kOutlier * *middle / kMedianLength);
  std::size_t next = 0;
  for (std::size_t v = 0; v < work.views.size(); ++v) {
    for (std::size_t i = 0; i < every.views[v].size(); ++i) work.is_outlier[v][i] = all[next++] > limit;
  }
}

double patch_scatter(const BoardWork& work) {
  double sum = 0.0, count = 0.0;
  // The pose of a view (6 parameters) and its share of the camera absorb a part of the view's 18 means.
  const double left = 1.0 - (6.0 + kCameraParameters / static_cast<double>(work.views.size())) / 18.0;
  for (std::size_t v = 0; v < work.data.views.size(); ++v) {
    const auto patch = patch_of(work.data.views[v]);
    std::array<Extent<frame::Image>, kBoardPatches> mean{};
    std::array<double, kBoardPatches> n{};
    double squares = 0.0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const auto r = residual_of(work.state, v, work.data.views[v][i]);
      mean[patch[i]] = mean[patch[i]] + r;
      n[patch[i]] += 1.0;
      squares += r.x * r.x + r.y * r.y;
    }
    const double one_point = squares / static_cast<double>(std::max<std::size_t>(1, patch.size()));
    for (std::size_t k = 0; k < kBoardPatches; ++k) {
      if (n[k] == 0.0) continue;
      const double x = mean[k].x / n[k], y = mean[k].y / n[k];
      sum += (x * x + y * y) / left - one_point / n[k];
      count += 2.0;
    }
  }
  return count > 0.0 ? std::sqrt(std::max(0.0, sum / count)) : 0.0;
}

}  // namespace moiregauge::internal
