// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_budget.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

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

// Returns the derivatives of the slopes of the references' plane (least squares) along x and y. They are by the scene
// parameters, per mm of height.
Eigen::Matrix<double, 2, Eigen::Dynamic> slopes_of_heights(const Site& site, Eigen::Index parameters) {
  Eigen::Matrix<double, 2, Eigen::Dynamic> out = Eigen::Matrix<double, 2, Eigen::Dynamic>::Zero(2, parameters);
  std::vector<std::pair<Eigen::Vector3d, int>> places;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const Marker& m = site.markers[i];
    if (m.role != Role::kReference || !m.grating) continue;
    places.emplace_back(Eigen::Vector3d(m.grating->centre.x, m.grating->centre.y, 1.0),
                        shape_row(i, MarkerShape::kHeight));
    normal += places.back().first * places.back().first.transpose();
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> plane(normal);
  if (!plane.isInvertible()) return out;
  for (const auto& [at, row] : places) out.col(row) = plane.solve(at).head<2>();
  return out;
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

// Derivative of one axis of a displacement by the scene: own parameters, and factors of the poses.
struct FrameBudget::Sensitivity {
  std::vector<int> own;       // places among the uncertain parameters
  std::vector<double> value;  // one for each of them
  Eigen::RowVectorXd poses;
};

PreciseBudget::PreciseBudget(const Site& site, const Eigen::MatrixXd& scene, FrameFit then, double u_readout_s)
    : place_of_(static_cast<std::size_t>(scene.rows()), -1), then_(std::move(then)), u_readout_s_(u_readout_s) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < scene.rows(); ++i) {
    if (!(scene(i, i) > 0.0)) continue;
    place_of_[static_cast<std::size_t>(i)] = static_cast<int>(used.size());
    used.push_back(i);
    const bool is_scale =
        i == kStretchParameter ||
        (i >= kCommonParameters && (i - kCommonParameters) % MarkerShape::kParameters == MarkerShape::kScale);
    group_.push_back(i < kCameraParameters ? kLens : is_scale ? kScale : kPlace);
  }
  scene_ = scene(used, used);
  u_axis_rad_ = std::sqrt(variance(turn_of_places(site, scene.rows()), scene));
  const auto slopes = slopes_of_heights(site, scene.rows());
  u_normal_ = {std::sqrt(variance(slopes.row(0), scene)), std::sqrt(variance(slopes.row(1), scene))};
  products_then_ = products_of(then_);
}

Eigen::MatrixXd PreciseBudget::pose_by_scene(const FrameFit& fit) const {
  const auto poses = fit.pose_sensitivity.rows();
  Eigen::MatrixXd out(poses, scene_.rows());
  for (std::size_t i = 0; poses > 0 && i < place_of_.size(); ++i) {
    if (place_of_[i] >= 0) out.col(place_of_[i]) = fit.pose_sensitivity.col(static_cast<Eigen::Index>(i));
  }
  return out;
}

PreciseBudget::Products PreciseBudget::products_of(const FrameFit& fit) const {
  Products out{pose_by_scene(fit), {}};
  for (int g = 0; g < kGroups; ++g) {
    std::vector<Eigen::Index> columns;
    for (std::size_t i = 0; i < group_.size(); ++i) {
      if (group_[i] == g) columns.push_back(static_cast<Eigen::Index>(i));
    }
    const Eigen::MatrixXd part = out.pose(Eigen::all, columns), covariance = scene_(Eigen::all, columns);
    out.by_group[static_cast<std::size_t>(g)] = covariance * part.transpose();
  }
  return out;
}

FrameBudget PreciseBudget::of_frame(const FrameFit& now) const { return {*this, now}; }

FrameBudget::FrameBudget(const PreciseBudget& all, const FrameFit& now) : all_(all), now_(now) {
  const auto here = all.products_of(now);
  const auto& there = all.products_then_;
  const auto poses = here.pose.rows(), size = here.pose.cols();
  // The change is small, so it is a coordinate of its own, or it would drown in rounding.
  poses_.resize(2 * poses, size);
  poses_ << here.pose, here.pose - there.pose;
  whole_.setZero(size, 2 * poses);
  for (std::size_t g = 0; g < by_group_.size(); ++g) {
    by_group_[g].resize(size, 2 * poses);
    by_group_[g] << here.by_group[g], here.by_group[g] - there.by_group[g];
    whole_ += by_group_[g];
    Eigen::MatrixXd of_group = poses_;
    for (std::size_t i = 0; i < all.group_.size(); ++i) {
      if (static_cast<std::size_t>(all.group_[i]) != g) of_group.col(static_cast<Eigen::Index>(i)).setZero();
    }
    of_group_[g] = of_group * by_group_[g];
  }
  of_whole_ = poses_ * whole_;
}

