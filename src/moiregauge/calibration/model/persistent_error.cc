// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/persistent_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/fitted_patch.h"

namespace moiregauge::internal {
namespace {

constexpr int kSize = PatchResidual::kSize;
using Matrix18 = Eigen::Matrix<double, kSize, kSize>;
using Vector18 = Eigen::Matrix<double, kSize, 1>;
using ByScene = Eigen::Matrix<double, kSize, Eigen::Dynamic>;

constexpr double kMinFrames = 4.0;   // fewer do not separate noise from what persists; chosen
constexpr double kRounding = 1e-12;  // relative to the trace: information that is rounding only
constexpr double kPose = 6.0;        // a change that all frames share looks like a change of all poses

// Mean and scatter of the residuals of one print over the frames, mm.
struct Residuals {
  Vector18 sum = Vector18::Zero(), squares = Vector18::Zero();
  double frames = 0.0;
  double coordinates = 0.0;  // that the print shows

  void add(const Vector18& residual, int rank) {
    sum += residual;
    squares += residual.cwiseAbs2();
    frames += 1.0;
    coordinates = std::max(coordinates, static_cast<double>(rank));
  }
  // Returns the sum of the squared means, and what scatter leaves in it.
  [[nodiscard]] std::pair<double, double> of_mean() const {
    const Vector18 mean = sum / frames;
    const Vector18 scatter = (squares - frames * mean.cwiseAbs2()) / (frames - 1.0);
    return {mean.squaredNorm(), scatter.sum() / frames};
  }
};

// Returns the change of a print's whitened residual per unit of each scene parameter, with the frame's pose, motion and
// shifts following.
ByScene by_scene(const PatchResidual& patch, const PatchResidual::Design& design, const BundleFrame& frame,
                 const FrameFit& fit, std::size_t marker) {
  ByScene out = design.middleCols<6>(PatchColumn::kPose) * fit.pose_sensitivity.topRows<6>();
  if (frame.rows)
    out += patch.root() * frame.rows->by_marker[marker].leftCols<kMotionParameters>() *
           fit.pose_sensitivity.bottomRows<kMotionParameters>();
  if (fit.shift_row[marker] >= 0) out += design.middleCols<2>(PatchColumn::kShape) * shift_sensitivity(fit, marker);
  out.leftCols<kCommonParameters>() += design.leftCols<kCommonParameters>();
  out.middleCols<kShapeParameters>(shape_row(marker, 0)) += design.middleCols<kShapeParameters>(PatchColumn::kShape);
  return out;
}

// Calls `use(patch, design, frame, fit)` for every frame in which the print was read.
template <typename Use>
void for_each_reading(const Site& site, const BundleSolution& solution, std::span<const FrameFit> fits,
                      std::size_t marker, const Use& use) {
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const BundleFrame& frame = solution.frames[k];
    if (!fits[k].ok || !frame.points[marker] || !site.markers[marker].grating) continue;
    const PatchResidual patch(*frame.points[marker], site.markers[marker]);
    use(patch, fitted_design(patch, solution.scene, frame, fits[k], marker), frame, fits[k]);
  }
}

// Returns the residuals of a print over the frames, mm.
Residuals residuals_of(const Site& site, const BundleSolution& solution, std::span<const FrameFit> fits,
                       std::size_t marker) {
  Residuals out;
  if (!site.markers[marker].grating) return out;
  const double pitch_mm = site.markers[marker].grating->pitch_mm;
  for_each_reading(site, solution, fits, marker, [&](const PatchResidual& patch, const auto& design, const auto&...) {
    // Lines show one coordinate. The other one becomes zero.
    const Matrix18& root = patch.root();
    Matrix18 normal = root.transpose() * root;
    normal.diagonal().array() += kRounding * normal.trace();
    out.add(pitch_mm * normal.ldlt().solve(root.transpose() * design.col(PatchColumn::kResidual)), patch.rank());
  });
  return out;
}

constexpr int kAffine = 6;  // place, rotation, sizes and shear of a print
using Affine = Eigen::Matrix<double, kSize, kAffine>;

// Returns the changes of the nine points by an affine map of the print.
Affine affine_columns() {
  Affine out = Affine::Zero();
  for (int n = 0; n < kPatchPoints; ++n) {
    const double x = n % 3 - 1, y = std::floor(n / 3.0) - 1.0;
    out.row(n).head<3>() << 1.0, x, y;
    out.row(n + kPatchPoints).tail<3>() << 1.0, x, y;
  }
  return out;
}

// Returns the squared length of the part of `v` in the space of the columns.
double squared_along(const Affine& columns, const Vector18& v) {
  const Eigen::Matrix<double, kAffine, 1> along = columns.transpose() * v;
  const Eigen::Matrix<double, kAffine, kAffine> normal = columns.transpose() * columns;
  return along.dot(normal.ldlt().solve(along));
}

// Returns how many parameters of camera and references the frames determine.
double determined_by_references(const Site& site, std::span<const FrameFit> fits, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd known = determined(fits, covariance);
  double sum = known.head(kCommonParameters).sum();
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (site.markers[i].role == Role::kReference) sum += known.segment<kShapeParameters>(shape_row(i, 0)).sum();
  }
  return sum;
}

}  // namespace

