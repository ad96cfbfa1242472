// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/out_of_plane.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {
namespace {

// Standard uncertainty of a grating's size between frames beyond noise, relative: the same view, and per unit by which the
// view differs, up to 0.3. Photographs of a board from all sides showed up to 6e-4, of which half is noise. Chosen.
constexpr double kSteadySize = 2e-5, kSizeByView = 1e-3, kOtherView = 0.3;
// Largest u of a relative size that says something. Lines show one axis only.
constexpr double kShownSize = 0.02;

constexpr int kUnknowns = 5;  // shift along x and y, rotation, height, stretch
constexpr int kHeightAt = 3, kStretchAt = 4;
using Columns = Eigen::Matrix<double, PatchResidual::kSize, kUnknowns>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

double distance_of(const Pose& camera) { return camera.shift[2]; }

// Returns the difference of two views: rotation in rad and movement relative to the distance.
double difference_of(const Pose& a, const Pose& b) {
  double turned = 0.0, moved = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    turned += (a.turn[k] - b.turn[k]) * (a.turn[k] - b.turn[k]);
    moved += (a.shift[k] - b.shift[k]) * (a.shift[k] - b.shift[k]);
  }
  return std::sqrt(turned) + std::sqrt(moved) / distance_of(a);
}

std::optional<ShownHeight> shown_height(const PatchResidual::Design& design, const Pose& camera) {
  Columns columns;
  columns << design.middleCols<3>(PatchColumn::kShape), design.col(PatchColumn::kShape + MarkerShape::kHeight),
      design.col(kStretchParameter);
  const Normal normal = columns.transpose() * columns;
  const Eigen::LLT<Normal> root(normal);
  if (root.info() != Eigen::Success) return std::nullopt;
  const Unknowns step = -root.solve(columns.transpose() * design.col(PatchColumn::kResidual));
  const Normal covariance = root.solve(Normal::Identity());
  // With a fixed height the shift takes the height's column as far as it can.
  const Eigen::Vector2d taken = normal.topLeftCorner<2, 2>().ldlt().solve(normal.block<2, 1>(0, kHeightAt));
  ShownHeight out{.height_mm = step(kHeightAt),
                  .stretch = step(kStretchAt),
                  .u_height_mm = std::sqrt(covariance(kHeightAt, kHeightAt)),
                  .u_stretch = std::sqrt(covariance(kStretchAt, kStretchAt)),
                  .camera = camera,
                  .per_mm = {taken.x(), taken.y()}};
  const bool is_shown = out.u_height_mm < kShownSize * distance_of(camera) && out.u_stretch < kShownSize;
  return is_shown ? std::optional(out) : std::nullopt;
}

}  // namespace

std::vector<std::optional<ShownHeight>> shown_heights(const Site& site, const Scene& scene, const BundleFrame& frame,
                                                      const FrameFit& fit) {
  std::vector<std::optional<ShownHeight>> out(site.markers.size());
  if (!fit.ok) return out;
  const CommonNumbers camera = numbers_of(scene);
  const TurnedPose pose(fit.pose);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (fit.shift_row[i] < 0 || !frame.points[i]) continue;
    const PatchResidual patch(*frame.points[i], site.markers[i]);
    PatchResidual::Design design = patch.design(camera, scene.markers[i], pose, fit.shift[i]);
    if (frame.rows) {
      const RowDesign::Columns rows = patch.root() * frame.rows->by_marker[i];
      design.col(PatchColumn::kResidual) += rows.leftCols<kMotionParameters>() * fit.motion;
    }
    out[i] = shown_height(design, fit.pose);
  }
  return out;
}

OutOfPlane out_of_plane(const ShownHeight& now, const ShownHeight& then) {
  const double height_mm = now.height_mm - then.height_mm;
  const double distance_mm = distance_of(now.camera);
  const double u_size = kSteadySize + kSizeByView * std::min(kOtherView, difference_of(now.camera, then.camera));
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

}  // namespace moiregauge::internal
