// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_budget.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

double variance(const Eigen::RowVectorXd& k, const Eigen::MatrixXd& c) {
  return std::max(0.0, (k * c * k.transpose())(0));
}

// Returns the derivative of the board's rotation in its plane by the scene parameters, rad per unit. Only the
// references' positions contribute.
Eigen::RowVectorXd turn_of_places(const Site& site, Eigen::Index parameters) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(parameters);
  double x = 0.0, y = 0.0, n = 0.0, sum = 0.0;
  for (const Marker& m : site.markers) {
    if (m.role == Role::kReference && m.grating) x += m.grating->centre.x, y += m.grating->centre.y, n += 1.0;
  }
  if (n < 2.0) return row;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const Marker& m = site.markers[i];
    if (m.role != Role::kReference || !m.grating) continue;
    const double dx = m.grating->centre.x - x / n, dy = m.grating->centre.y - y / n;
    row(shape_row(i, MarkerShape::kX)) = -dy;
    row(shape_row(i, MarkerShape::kY)) = dx;
    sum += dx * dx + dy * dy;
  }
  return sum > 0.0 ? Eigen::RowVectorXd(row / sum) : row;
}

// Returns the variance that motion during readout adds to a shift, mm^2. 0 for a global shutter.
double of_motion(const FrameFit& fit, int row) {
  return row < fit.of_motion.size() ? inflation(fit) * fit.of_motion(row) : 0.0;
}

double of_readout(const FrameFit& fit, int row) { return row < fit.by_readout.size() ? fit.by_readout(row) : 0.0; }

}  // namespace

double inflation(const FrameFit& fit) {
  return fit.dof > 0 ? std::max(1.0, fit.chi2_sum / static_cast<double>(fit.dof)) : 1.0;
}

// Variances, mm^2.
struct PreciseBudget::Share {
  double lens = 0.0, geometry = 0.0, scale = 0.0, axis = 0.0, rest = 0.0;
};

PreciseBudget::PreciseBudget(const Site& site, Eigen::MatrixXd scene, FrameFit then, double u_readout_s)
    : scene_(std::move(scene)), then_(std::move(then)), u_readout_s_(u_readout_s) {
  u_axis_rad_ = std::sqrt(variance(turn_of_places(site, scene_.rows()), scene_));
}

// Divides the scene's variance among its groups of parameters. They are correlated, so each group's own variance is
// scaled to give the whole sum. The axes' part is taken first, from the displacement across the axis.
PreciseBudget::Share PreciseBudget::share(const Eigen::RowVectorXd& k, std::size_t marker, double across_mm) const {
  Share s;
  double whole = variance(k, scene_);
  s.axis = std::min(whole, u_axis_rad_ * u_axis_rad_ * across_mm * across_mm);
  whole -= s.axis;
  Eigen::RowVectorXd lens = Eigen::RowVectorXd::Zero(k.size()), scale = lens, place = lens, rest = lens;
  for (Eigen::Index i = 0; i < k.size(); ++i) {
    const bool is_lens = i < kCameraParameters;
    const bool is_scale =
        i == kStretchParameter ||
        (i >= kCommonParameters && (i - kCommonParameters) % MarkerShape::kParameters == MarkerShape::kScale);
    const bool is_rest = i == shape_row(marker, MarkerShape::kX) || i == shape_row(marker, MarkerShape::kY);
    (is_lens ? lens : is_scale ? scale : is_rest ? rest : place)(i) = k(i);
  }
  const double a = variance(lens, scene_), b = variance(place, scene_), c = variance(scale, scene_),
               d = variance(rest, scene_), sum = a + b + c + d;
  const double f = sum > 0.0 ? whole / sum : 0.0;
  s.lens = f * a, s.geometry = f * b, s.scale = f * c, s.rest = f * d;
  return s;
}

