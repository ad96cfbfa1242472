// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/locking_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

namespace moiregauge::internal {
namespace {

// Frames from which the change of the residuals is estimated, evenly spread. Chosen.
constexpr std::size_t kMaxExamined = 200;
constexpr double kMinExamined = 10.0;
// Smallest change of the residuals' variance over half a pixel that counts: in its own u, and relative to the variance
// in the reference frame. Footage without processing has up to 0.01 of the latter.
constexpr double kSureOfChange = 3.0;
constexpr double kMinChange = 0.02;
// Smallest range of sin^2(pi d) from which a change is extrapolated to half a pixel. Chosen.
constexpr double kMinRange = 0.1;
// Share of the residual that pulls the grating, at most 1. Histogram equalisation and smart blur have 0.6 to 0.9, median
// filters 0.15.
constexpr double kPull = 0.8;
// Amplitude relative to the noise of a shift, from which a warning appears. Chosen.
constexpr double kNoteworthy = 3.0;

constexpr std::size_t kAxes = 2;

// Returns sin^2(pi d) for a movement by d px, summed over both axes.
double off_phase(const PixelPhase& now, const PixelPhase& then) {
  return 0.25 * (std::norm(now[0] - then[0]) + std::norm(now[1] - then[1]));
}

// Straight line through (x, y) by least squares.
class Line {
 public:
  void add(double x, double y) {
    n_ += 1.0, x_ += x, y_ += y, xx_ += x * x, xy_ += x * y, yy_ += y * y;
    lowest_ = std::min(lowest_, x), highest_ = std::max(highest_, x);
  }
  [[nodiscard]] double count() const { return n_; }
  // Returns the range of x.
  [[nodiscard]] double range() const { return highest_ - lowest_; }
  [[nodiscard]] double slope() const { return spread() > 0.0 ? (xy_ - x_ * y_ / n_) / spread() : 0.0; }
  [[nodiscard]] double u_slope() const {
    const double left = yy_ - y_ * y_ / n_ - slope() * slope() * spread();
    return spread() > 0.0 ? std::sqrt(std::max(0.0, left) / (n_ - 2.0) / spread()) : 0.0;
  }

 private:
  [[nodiscard]] double spread() const { return xx_ - x_ * x_ / n_; }
  double lowest_ = std::numeric_limits<double>::infinity(), highest_ = -lowest_;
  double n_ = 0.0, x_ = 0.0, y_ = 0.0, xx_ = 0.0, xy_ = 0.0, yy_ = 0.0;
};

// Returns the rms amplitude of the folded harmonics, grey levels of the template. A movement by half a pixel adds four
// times its square to the variance of the residuals.
double folded_level(const Line& variance, double variance_at_rest) {
  if (variance.count() < kMinExamined || variance.range() < kMinRange) return 0.0;
  const double change = variance.slope();
  if (!(change > kSureOfChange * variance.u_slope()) || !(change > kMinChange * variance_at_rest)) return 0.0;
  return std::sqrt(0.25 * change);
}

double square(double v) { return v * v; }

// Returns (C + V)^-1, with V the variance of a common shift of the nine points along each axis.
PatchInformation with_common(const PatchInformation& information, const std::array<double, kAxes>& u) {
  using Columns = Eigen::Matrix<double, 2 * kPatchPoints, 2>;
  Columns shift = Columns::Zero();
  shift.col(0).head<kPatchPoints>().setConstant(u[0]);
  shift.col(1).tail<kPatchPoints>().setConstant(u[1]);
  const Columns by_shift = information * shift;
  const Eigen::Matrix2d own = Eigen::Matrix2d::Identity() + shift.transpose() * by_shift;
  const PatchInformation out = information - by_shift * own.inverse() * by_shift.transpose();
  return 0.5 * (out + out.transpose());
}

// Returns the noise of a common shift along an axis, pitches.
double u_of_common_shift(const PatchInformation& information, std::size_t axis) {
  const auto at = static_cast<Eigen::Index>(axis * kPatchPoints);
  const double weight = information.block<kPatchPoints, kPatchPoints>(at, at).sum();
  return weight > 0.0 ? 1.0 / std::sqrt(weight) : std::numeric_limits<double>::infinity();
}

}  // namespace

LockingError::LockingError(const Reference& reference, const FrameSeries& frames)
    : reference_(reference), markers_(reference.site.markers.size()) {
  const auto print_of = [&](std::size_t i) -> const PrintModel* {
    const bool has_both = i < reference.prints.size() && reference.prints[i] && reference.seen.markers[i].points;
    return has_both ? &*reference.prints[i] : nullptr;
  };
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    if (print_of(i) == nullptr) continue;
    const PatchFit& at_rest = *reference.seen.markers[i].points;
    markers_[i] = {expected_locking(*print_of(i), at_rest), pixel_phase(at_rest, print_of(i)->window)};
  }
  std::vector<Line> variance(markers_.size());
  const std::size_t step = frames.size() / kMaxExamined + 1;
  for (std::size_t k = 1; k < frames.size(); k += step) {
    const BundleFrame frame = frames[k];
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      if (!frame.points[i] || print_of(i) == nullptr) continue;
      const PatchFit& fit = *frame.points[i];
      variance[i].add(off_phase(pixel_phase(fit, print_of(i)->window), markers_[i].at_rest),
                      square(fit.sigma / fit.gain[0]));
    }
  }
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    if (print_of(i) == nullptr) continue;
    const PatchFit& at_rest = *reference.seen.markers[i].points;
    const double level = folded_level(variance[i], square(at_rest.sigma / at_rest.gain[0]));
    const PrintTemplate& print = print_of(i)->print;
    const std::array<double, kAxes> slope{std::sqrt(print.slope_power_x()), std::sqrt(print.slope_power_y())};
    const PatchFitOptions& shown = print_of(i)->options;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      double& amplitude = markers_[i].amplitude[axis];
      if (axis == 0 ? shown.along_x : shown.along_y) amplitude = std::hypot(amplitude, kPull * level / slope[axis]);
    }
  }
}

