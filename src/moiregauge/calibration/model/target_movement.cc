// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/target_movement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/fitted_patch.h"
#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/calibration/scene/out_of_plane.h"

namespace moiregauge::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPasses = 3;       // largest number of Gauss-Newton steps; chosen
constexpr double kSmall = 1e-6;  // rad, step that ends them: 0.1 um at the edge of a print of 200 mm
constexpr double kStep = 1e-4;   // rad, central difference. Its relative error is the square of it
constexpr double kWide = 1.0;    // rad, prior of an unknown rotation
// The prior is this many times the rms movement, so that it does not draw the estimates towards zero. Chosen.
constexpr double kTimesRms = 3.0;
// Largest u of a rotation that is removed without being proven, rad. Its square shortens the print by 5e-6. Chosen.
constexpr double kHarmless = 3e-3;

constexpr std::size_t kMinFrames = 4;
// Least mean square of a slow movement out of the plane, relative to that of the median reference. Chosen.
constexpr double kAboveReferences = 2.0;
// Largest misfit of a frame, relative to the median. Chosen.
constexpr double kWorseThanMedian = 5.0;

// Displacement along x and y, then the movement beyond it. A movement towards the camera would otherwise look
// like a tilt, because a target that is seen from the side becomes longer by both.
constexpr int kUnknowns = 6;
constexpr int kMovementAt = 2;
using Rotation3 = Eigen::Vector3d;
using MovementColumns = Eigen::Matrix<double, PatchResidual::kSize, 4>;
using Columns = Eigen::Matrix<double, PatchResidual::kSize, kUnknowns>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

// Camera and place of one target in one frame.
class TargetView {
 public:
  // `about`: the point of the grating that does not move, pitches.
  TargetView(const Site& site, const Scene& scene, const FrameFit& fit, std::size_t marker, PrintPoint about = {})
      : camera_(numbers_of(scene)),
        pose_{fit.pose.turn[0],  fit.pose.turn[1],  fit.pose.turn[2],
              fit.pose.shift[0], fit.pose.shift[1], fit.pose.shift[2]},
        shape_(scene.markers[marker]),
        shift_(fit.shift[marker]) {
    const Grating& grating = *site.markers[marker].grating;
    const double angle = grating.angle_rad + shape_.value[MarkerShape::kRotation];
    const double c = grating.pitch_mm * std::cos(angle), s = grating.pitch_mm * std::sin(angle);
    const auto from_centre =
        turned_by(tilt_of(shape_).data(), std::array{c * about.x - s * about.y, s * about.x + c * about.y, 0.0});
    centre_ = {grating.centre.x + shape_.value[MarkerShape::kX] + shift_.x + from_centre[0],
               grating.centre.y + shape_.value[MarkerShape::kY] + shift_.y + from_centre[1],
               shape_.value[MarkerShape::kHeight] + from_centre[2]};
  }

  // Returns by how much a movement beyond displacement moves point n in the image, px.
  [[nodiscard]] Vector2d moved_by(const PatchResidual& patch, std::size_t n, const Movement4& movement) const {
    const Rotation3 rotation = movement.tail<3>();
    const auto at = patch.board(camera_[kStretchParameter], shape_, shift_, n);
    const Vector3d from_centre = Vector3d(at.data()) - centre_;
    const auto turned = turned_by(rotation.data(), std::array{from_centre.x(), from_centre.y(), from_centre.z()});
    const auto there = projected(
        camera_.data(), pose_.data(),
        {centre_.x() + turned[0], centre_.y() + turned[1], centre_.z() + turned[2] + movement(MovementAxis::kHeight)});
    const auto here = projected(camera_.data(), pose_.data(), at);
    return {there[0] - here[0], there[1] - here[1]};
  }

