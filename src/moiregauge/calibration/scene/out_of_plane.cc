// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/out_of_plane.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/fitted_patch.h"

namespace moiregauge::internal {
namespace {

// Standard uncertainty of a grating's size between frames beyond noise, relative: the same view, and per unit by which
// the view differs, up to 0.3. Photographs of a board from all sides showed up to 6e-4, of which half is noise. Chosen.
constexpr double kSteadySize = 2e-5, kSizeByView = 1e-3, kOtherView = 0.3;
// Largest u of a relative size that says something. Lines show one axis only.
constexpr double kShownSize = 0.02;

// Mean square of heights, in units of u^2, that proves a movement out of the plane. Noise in ten frames exceeds 4 once in
// 30 000 runs. Chosen.
constexpr double kScatters = 4.0;
// Variance of heights relative to that of their steps, which proves a slow movement. 260 targets that stayed in their
// plane had at most 2.1, behind codecs, too. Chosen.
constexpr double kDrifts = 2.3;
constexpr double kSurely = 3.0;      // standard deviations; both axes must show it. Chosen
constexpr double kBeyondView = 4.0;  // least variance of a slow movement, in u^2 by the change of view; chosen

constexpr int kUnknowns = 5;  // shift along x and y, rotation, height, stretch
constexpr int kHeightAt = 3, kStretchAt = 4;
using Columns = Eigen::Matrix<double, PatchResidual::kSize, kUnknowns>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

double distance_of(const Pose& camera) { return camera.shift[2]; }

double u_of_size(const ShownHeight& a, const ShownHeight& b) {
  return u_of_size(a.camera, b.camera, a.rotation_rad - b.rotation_rad);
}

// `rotation_rad`: that was removed from a target that rotates, otherwise zero. A tilt stretches it, too, so its stretch
// is not fitted. The covariance of its points has the tilt.
std::optional<ShownHeight> shown_height(const PatchResidual::Design& design, const Pose& camera,
                                        const Eigen::Vector3d& rotation_rad) {
  const bool rotates = !rotation_rad.isZero(0.0);
  Columns columns;
  columns << design.middleCols<3>(PatchColumn::kShape), design.col(PatchColumn::kShape + MarkerShape::kHeight),
      design.col(kStretchParameter);
  if (rotates) columns.col(kStretchAt).setZero();
  Normal normal = columns.transpose() * columns;
  if (rotates) normal(kStretchAt, kStretchAt) = 1.0;
  const Eigen::LLT<Normal> root(normal);
  if (root.info() != Eigen::Success) return std::nullopt;
  const Unknowns step = -root.solve(columns.transpose() * design.col(PatchColumn::kResidual));
  const Normal covariance = root.solve(Normal::Identity());
  // With a fixed height the shift takes the height's column as far as it can.
  const Eigen::Vector2d taken = normal.topLeftCorner<2, 2>().ldlt().solve(normal.block<2, 1>(0, kHeightAt));
  ShownHeight out{.height_mm = step(kHeightAt),
                  .stretch = step(kStretchAt),
                  .u_height_mm = std::sqrt(covariance(kHeightAt, kHeightAt)),
                  .u_stretch = rotates ? 0.0 : std::sqrt(covariance(kStretchAt, kStretchAt)),
                  .camera = camera,
                  .rotation_rad = rotation_rad,
                  .per_mm = {taken.x(), taken.y()}};
  const bool is_shown = out.u_height_mm < kShownSize * distance_of(camera) && out.u_stretch < kShownSize;
  return is_shown ? std::optional(out) : std::nullopt;
}

}  // namespace

double u_of_size(const Pose& now, const Pose& then, const Eigen::Vector3d& turned_rad) {
  double turned = 0.0, moved = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    turned += std::pow(now.turn[k] - then.turn[k], 2);
    moved += std::pow(now.shift[k] - then.shift[k], 2);
  }
  const double difference = std::sqrt(turned) + turned_rad.norm() + std::sqrt(moved) / distance_of(now);
  return kSteadySize + kSizeByView * std::min(kOtherView, difference);
}

