// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/target_rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/fitted_patch.h"
#include "moiregauge/calibration/scene/frame_pose.h"

namespace moiregauge::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPasses = 3;       // largest number of Gauss-Newton steps; chosen
constexpr double kSmall = 1e-6;  // rad, step that ends them: 0.1 um at the edge of a print of 200 mm
constexpr double kStep = 1e-4;   // rad, central difference. Its relative error is the square of it
constexpr double kWide = 1.0;    // rad, prior of an unknown rotation
// The prior is this many times the rms rotation, so that it does not draw the estimates towards zero. Chosen.
constexpr double kTimesRms = 3.0;
// Largest u of a rotation that is removed without being proven, rad. Its square shortens the print by 5e-6. Chosen.
constexpr double kHarmless = 3e-3;

constexpr std::size_t kMinFrames = 4;
// Largest misfit of a frame, relative to the median. Chosen.
constexpr double kWorseThanMedian = 5.0;

// Displacement along x and y, height, and rotation about three axes. A movement towards the camera would otherwise look
// like a tilt, because a target that is seen from the side becomes longer by both.
constexpr int kUnknowns = 6;
constexpr int kRotationAt = 3;
using RotationColumns = Eigen::Matrix<double, PatchResidual::kSize, 3>;
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
    centre_ = {grating.centre.x + shape_.value[MarkerShape::kX] + shift_.x + c * about.x - s * about.y,
               grating.centre.y + shape_.value[MarkerShape::kY] + shift_.y + s * about.x + c * about.y,
               shape_.value[MarkerShape::kHeight]};
  }

  // Returns the movement in the image by which a rotation moves point n, px.
  [[nodiscard]] Vector2d moved_by(const PatchResidual& patch, std::size_t n, const Rotation3& rotation) const {
    const auto at = patch.board(camera_[kStretchParameter], shape_, shift_, n);
    const Vector3d from_centre = Vector3d(at.data()) - centre_;
    const auto turned = turned_by(rotation.data(), std::array{from_centre.x(), from_centre.y(), from_centre.z()});
    const auto there = projected(camera_.data(), pose_.data(),
                                 {centre_.x() + turned[0], centre_.y() + turned[1], centre_.z() + turned[2]});
    const auto here = projected(camera_.data(), pose_.data(), at);
    return {there[0] - here[0], there[1] - here[1]};
  }

  // Returns the derivatives of the residuals by the rotation, pitches/rad.
  [[nodiscard]] RotationColumns columns(const PatchResidual& patch) const {
    RotationColumns out;
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const Rotation3 step = kStep * Rotation3::Unit(axis);
        const Vector2d off =
            patch.pitches_per_px(n) * (moved_by(patch, n, step) - moved_by(patch, n, -step)) / (2.0 * kStep);
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

// Rotation that one target shows beyond the one that was removed.
struct ShownRotation {
  Rotation3 rad, variance;
  double chi2 = 0.0;  // that remains
  int dof = 1;
  [[nodiscard]] double misfit() const { return chi2 / dof; }
};

// Rotation that was removed from a frame, and the standard uncertainty of the whole rotation.
struct KnownRotation {
  Rotation3 removed_rad = Rotation3::Zero(), u_rad = Rotation3::Constant(kWide);
};

ShownRotation shown_rotation(const PatchResidual& patch, const PatchResidual::Design& design, const TargetView& view,
                             const KnownRotation& known = {}) {
  const PatchResidual::Vector residual = design.col(PatchColumn::kResidual);
  Columns columns;
  columns << design.middleCols<2>(PatchColumn::kShape), design.col(PatchColumn::kShape + MarkerShape::kHeight),
      patch.root() * view.columns(patch);
  Normal normal = columns.transpose() * columns;
  Unknowns right = columns.transpose() * residual;
  for (int axis = 0; axis < 3; ++axis) {
    const double information = 1.0 / std::max(known.u_rad(axis) * known.u_rad(axis), kSmall * kSmall);
    normal(kRotationAt + axis, kRotationAt + axis) += information;
    right(kRotationAt + axis) += information * known.removed_rad(axis);
  }
  const Eigen::LDLT<Normal> root(normal);
  const Unknowns step = -root.solve(right);
  const Normal covariance = root.solve(Normal::Identity());
  return {.rad = step.tail<3>(),
          .variance = covariance.diagonal().tail<3>(),
          .chi2 = (residual + columns * step).squaredNorm(),
          .dof = std::max(1, patch.rank() - kUnknowns)};
}

// Rotations of one target over the frames.
class RotationSeries {
 public:
  void add(const ShownRotation& shown) { shown_.push_back(shown); }
  [[nodiscard]] std::size_t frames() const { return shown_.size(); }

  // Removes frames that no rotation explains, as of a target that is covered or blurred.
  void keep_what_fits() {
    std::vector<double> misfits;
    for (const ShownRotation& one : shown_) misfits.push_back(one.misfit());
    if (misfits.empty()) return;
    const auto middle = misfits.begin() + static_cast<long>(misfits.size() / 2);
    std::nth_element(misfits.begin(), middle, misfits.end());
    const double most = kWorseThanMedian * std::max(1.0, *middle);
    std::erase_if(shown_, [most](const ShownRotation& one) { return one.misfit() > most; });
  }
  // Returns the variance of unit weight, at least 1.
  [[nodiscard]] double unit() const {
    double sum = 0.0;
    for (const ShownRotation& one : shown_) sum += one.misfit() / static_cast<double>(shown_.size());
    return std::max(1.0, sum);
  }
  // Returns the mean square about `about`, in units of that of noise. The largest square does not count, so one frame
  // proves nothing.
  [[nodiscard]] Rotation3 in_noise(const Rotation3& about) const {
    Rotation3 sum = Rotation3::Zero(), most = sum;
    const double unit = this->unit();
    for (const ShownRotation& one : shown_) {
      const Rotation3 square = (one.rad - about).cwiseAbs2().cwiseQuotient(unit * one.variance);
      sum += square;
      most = most.cwiseMax(square);
    }
    return (sum - most) / static_cast<double>(shown_.size());
  }
  [[nodiscard]] Rotation3 mean() const {
    return mean_of([](const ShownRotation& one) { return one.rad; });
  }
  [[nodiscard]] Rotation3 mean_square() const {
    return mean_of([](const ShownRotation& one) { return Rotation3(one.rad.cwiseAbs2()); });
  }
  [[nodiscard]] Rotation3 noise() const {
    return unit() * mean_of([](const ShownRotation& one) { return one.variance; });
  }

 private:
  template <typename Value>
  [[nodiscard]] Rotation3 mean_of(const Value& value) const {
    Rotation3 sum = Rotation3::Zero();
    for (const ShownRotation& one : shown_) sum += value(one);
    return sum / static_cast<double>(shown_.size());
  }
  std::vector<ShownRotation> shown_;
};

// Returns the mean square about the mean that the median reference shows, in units of that of noise, at least 1.
// References do not rotate, so this is what a rolling shutter or hot air leave.
Rotation3 shown_by_references(const Site& site, const std::vector<RotationSeries>& series) {
  Rotation3 out = Rotation3::Ones();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> shown;
    for (std::size_t i = 0; i < series.size(); ++i) {
      if (site.markers[i].role == Role::kReference && series[i].frames() >= kMinFrames)
        shown.push_back(series[i].in_noise(series[i].mean())(axis));
    }
    if (shown.empty()) continue;
    const auto middle = shown.begin() + static_cast<long>(shown.size() / 2);
    std::nth_element(shown.begin(), middle, shown.end());
    out(axis) = std::max(1.0, *middle);
  }
  return out;
}