  // Returns the derivatives of the residuals by the movement, pitches per mm and per rad.
  [[nodiscard]] MovementColumns by_movement(const PatchResidual& patch) const {
    MovementColumns out;
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      for (Eigen::Index axis = 0; axis < out.cols(); ++axis) {
        const double step = axis == MovementAxis::kHeight ? kStep * pose_[5] : kStep;
        const Movement4 by = step * Movement4::Unit(axis);
        const Vector2d off =
            patch.pitches_per_px(n) * (moved_by(patch, n, by) - moved_by(patch, n, -by)) / (2.0 * step);
        out(static_cast<Eigen::Index>(n), axis) = off.x();
        out(static_cast<Eigen::Index>(n + kPatchPoints), axis) = off.y();
      }
    }
    return out;
  }

 private:
  CommonNumbers camera_;
  std::array<double, 6> pose_;
  MarkerShape shape_;
  Extent<frame::Board> shift_;
  Vector3d centre_;
};

// Movement that one target shows beyond the one that was removed.
struct ShownMovement {
  Movement4 value, variance;
  double chi2 = 0.0;  // that remains
  int dof = 1;
  [[nodiscard]] double misfit() const { return chi2 / dof; }
};

// Movement that was removed from a frame, and the standard uncertainty of the whole movement. A height without one is
// free.
struct KnownMovement {
  Movement4 removed = Movement4::Zero(), u = {0.0, kWide, kWide, kWide};
};

ShownMovement shown_movement(const PatchResidual& patch, const PatchResidual::Design& design, const TargetView& view,
                             const KnownMovement& known = {}) {
  const PatchResidual::Vector residual = design.col(PatchColumn::kResidual);
  Columns columns;
  columns << design.middleCols<2>(PatchColumn::kShape), patch.root() * view.by_movement(patch);
  Normal normal = columns.transpose() * columns;
  Unknowns right = columns.transpose() * residual;
  for (Eigen::Index axis = 0; axis < 4; ++axis) {
    if (axis == MovementAxis::kHeight && !(known.u(axis) > 0.0)) continue;
    const double information = 1.0 / std::max(known.u(axis) * known.u(axis), kSmall * kSmall);
    normal(kMovementAt + axis, kMovementAt + axis) += information;
    right(kMovementAt + axis) += information * known.removed(axis);
  }
  const Eigen::LDLT<Normal> root(normal);
  const Unknowns step = -root.solve(right);
  const Normal covariance = root.solve(Normal::Identity());
  return {.value = step.tail<4>(),
          .variance = covariance.diagonal().tail<4>(),
          .chi2 = (residual + columns * step).squaredNorm(),
          .dof = std::max(1, patch.rank() - kUnknowns)};
}

// Movements of one target over the frames.
class MovementSeries {
 public:
  void add(const ShownMovement& shown) { shown_.push_back(shown); }
  [[nodiscard]] std::size_t frames() const { return shown_.size(); }

  // Removes frames that no movement explains, as of a target that is covered or blurred.
  void keep_what_fits() {
    std::vector<double> misfits;
    for (const ShownMovement& one : shown_) misfits.push_back(one.misfit());
    if (misfits.empty()) return;
    const auto middle = misfits.begin() + static_cast<long>(misfits.size() / 2);
    std::nth_element(misfits.begin(), middle, misfits.end());
    const double most = kWorseThanMedian * std::max(1.0, *middle);
    std::erase_if(shown_, [most](const ShownMovement& one) { return one.misfit() > most; });
  }
  // Returns the variance of unit weight, at least 1.
  [[nodiscard]] double unit() const {
    double sum = 0.0;
    for (const ShownMovement& one : shown_) sum += one.misfit() / static_cast<double>(shown_.size());
    return std::max(1.0, sum);
  }
  // Returns the mean square about `about`, in units of that of noise. The largest square does not count, so one frame
  // proves nothing.
  [[nodiscard]] Movement4 in_noise(const Movement4& about) const {
    Movement4 sum = Movement4::Zero(), most = sum;
    const double unit = this->unit();
    for (const ShownMovement& one : shown_) {
      const Movement4 square = (one.value - about).cwiseAbs2().cwiseQuotient(unit * one.variance);
      sum += square;
      most = most.cwiseMax(square);
    }
    return (sum - most) / static_cast<double>(shown_.size());
  }
  [[nodiscard]] Movement4 mean() const {
    return mean_of([](const ShownMovement& one) { return one.value; });
  }
  [[nodiscard]] Movement4 mean_square() const {
    return mean_of([](const ShownMovement& one) { return Movement4(one.value.cwiseAbs2()); });
  }
  [[nodiscard]] Movement4 noise() const {
    return unit() * mean_of([](const ShownMovement& one) { return one.variance; });
  }