double persistent_error_mm(const Site& site, const BundleSolution& solution, std::span<const FrameFit> fits,
                           const Eigen::MatrixXd& covariance) {
  double square = 0.0, noise = 0.0, dof = -kPose - determined_by_references(site, fits, covariance);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (site.markers[i].role != Role::kReference) continue;
    const Residuals residuals = residuals_of(site, solution, fits, i);
    if (residuals.frames < kMinFrames) continue;
    const auto [of_mean, of_noise] = residuals.of_mean();
    square += of_mean, noise += of_noise, dof += residuals.coordinates;
  }
  return dof > 0.0 ? std::sqrt(std::max(0.0, square - noise) / dof) : 0.0;
}

double chi2_dof_of_places(const Site& site, const BundleSolution& solution, std::span<const FrameFit> fits) {
  const Affine affine = affine_columns();
  double chi2 = 0.0, dof = 0.0;
  for (const FrameFit& fit : fits) {
    if (fit.ok) dof += static_cast<double>(fit.dof);
  }
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (site.markers[i].role != Role::kReference) {
      // The two are its shift.
      for_each_reading(site, solution, fits, i,
                       [&](const PatchResidual& patch, const auto&...) { dof -= patch.rank() - 2.0; });
      continue;
    }
    const Residuals residuals = residuals_of(site, solution, fits, i);
    if (residuals.frames < kMinFrames) {
      dof -= residuals.frames * residuals.coordinates;
      continue;
    }
    const Vector18 mean = residuals.sum / (site.markers[i].grating->pitch_mm * residuals.frames);
    for_each_reading(site, solution, fits, i, [&](const PatchResidual& patch, const auto& design, const auto&...) {
      const Vector18 residual = design.col(PatchColumn::kResidual);
      chi2 += squared_along(patch.root() * affine, residual - patch.root() * mean);
    });
    // Coordinates beyond an affine map are not counted, and the mean takes one of each of the rest.
    const double along = residuals.coordinates * kAffine / kSize;
    dof -= residuals.frames * (residuals.coordinates - along) + along;
  }
  return dof > 0.0 ? chi2 / dof : 0.0;
}

Eigen::MatrixXd covariance_with_persistent_errors(const Site& site, const Calibration& calibration,
                                                  const SceneModel& model) {
  const BundleSolution& solution = calibration.bundle;
  const auto covariance_of = [&](const SceneModel& of) {
    return scene_covariance(site, calibration.fits, calibration.prior, of);
  };
  const double error_mm = persistent_error_mm(site, solution, calibration.fits, covariance_of(solution.scene.model));
  const Eigen::MatrixXd covariance = covariance_of(model);
  Eigen::MatrixXd out = covariance;
  for (std::size_t i = 0; error_mm > 0.0 && i < site.markers.size(); ++i) {
    if (!site.markers[i].grating) continue;
    // Columns: each coordinate of each point, then both that all points have in common.
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(covariance.rows(), kSize + 2);
    for_each_reading(
        site, solution, calibration.fits, i,
        [&](const PatchResidual& patch, const auto& design, const BundleFrame& frame, const FrameFit& fit) {
          slope.leftCols<kSize>() += by_scene(patch, design, frame, fit, i).transpose() * patch.root();
        });
    slope.col(kSize) = slope.leftCols<kPatchPoints>().rowwise().sum();
    slope.col(kSize + 1) = slope.middleCols<kPatchPoints>(kPatchPoints).rowwise().sum();
    const Eigen::MatrixXd change = error_mm / site.markers[i].grating->pitch_mm * covariance * slope;
    out += change * change.transpose();
  }
  return out;
}

}  // namespace moiregauge::internal