std::vector<std::optional<ShownHeight>> shown_heights(const Site& site, const Scene& scene, const BundleFrame& frame,
                                                      const FrameFit& fit) {
  std::vector<std::optional<ShownHeight>> out(site.markers.size());
  if (!fit.ok) return out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (fit.shift_row[i] < 0 || !frame.points[i]) continue;
    const PatchResidual patch(*frame.points[i], site.markers[i]);
    out[i] =
        shown_height(fitted_design(patch, scene, frame, fit, i), fit.pose,
                     frame.removed.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(frame.removed[i].tail<3>()));
  }
  return out;
}

OutOfPlane out_of_plane(const ShownHeight& now, const ShownHeight& then) {
  const double height_mm = now.height_mm - then.height_mm;
  const double distance_mm = distance_of(now.camera);
  const double u_size = u_of_size(now, then);
  const double u_mm = std::hypot(now.u_height_mm, then.u_height_mm, u_size * distance_mm);
  // One axis may be stretched, by half of it more than the mean. The height that the other one shows counts.
  const double to_mm = 0.5 * distance_mm;
  const double both_mm = std::abs(height_mm) - to_mm * std::abs(now.stretch - then.stretch);
  const double u_both_mm = std::hypot(u_mm, to_mm * std::hypot(now.u_stretch, then.u_stretch));
  return {height_mm,
          u_mm,
          std::min(std::abs(height_mm) / u_mm, both_mm / u_both_mm),
          {now.height_mm * now.per_mm.x - then.height_mm * then.per_mm.x,
           now.height_mm * now.per_mm.y - then.height_mm * then.per_mm.y}};
}

void HeightSeries::add(const ShownHeight& shown) {
  if (!first_) first_ = shown;
  const double to_mm = 0.5 * distance_of(shown.camera);
  const double u_view_mm = distance_of(shown.camera) * u_of_size(shown, *first_);
  const double u_mm = std::hypot(shown.u_height_mm, to_mm * shown.u_stretch, u_view_mm);
  const double weight = 1.0 / (u_mm * u_mm);
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    const double side = k == 0 ? to_mm : -to_mm;
    const double height_mm = shown.height_mm - first_->height_mm + side * (shown.stretch - first_->stretch);
    Axis& axis = axes_[k];
    axis.weight += weight, axis.first += weight * height_mm, axis.second += weight * height_mm * height_mm;
    axis.sum += height_mm, axis.squares += height_mm * height_mm;
    if (frames_ > 0) axis.steps += std::pow(height_mm - axis.last, 2);
    axis.last = height_mm;
  }
  u_view_mm_ = std::max(u_view_mm_, u_view_mm);
  ++frames_;
}

// Returns true if the heights differ from their mean by more than noise.
bool HeightSeries::Axis::scatters(double frames) const {
  return second - first * first / weight > kScatters * (frames - 1.0);
}

// Returns true if the variance exceeds that of the steps between frames by more than chance, and by more than `u_mm`
// explains. Source: J. von Neumann, Ann. Math. Stat. 12 (1941) 367. For white noise the ratio of the second variance to
// the first is 1, with a standard deviation of 1 / sqrt(frames).
bool HeightSeries::Axis::drifts(double frames, double u_mm) const {
  const double variance = (squares - sum * sum / frames) / (frames - 1.0);
  const double of_steps = 0.5 * steps / (frames - 1.0);
  const double largest = std::min(1.0 / kDrifts, 1.0 - kSurely / std::sqrt(frames));
  return of_steps < largest * variance && variance - of_steps > kBeyondView * u_mm * u_mm;
}

bool HeightSeries::scatters() const {
  const auto frames = static_cast<double>(frames_);
  return frames_ >= kMinFrames &&
         std::ranges::all_of(axes_, [frames](const Axis& axis) { return axis.scatters(frames); });
}

bool HeightSeries::drifts() const {
  const auto frames = static_cast<double>(frames_);
  return frames_ >= kMinFrames &&
         std::ranges::all_of(axes_, [&](const Axis& axis) { return axis.drifts(frames, u_view_mm_); });
}

}  // namespace moiregauge::internal