 private:
  template <typename Value>
  [[nodiscard]] Movement4 mean_of(const Value& value) const {
    Movement4 sum = Movement4::Zero();
    for (const ShownMovement& one : shown_) sum += value(one);
    return sum / static_cast<double>(shown_.size());
  }
  std::vector<ShownMovement> shown_;
};

// Returns the mean square about the mean that the median reference shows, in units of that of noise; 1 if unknown.
// References do not move, so this is what a rolling shutter or hot air leave.
Movement4 shown_by_references(const Site& site, const std::vector<MovementSeries>& series) {
  Movement4 out = Movement4::Ones();
  for (Eigen::Index axis = 0; axis < out.size(); ++axis) {
    std::vector<double> shown;
    for (std::size_t i = 0; i < series.size(); ++i) {
      if (site.markers[i].role == Role::kReference && series[i].frames() >= kMinFrames)
        shown.push_back(series[i].in_noise(series[i].mean())(axis));
    }
    if (shown.empty()) continue;
    const auto middle = shown.begin() + static_cast<long>(shown.size() / 2);
    std::nth_element(shown.begin(), middle, shown.end());
    out(axis) = *middle;
  }
  return out;
}

// Returns the movement of a target, zero if it is only displaced. `references`: mean squares that they show.
TargetMovement movement_of(const MovementSeries& series, const Movement4& references, const HeightSeries& heights) {
  if (series.frames() < kMinFrames) return {};
  const Movement4 shown = series.in_noise(series.mean()), least = kProvenMovement * references.cwiseMax(1.0);
  const Movement4 beyond = shown - least;
  const bool drifts =
      heights.drifts() && shown(MovementAxis::kHeight) > kAboveReferences * references(MovementAxis::kHeight);
  const bool leaves_plane = drifts || (heights.scatters() && beyond(MovementAxis::kHeight) > 0.0);
  const bool rotates = beyond.tail<3>().maxCoeff() > 0.0;
  const Movement4 square = series.mean_square(), noise = series.noise(), proven = series.in_noise(Movement4::Zero());
  TargetMovement out;
  out.u = noise.cwiseSqrt();
  const auto free = [&](Eigen::Index axis) {
    out.prior(axis) = kTimesRms * std::sqrt(std::max(square(axis) - noise(axis), noise(axis)));
  };
  if (leaves_plane) free(MovementAxis::kHeight);
  for (Eigen::Index axis = MovementAxis::kRotation; rotates && axis <= MovementAxis::kInPlane; ++axis) {
    if (proven(axis) > least(axis) || noise(axis) < kHarmless * kHarmless) free(axis);
  }
  return out;
}

// Adds the prior's movements to the covariance of the points. `columns`: before they are whitened.
void add_prior(const MovementColumns& columns, const Movement4& prior, PatchInformation& information) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index axis = 0; axis < prior.size(); ++axis) {
    if (prior(axis) > 0.0) free.push_back(axis);
  }
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd used(PatchResidual::kSize, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const Eigen::Index axis = free[static_cast<std::size_t>(k)];
    used.col(k) = prior(axis) * columns.col(axis);
  }
  // Woodbury's formula
  const Eigen::MatrixXd across = information * used;
  const Eigen::MatrixXd inner = Eigen::MatrixXd::Identity(size, size) + used.transpose() * across;
  const PatchInformation out = information - across * inner.ldlt().solve(across.transpose());
  information = 0.5 * (out + out.transpose());
}

}  // namespace

