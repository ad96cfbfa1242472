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

void HeightScatter::add(const ShownHeight& shown) {
  if (!first_) first_ = shown;
  const double to_mm = 0.5 * distance_of(shown.camera);
  const double u_mm =
      std::hypot(shown.u_height_mm, to_mm * shown.u_stretch, distance_of(shown.camera) * u_of_size(shown, *first_));
  const double weight = 1.0 / (u_mm * u_mm);
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const double side = axis == 0 ? to_mm : -to_mm;
    const double height_mm = shown.height_mm - first_->height_mm + side * (shown.stretch - first_->stretch);
    Sums& sums = axes_[axis];
    sums.weight += weight, sums.first += weight * height_mm, sums.second += weight * height_mm * height_mm;
  }
  ++frames_;
}

double HeightScatter::mean_square() const {
  constexpr long kMinFrames = 10;  // chosen
  if (frames_ < kMinFrames) return 0.0;
  const auto of = [this](const Sums& sums) {
    return (sums.second - sums.first * sums.first / sums.weight) / static_cast<double>(frames_ - 1);
  };
  return std::min(of(axes_[0]), of(axes_[1]));
}

}  // namespace moiregauge::internal