// Returns the rotation of a target, zero if it does not rotate. `least`: mean squares that prove it.
TargetRotation rotation_of(const RotationSeries& series, const Rotation3& least) {
  if (series.frames() < kMinFrames || !((series.in_noise(series.mean()) - least).maxCoeff() > 0.0)) return {};
  const Rotation3 proven = series.in_noise(Rotation3::Zero()), square = series.mean_square(), noise = series.noise();
  TargetRotation out;
  out.u_in_plane_rad = std::sqrt(noise.z());
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_removed = proven(axis) > least(axis) || noise(axis) < kHarmless * kHarmless;
    if (is_removed) out.prior_rad(axis) = kTimesRms * std::sqrt(std::max(square(axis) - noise(axis), noise(axis)));
  }
  return out;
}

// Adds the prior's rotations to the covariance of the points.
void add_prior(const RotationColumns& columns, const Rotation3& prior, PatchInformation& information) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
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

TargetRotations find_rotations(const Site& site, const Scene& scene, std::span<const BundleFrame> frames) {
  std::vector<RotationSeries> series(site.markers.size());
  for (const BundleFrame& frame : frames) {
    const FrameFit fit = fit_frame(site, scene, frame, FrameDetail::kSamples);
    for (std::size_t i = 0; fit.ok && i < series.size(); ++i) {
      const bool is_target = site.markers[i].role != Role::kReference;
      if (!frame.points[i] || !site.markers[i].grating || (is_target && fit.shift_row[i] < 0)) continue;
      const PatchResidual patch(*frame.points[i], site.markers[i]);
      series[i].add(shown_rotation(patch, fitted_design(patch, scene, frame, fit, i), {site, scene, fit, i}));
    }
  }
  for (RotationSeries& one : series) one.keep_what_fits();
  const Rotation3 least = kRotates * shown_by_references(site, series);
  TargetRotations out(series.size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (site.markers[i].role != Role::kReference) out[i] = rotation_of(series[i], least);
  }
  return std::ranges::any_of(out, &TargetRotation::rotates) ? out : TargetRotations{};
}