TargetMovements find_movements(const Site& site, const Scene& scene, std::span<const BundleFrame> frames) {
  std::vector<MovementSeries> series(site.markers.size());
  std::vector<HeightSeries> heights(site.markers.size());
  for (const BundleFrame& frame : frames) {
    const FrameFit fit = fit_frame(site, scene, frame, FrameDetail::kSamples);
    const auto shown = shown_heights(site, scene, frame, fit);
    for (std::size_t i = 0; fit.ok && i < series.size(); ++i) {
      const bool is_target = site.markers[i].role != Role::kReference;
      if (!frame.points[i] || !site.markers[i].grating || (is_target && fit.shift_row[i] < 0)) continue;
      const PatchResidual patch(*frame.points[i], site.markers[i]);
      series[i].add(shown_movement(patch, fitted_design(patch, scene, frame, fit, i), {site, scene, fit, i}));
      if (shown[i]) heights[i].add(*shown[i]);
    }
  }
  for (MovementSeries& one : series) one.keep_what_fits();
  const Movement4 references = shown_by_references(site, series);
  TargetMovements out(series.size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (site.markers[i].role != Role::kReference) out[i] = movement_of(series[i], references, heights[i]);
  }
  return std::ranges::any_of(out, &TargetMovement::moves) ? out : TargetMovements{};
}

double MovementRemoval::remove(std::size_t marker, const BundleFrame& read, const FrameFit& fit,
                               BundleFrame& frame) const {
  const PatchFit& as_read = *read.points[marker];
  PatchFit& points = *frame.points[marker];
  points.information = as_read.information;
  Movement4& removed = frame.removed[marker];
  const TargetMovement& movement = movements_[marker];
  const TargetView view(site_, scene_, fit, marker, centres_[marker].at);
  const PatchResidual patch(points, site_.markers[marker]);
  Movement4 step =
      shown_movement(patch, fitted_design(patch, scene_, frame, fit, marker), view, {removed, movement.prior}).value;
  if (!movement.leaves_plane()) step(MovementAxis::kHeight) = 0.0;
  removed += step;
  const PatchResidual before(as_read, site_.markers[marker]);
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const Vector2d moved = view.moved_by(before, n, removed);
    points.image[n] = {as_read.image[n].x - moved.x(), as_read.image[n].y - moved.y()};
  }
  add_prior(view.by_movement(PatchResidual(points, site_.markers[marker])), movement.prior, points.information);
  return std::max(step.tail<3>().cwiseAbs().maxCoeff(), std::abs(step(0)) / fit.pose.shift[2]);
}

BundleFrame MovementRemoval::displaced_only(const BundleFrame& read) const {
  BundleFrame out = read;
  out.removed.assign(site_.markers.size(), Movement4::Zero());
  for (int pass = 0; pass < kPasses; ++pass) {
    BundleFrame frame = out;
    frame.at_rest = false;
    frame.pose = pose_of(site_, scene_, frame).value_or(frame.pose);
    const FrameFit fit = fit_frame(site_, scene_, frame, FrameDetail::kSamples);
    if (!fit.ok) return read;
    double most = 0.0;
    for (std::size_t i = 0; i < site_.markers.size(); ++i) {
      if (fit.shift_row[i] >= 0 && movements_[i].moves()) most = std::max(most, remove(i, read, fit, out));
    }
    if (most < kSmall) break;
  }
  return out;
}

Extent<frame::Board> MovementRemoval::u_beyond_noise(std::size_t marker, const BundleFrame& now,
                                                     const BundleFrame& then) const {
  if (now.removed.empty() || then.removed.empty()) return {};
  const Movement4 between = now.removed[marker] - then.removed[marker];
  const double by_centre = centres_[marker].u_mm * std::abs(between(MovementAxis::kInPlane));
  if (!movements_[marker].leaves_plane()) return {by_centre, by_centre};
  const Grating& grating = *site_.markers[marker].grating;
  const TurnedPose pose(now.pose);
  const Vector3d camera = -(pose.rotation.transpose() * pose.shift);  // as X, -Y, -Z
  const double u_height_mm = u_of_size(now.pose, then.pose, between.tail<3>()) * now.pose.shift[2];
  const auto along = [&](double to_target_mm) { return u_height_mm * to_target_mm / camera.z(); };
  return {std::hypot(by_centre, along(grating.centre.x - camera.x())),
          std::hypot(by_centre, along(grating.centre.y + camera.y()))};
}

FrameSeries only_displaced(const FrameSeries& frames, std::shared_ptr<const MovementRemoval> removal) {
  if (!removal) return frames;
  return frames.with(
      [frames, removal = std::move(removal)](std::size_t k) { return removal->displaced_only(frames[k]); });
}

}  // namespace moiregauge::internal