Budget PreciseBudget::budget(const FrameFit& now, std::size_t marker, Extent<frame::Board> moved) const {
  Budget b;
  for (const int axis : {0, 1}) {
    const auto member = [axis](Extent<frame::Board>& e) -> double& { return axis == 0 ? e.x : e.y; };
    const int row = now.shift_row[marker] + axis;
    double shutter = of_motion(now, row);
    double by_readout = of_readout(now, row);
    const double all = inflation(now) * now.covariance(row, row) - shutter;
    const Eigen::Matrix2d information = now.own_information[marker];
    const double alone = information(axis, axis) > 0.0 ? inflation(now) / information(axis, axis) : all;
    const double own = std::min(all, alone);
    member(b.noise) = std::sqrt(own);
    member(b.references) = std::sqrt(all - own);
    Eigen::RowVectorXd k = now.sensitivity.row(row);
    double reference_frame = 0.0;
    // With rest frames the reference frame has no shift of its own. It shares the position in which the target rests.
    if (then_.shift_row[marker] >= 0) {
      const int before = then_.shift_row[marker] + axis;
      shutter += of_motion(then_, before);
      by_readout -= of_readout(then_, before);
      reference_frame = inflation(then_) * then_.covariance(before, before) - of_motion(then_, before);
      k -= then_.sensitivity.row(before);
    }
    const Share s = share(k, marker, axis == 0 ? moved.y : moved.x);
    member(b.reference_frame) = std::sqrt(reference_frame + s.rest);
    member(b.lens) = std::sqrt(s.lens);
    member(b.geometry) = std::sqrt(s.geometry);
    member(b.print_scale) = std::sqrt(s.scale);
    member(b.axis) = std::sqrt(s.axis);
    member(b.shutter) = std::hypot(std::sqrt(shutter), by_readout * u_readout_s_);
  }
  return b;
}

Budget PreciseBudget::budget(const FrameFit& now, const FrameFit& now_by_noise, const FrameFit& then_by_noise,
                             std::size_t marker, Extent<frame::Board> moved) const {
  Budget b = budget(now, marker, moved);
  for (const int axis : {0, 1}) {
    const auto member = [axis](Extent<frame::Board>& e) -> double& { return axis == 0 ? e.x : e.y; };
    // Share of noise in a variance that contains noise and codec.
    const auto by_noise = [marker, axis](const FrameFit& both, const FrameFit& noise) {
      const int row = both.shift_row[marker], alone = noise.ok ? noise.shift_row[marker] : -1;
      if (row < 0 || alone < 0) return 1.0;
      return std::min(1.0, noise.covariance(alone + axis, alone + axis) / both.covariance(row + axis, row + axis));
    };
    const double here = by_noise(now, now_by_noise), there = by_noise(then_, then_by_noise);
    double codec = 0.0;
    const auto take = [&codec](double& part, double share) {
      codec += (1.0 - share) * part * part;
      part *= std::sqrt(share);
    };
    take(member(b.noise), here);
    take(member(b.references), here);
    take(member(b.reference_frame), there);
    member(b.codec) = std::sqrt(codec);
  }
  return b;
}

CameraPose PreciseBudget::pose(const FrameFit& now) const {
  if (!now.ok) return {};
  const Eigen::MatrixXd by_scene = now.sensitivity.topRows<6>();
  Eigen::Matrix<double, 6, 6> covariance = inflation(now) * now.covariance.topLeftCorner<6, 6>();
  covariance += by_scene * scene_ * by_scene.transpose();
  if (now.by_readout.size() > 0) {
    const Eigen::Matrix<double, 6, 1> by_readout = u_readout_s_ * now.by_readout.head<6>();
    covariance += by_readout * by_readout.transpose();
  }
  return camera_pose(now.pose, covariance);
}

Extent<frame::Board> total(const Budget& budget) {
  double x = 0.0, y = 0.0;
  for (const BudgetPart& part : kBudgetParts) {
    x += (budget.*part.value).x * (budget.*part.value).x;
    y += (budget.*part.value).y * (budget.*part.value).y;
  }
  return {std::sqrt(x), std::sqrt(y)};
}

}  // namespace moiregauge::internal