bool LockingError::is_zero() const {
  return std::all_of(markers_.begin(), markers_.end(),
                     [](const OfMarker& m) { return m.amplitude == LockingAmplitude{}; });
}

BundleFrame LockingError::with_error(BundleFrame frame) const {
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    if (!frame.points[i] || markers_[i].amplitude == LockingAmplitude{}) continue;
    const PixelPhase now = pixel_phase(*frame.points[i], reference_.prints[i]->window);
    std::array<double, kAxes> u{};
    // The error is A times the imaginary part of the change of phase, turned by an unknown angle.
    for (std::size_t axis = 0; axis < kAxes; ++axis)
      u[axis] = markers_[i].amplitude[axis] * std::abs(now[axis] - markers_[i].at_rest[axis]) / std::sqrt(2.0);
    frame.points[i]->information = with_common(frame.points[i]->information, u);
  }
  return frame;
}

std::optional<std::string> LockingError::note() const {
  const Marker* worst = nullptr;
  double most_mm = 0.0;
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    const Marker& marker = reference_.site.markers[i];
    if (marker.role != Role::kTarget || !marker.grating || !reference_.seen.markers[i].points) continue;
    const PatchInformation& information = reference_.seen.markers[i].points->information;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const double together = std::abs(markers_[i].at_rest[axis]);
      const double amplitude = markers_[i].amplitude[axis] * together;
      if (amplitude < kNoteworthy * u_of_common_shift(information, axis)) continue;
      const double mm = amplitude * marker.grating->pitch_mm;
      if (mm > most_mm) worst = &marker, most_mm = mm;
    }
  }
  if (worst == nullptr) return std::nullopt;
  return fmt::format(
      "the u of '{:.60}' contains an error of {:.1f} um that repeats with every pixel of movement, because its edges "
      "are sharper than the pixels or processed in the camera. Turn the camera or the print by 2 deg, defocus "
      "slightly, or switch median filters, sharpening and contrast enhancement off",
      worst->name, 1e3 * most_mm);
}

FrameSeries with_locking_error(const FrameSeries& frames, std::shared_ptr<const LockingError> error) {
  if (error->is_zero()) return frames;
  return frames.with([frames, error = std::move(error)](std::size_t k) { return error->with_error(frames[k]); });
}

}  // namespace moiregauge::internal
