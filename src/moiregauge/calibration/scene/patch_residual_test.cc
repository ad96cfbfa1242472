// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/patch_residual.h"

#include <random>

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr int kSize = PatchResidual::kSize;
using Autodiff = ceres::AutoDiffCostFunction<PatchResidual, kSize, kCommonParameters, MarkerShape::kParameters, 6, 2>;
template <int kColumns>
using RowMajor = Eigen::Matrix<double, kSize, kColumns, Eigen::RowMajor>;

Marker marker_of(Pattern pattern) {
  Marker marker;
  marker.role = Role::kTarget;
  marker.grating = Grating{{120.0, -35.0}, 40.0, 40.0, 10.0, 0.05, pattern};
  return marker;
}
const CommonNumbers kCommon{3478.0, 2059.0, 494.0, -0.04, 0.01, 4e-4, -3e-4, 2e-3, 0.01};
const MarkerShape kSomeShape{{0.3, -0.2, 0.004, 6e-4, 2.0, 0.02, -0.03}};
const Extent<frame::Board> kShift{0.7, -1.1};

// Nine points near the position where the camera sees the grating. The information matrix has this rank.
PatchFit patch(int rank) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  PatchFit fit;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const double x = static_cast<double>(n % 3) - 1.0, y = static_cast<double>(n / 3) - 1.0;
    fit.print[n] = {1.3 * x, 1.3 * y};
    fit.image[n] = {2400.0 + 38.0 * x + 2.0 * y + normal(rng), 590.0 - 37.0 * y + x + normal(rng)};
  }
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(rank, kSize);
  for (double& value : root.reshaped()) value = 1e3 * normal(rng);
  fit.information = root.transpose() * root;
  return fit;
}

void expect_derivatives_of_ceres(Pattern pattern, int rank) {
  for (const double angle : {0.0, 1e-9, 0.02, 0.099, 0.101, 0.8}) {
    const Pose pose{{0.6 * angle, -0.75 * angle, 0.28 * angle}, {4.0, -7.0, 1200.0}};
    const PatchResidual residual(patch(rank), marker_of(pattern));
    const auto design = residual.design(kCommon, kSomeShape, TurnedPose(pose), kShift);
    const std::array<double, 6> place{pose.turn[0], pose.turn[1], pose.turn[2], 4.0, -7.0, 1200.0};
    const std::array<double, 2> moved{kShift.x, kShift.y};
    const double* blocks[]{kCommon.data(), kSomeShape.value.data(), place.data(), moved.data()};
    PatchResidual::Vector value;
    RowMajor<kCommonParameters> by_common;
    RowMajor<MarkerShape::kParameters> by_shape;
    RowMajor<6> by_pose;
    RowMajor<2> by_shift;
    double* jacobians[]{by_common.data(), by_shape.data(), by_pose.data(), by_shift.data()};
    ASSERT_TRUE(Autodiff(new PatchResidual(residual)).Evaluate(blocks, value.data(), jacobians));
    const auto expect_equal = [&](const auto& expected, int first) {
      for (Eigen::Index k = 0; k < expected.cols(); ++k) {
        const PatchResidual::Vector off = design.col(first + k) - expected.col(k);
        EXPECT_LT(off.norm(), 1e-7 * expected.col(k).norm()) << "column " << first + k << ", angle " << angle;
      }
    };
    expect_equal(value, PatchColumn::kResidual);
    expect_equal(by_common, PatchColumn::kCommon);
    expect_equal(by_shape, PatchColumn::kShape);
    expect_equal(by_shift, PatchColumn::kShape);
    expect_equal(by_pose, PatchColumn::kPose);
    EXPECT_LT((residual.residual(kCommon, kSomeShape, TurnedPose(pose), kShift) - value).norm(), 1e-9 * value.norm());
  }
}

TEST(PatchResidual, HasTheDerivativesThatCeresFinds) {
  expect_derivatives_of_ceres(Pattern::kGrid, kSize);
  expect_derivatives_of_ceres(Pattern::kLinesX, kPatchPoints);
  expect_derivatives_of_ceres(Pattern::kLinesY, kPatchPoints);
}

TEST(PatchResidual, TheRootFitsInformationOfAnyRank) {
  for (const int rank : {0, 3, 9, kSize}) {
    const PatchFit fit = patch(rank);
    const PatchResidual residual(fit, marker_of(Pattern::kGrid));
    EXPECT_EQ(residual.rank(), rank);
    const auto& root = residual.root();
    EXPECT_LE((root.transpose() * root - fit.information).norm(), 1e-9 * fit.information.norm()) << "rank " << rank;
  }
}

}  // namespace
}  // namespace moiregauge::internal