// With rest frames the reference frame has no shift of its own. It shares the position in which the target rests.
FrameBudget::Sensitivity FrameBudget::sensitivity(std::size_t marker, int axis) const {
  const FrameFit& then = all_.then_;
  const auto part = [marker](const FrameFit& fit) -> const ShiftPart& {
    return fit.shift_parts[static_cast<std::size_t>(fit.shift_row[marker] - 6) / 2];
  };
  const bool has_shift_then = then.shift_row[marker] >= 0;
  Sensitivity out;
  for (int k = 0; k < kOwnParameters; ++k) {
    const int index = k < kCommonParameters ? k : shape_row(marker, k - kCommonParameters);
    const int place = all_.place_of_[static_cast<std::size_t>(index)];
    if (place < 0) continue;
    out.own.push_back(place);
    out.value.push_back(part(now_).by_own(axis, k) - (has_shift_then ? part(then).by_own(axis, k) : 0.0));
  }
  const auto poses = poses_.rows() / 2;
  out.poses = Eigen::RowVectorXd::Zero(2 * poses);
  out.poses.head(poses) = part(now_).by_pose.row(axis);
  if (has_shift_then) {
    out.poses.head(poses) -= part(then).by_pose.row(axis);
    out.poses.tail(poses) = part(then).by_pose.row(axis);
  }
  return out;
}

// Returns the variance by the parameters of one group. `own`: which of the own parameters belong to it.
double FrameBudget::variance(const Sensitivity& k, const std::vector<int>& own, const Eigen::MatrixXd& to_scene,
                             const Eigen::MatrixXd& own_poses) const {
  double sum = k.poses * own_poses * k.poses.transpose();
  for (const int a : own) {
    const auto i = static_cast<std::size_t>(a);
    sum += 2.0 * k.value[i] * to_scene.row(k.own[i]).dot(k.poses);
    for (const int b : own) {
      const auto j = static_cast<std::size_t>(b);
      sum += k.value[i] * k.value[j] * all_.scene_(k.own[i], k.own[j]);
    }
  }
  return std::max(0.0, sum);
}

// Returns the places of the target's position (x, y), if it is uncertain.
std::vector<int> FrameBudget::own_position_of(std::size_t marker) const {
  std::vector<int> out;
  for (const int k : {MarkerShape::kX, MarkerShape::kY}) {
    const int place = all_.place_of_[static_cast<std::size_t>(shape_row(marker, k))];
    if (place >= 0) out.push_back(place);
  }
  return out;
}

// Returns the derivative by one parameter.
double FrameBudget::derivative(const Sensitivity& k, int place) const {
  double sum = k.poses.dot(poses_.col(place));
  for (std::size_t i = 0; i < k.own.size(); ++i) sum += k.own[i] == place ? k.value[i] : 0.0;
  return sum;
}

// Returns the row `place` of the covariance times the derivatives by all parameters of the group of positions.
double FrameBudget::product_with_places(const Sensitivity& k, int place) const {
  double sum = by_group_[PreciseBudget::kPlace].row(place).dot(k.poses);
  for (std::size_t i = 0; i < k.own.size(); ++i) {
    if (all_.group_[static_cast<std::size_t>(k.own[i])] == PreciseBudget::kPlace)
      sum += all_.scene_(place, k.own[i]) * k.value[i];
  }
  return sum;
}