double RotationRemoval::remove(std::size_t marker, const BundleFrame& read, const FrameFit& fit,
                               BundleFrame& frame) const {
  const PatchFit& as_read = *read.points[marker];
  PatchFit& points = *frame.points[marker];
  points.information = as_read.information;
  Rotation3& rotation = frame.removed_rad[marker];
  const TargetView view(site_, scene_, fit, marker, centres_[marker].at);
  const PatchResidual patch(points, site_.markers[marker]);
  const KnownRotation known{rotation, rotations_[marker].prior_rad};
  const Rotation3 step = shown_rotation(patch, fitted_design(patch, scene_, frame, fit, marker), view, known).rad;
  rotation += step;
  const PatchResidual before(as_read, site_.markers[marker]);
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const Vector2d moved = view.moved_by(before, n, rotation);
    points.image[n] = {as_read.image[n].x - moved.x(), as_read.image[n].y - moved.y()};
  }
  add_prior(view.columns(PatchResidual(points, site_.markers[marker])), known.u_rad, points.information);
  return step.cwiseAbs().maxCoeff();
}

BundleFrame RotationRemoval::unrotated(const BundleFrame& read) const {
  BundleFrame out = read;
  out.removed_rad.assign(site_.markers.size(), Rotation3::Zero());
  for (int pass = 0; pass < kPasses; ++pass) {
    BundleFrame frame = out;
    frame.at_rest = false;
    frame.pose = pose_of(site_, scene_, frame).value_or(frame.pose);
    const FrameFit fit = fit_frame(site_, scene_, frame, FrameDetail::kSamples);
    if (!fit.ok) return read;
    double most = 0.0;
    for (std::size_t i = 0; i < site_.markers.size(); ++i) {
      if (fit.shift_row[i] >= 0 && rotations_[i].rotates()) most = std::max(most, remove(i, read, fit, out));
    }
    if (most < kSmall) break;
  }
  return out;
}

double RotationRemoval::u_by_centre(std::size_t marker, const BundleFrame& now, const BundleFrame& then) const {
  if (now.removed_rad.empty() || then.removed_rad.empty()) return 0.0;
  return centres_[marker].u_mm * std::abs(now.removed_rad[marker].z() - then.removed_rad[marker].z());
}

FrameSeries without_rotations(const FrameSeries& frames, std::shared_ptr<const RotationRemoval> removal) {
  if (!removal) return frames;
  return frames.with([frames, removal = std::move(removal)](std::size_t k) { return removal->unrotated(frames[k]); });
}

}  // namespace moiregauge::internal