// Divides the scene's variance among its groups of parameters. They are correlated, so each group's own variance is
// scaled to give the whole sum. The axes' part is taken first, from the displacement across the axis.
FrameBudget::Share FrameBudget::share(std::size_t marker, int axis, double across_mm) const {
  const Sensitivity k = sensitivity(marker, axis);
  std::vector<int> every;
  std::array<std::vector<int>, PreciseBudget::kGroups> of_group;
  for (std::size_t i = 0; i < k.own.size(); ++i) {
    every.push_back(static_cast<int>(i));
    of_group[static_cast<std::size_t>(all_.group_[static_cast<std::size_t>(k.own[i])])].push_back(static_cast<int>(i));
  }
  Share s;
  double whole = variance(k, every, whole_, of_whole_);
  s.axis = std::min(whole, all_.u_axis_rad_ * all_.u_axis_rad_ * across_mm * across_mm);
  whole -= s.axis;
  std::array<double, PreciseBudget::kGroups> part{};
  for (std::size_t g = 0; g < part.size(); ++g) part[g] = variance(k, of_group[g], by_group_[g], of_group_[g]);
  // The target's own position is a group of its own.
  double rest = 0.0;
  double& place = part[PreciseBudget::kPlace];
  const auto own_position = own_position_of(marker);
  for (const int a : own_position) {
    const double by_a = derivative(k, a);
    place -= 2.0 * by_a * product_with_places(k, a);
    for (const int b : own_position) rest += by_a * derivative(k, b) * all_.scene_(a, b);
  }
  place = std::max(0.0, place + rest);
  rest = std::max(0.0, rest);
  const double sum = part[PreciseBudget::kLens] + place + part[PreciseBudget::kScale] + rest;
  const double f = sum > 0.0 ? whole / sum : 0.0;
  s.lens = f * part[PreciseBudget::kLens], s.geometry = f * place, s.scale = f * part[PreciseBudget::kScale];
  s.rest = f * rest;
  return s;
}

Budget FrameBudget::budget(std::size_t marker, Extent<frame::Board> moved) const {
  Budget b;
  const FrameFit& then = all_.then_;
  for (const int axis : {0, 1}) {
    const auto member = [axis](Extent<frame::Board>& e) -> double& { return axis == 0 ? e.x : e.y; };
    const int row = now_.shift_row[marker] + axis;
    double shutter = of_motion(now_, row);
    double by_readout = of_readout(now_, row);
    const double all = inflation(now_) * now_.variance(row) - shutter;
    const Eigen::Matrix2d information = now_.own_information[marker];
    const double alone = information(axis, axis) > 0.0 ? inflation(now_) / information(axis, axis) : all;
    const double own = std::min(all, alone);
    member(b.noise) = std::sqrt(own);
    member(b.references) = std::sqrt(all - own);
    double reference_frame = 0.0;
    if (then.shift_row[marker] >= 0) {
      const int before = then.shift_row[marker] + axis;
      shutter += of_motion(then, before);
      by_readout -= of_readout(then, before);
      reference_frame = inflation(then) * then.variance(before) - of_motion(then, before);
    }
    const Share s = share(marker, axis, axis == 0 ? moved.y : moved.x);
    member(b.reference_frame) = std::sqrt(reference_frame + s.rest);
    member(b.lens) = std::sqrt(s.lens);
    member(b.geometry) = std::sqrt(s.geometry);
    member(b.print_scale) = std::sqrt(s.scale);
    member(b.axis) = std::sqrt(s.axis);
    member(b.shutter) = std::hypot(std::sqrt(shutter), by_readout * all_.u_readout_s_);
  }
  return b;
}

Budget FrameBudget::budget(const FrameFit& now_by_noise, const FrameFit& then_by_noise, std::size_t marker,
                           Extent<frame::Board> moved) const {
  Budget b = budget(marker, moved);
  for (const int axis : {0, 1}) {
    const auto member = [axis](Extent<frame::Board>& e) -> double& { return axis == 0 ? e.x : e.y; };
    // Share of noise in a variance that contains noise and codec.
    const auto by_noise = [marker, axis](const FrameFit& both, const FrameFit& noise) {
      const int row = both.shift_row[marker], alone = noise.ok ? noise.shift_row[marker] : -1;
      if (row < 0 || alone < 0) return 1.0;
      return std::min(1.0, noise.variance(alone + axis) / both.variance(row + axis));
    };
    const double here = by_noise(now_, now_by_noise), there = by_noise(all_.then_, then_by_noise);
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
  const Eigen::MatrixXd by_scene = pose_by_scene(now).topRows<6>();
  Eigen::Matrix<double, 6, 6> covariance = inflation(now) * now.pose_covariance.topLeftCorner<6, 6>();
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
