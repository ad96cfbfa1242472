// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/bundle_normal.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "moiregauge/calibration/scene/frame_steps.h"
#include "moiregauge/calibration/scene/small_products.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kFrames = 3, kMarkers = 4;  // the last one is a target
constexpr int kScene = kCommonParameters + kShapeParameters * static_cast<int>(kMarkers);
constexpr int kOfFrame = 8;  // pose, shift

struct NormalCase {
  std::vector<BundlePatch> patches;
  std::vector<SceneParameter> free;
  BundleState at;
};

// Four gratings from three poses, with reading errors of a thousandth of a pitch.
NormalCase footage() {
  std::mt19937_64 rng(11);
  std::normal_distribution<double> normal;
  NormalCase f;
  f.at.common = {3400.0, 2000.0, 500.0, -0.03, 0.01, 1e-4, -2e-4, 0.0};
  f.at.markers.resize(kMarkers);
  for (std::size_t k = 0; k < kFrames; ++k) {
    const auto d = static_cast<double>(k);
    f.at.poses.push_back({{0.02 * d, -0.03 + 0.01 * d, 0.01}, {5.0 * d, -3.0, 1200.0 + 8.0 * d}});
    f.at.shifts.emplace_back(kMarkers);
    for (std::size_t i = 0; i < kMarkers; ++i) {
      const BoardPoint centre{i % 2 == 0 ? -300.0 : 300.0, i < 2 ? 30.0 : -30.0};
      PatchFit fit;
      for (std::size_t n = 0; n < kPatchPoints; ++n) {
        const double x = static_cast<double>(n % 3) - 1.0, y = static_cast<double>(n / 3) - 1.0;
        fit.print[n] = {x + 1e-3 * normal(rng), y + 1e-3 * normal(rng)};
        const auto image = projected(f.at.common.data(), f.at.poses[k].turn.data(),
                                     std::array<double, 3>{centre.x + 10.0 * x, centre.y + 10.0 * y, 0.0});
        fit.image[n] = {image[0], image[1]};
      }
      fit.information = 1e6 * PatchInformation::Identity();
      Marker marker;
      marker.grating = Grating{centre, 30.0, 30.0, 10.0, 0.0, Pattern::kGrid};
      f.patches.push_back({k, i, i + 1 == kMarkers, PatchResidual(fit, marker)});
    }
  }
  for (int index = 0; index < kScene; ++index) {
    const bool place_of_target = index == kScene - kShapeParameters || index == kScene - kShapeParameters + 1;
    const bool is_free = index != 7 && !place_of_target;
    const double unit = index == 0 ? 100.0 : index < 3 ? 10.0 : index < kCommonParameters ? 0.01 : 0.1;
    if (is_free) f.free.push_back({index, parameter(f.at, index) + 0.1 * unit, unit});
  }
  return f;
}

// Returns the Gauss-Newton step of all unknowns together: scene, then pose and shift of every frame.
Eigen::VectorXd dense_step(const NormalCase& f) {
  const Eigen::Index size = kScene + kOfFrame * static_cast<Eigen::Index>(kFrames);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  for (const BundlePatch& p : f.patches) {
    const auto design = p.residual.design(f.at.common, f.at.markers[p.marker], TurnedPose(f.at.poses[p.frame]), {});
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(PatchResidual::kSize, size);
    j.leftCols<kCommonParameters>() = design.leftCols<kCommonParameters>();
    j.middleCols<kShapeParameters>(shape_row(p.marker, 0)) = design.middleCols<kShapeParameters>(PatchColumn::kShape);
    const Eigen::Index own = kScene + kOfFrame * static_cast<Eigen::Index>(p.frame);
    j.middleCols<6>(own) = design.middleCols<6>(PatchColumn::kPose);
    if (p.shifts) j.middleCols<2>(own + 6) = design.middleCols<2>(PatchColumn::kShape);
    normal += j.transpose() * j;
    right -= j.transpose() * design.col(PatchColumn::kResidual);
  }
  BundleState at = f.at;
  std::vector<bool> is_free(kScene, false);
  for (const SceneParameter& p : f.free) {
    normal(p.index, p.index) += 1.0 / (p.u * p.u);
    right(p.index) -= (parameter(at, p.index) - p.mean) / (p.u * p.u);
    is_free[static_cast<std::size_t>(p.index)] = true;
  }
  for (int k = 0; k < kScene; ++k) {
    if (is_free[static_cast<std::size_t>(k)]) continue;
    normal.row(k).setZero();
    normal.col(k).setZero();
    normal(k, k) = 1.0;
    right(k) = 0.0;
  }
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  return scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(right)));
}

TEST(BundleNormal, EliminationGivesTheStepOfAllUnknowns) {
  const NormalCase f = footage();
  const Eigen::VectorXd dense = dense_step(f);
  auto step = BundleNormal(f.patches, f.free, f.at).step(0.0);
  ASSERT_TRUE(step);
  BundleState at = f.at;
  const double log_f = dense(0) / f.at.common[0];  // steps scale with f: a second-order difference
  for (const SceneParameter& p : f.free) {
    const double moved = parameter(step->to, p.index) - parameter(at, p.index);
    EXPECT_NEAR(
        moved, dense(p.index),
        1e-6 * p.u + 10.0 * std::abs(log_f * dense(p.index)) + 20.0 * log_f * log_f * std::abs(parameter(at, p.index)))
        << "parameter " << p.index;
  }
  for (std::size_t k = 0; k < kFrames; ++k) {
    const Eigen::Index own = kScene + kOfFrame * static_cast<Eigen::Index>(k);
    EXPECT_NEAR(step->to.poses[k].shift[0] - at.poses[k].shift[0], dense(own + 3), 1e-6);
    EXPECT_NEAR(step->to.shifts[k].back().x, dense(own + 6), 1e-6);
    EXPECT_NEAR(step->to.shifts[k].back().y, dense(own + 7), 1e-6);
  }
}

TEST(BundleNormal, AStepGainsWhatItPredicts) {
  const NormalCase f = footage();
  const auto cost = [&](BundleState& at) {
    double sum = 0.0;
    for (const BundlePatch& p : f.patches) sum += p.chi2(at, TurnedPose(at.poses[p.frame]));
    for (const SceneParameter& p : f.free) sum += std::pow((parameter(at, p.index) - p.mean) / p.u, 2);
    return sum;
  };
  BundleState at = f.at;
  auto step = BundleNormal(f.patches, f.free, f.at).step(0.0);
  ASSERT_TRUE(step);
  const double gained = cost(at) - cost(step->to);
  EXPECT_GT(gained, 10.0);
  EXPECT_NEAR(gained, step->gain, 0.05 * gained);
}

// Poses and shifts of two states differ by rounding only: by 1e-9 of the step from `at`.
void expect_alike(const BundleState& at, const BundleState& a, const BundleState& b) {
  for (std::size_t k = 0; k < kFrames; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(a.poses[k].turn[i], b.poses[k].turn[i], 1e-9);
      EXPECT_NEAR(a.poses[k].shift[i], b.poses[k].shift[i], 1e-9 * (1.0 + std::abs(at.poses[k].shift[i])));
    }
    EXPECT_NEAR(a.shifts[k].back().x, b.shifts[k].back().x, 1e-9);
    EXPECT_NEAR(a.shifts[k].back().y, b.shifts[k].back().y, 1e-9);
    if (!a.motions.empty()) {
      EXPECT_LT((a.motions[k] - b.motions[k]).norm(), 1e-9);
    }
    EXPECT_NE(a.poses[k].shift[2], at.poses[k].shift[2]);
  }
}

TEST(BundleNormal, FramesWithAFixedSceneStepAsInAllUnknowns) {
  const NormalCase f = footage();
  const auto together = BundleNormal(f.patches, {}, f.at).step(0.0);
  const auto alone = step_of_frames(f.patches, f.at);
  ASSERT_TRUE(together && alone);
  expect_alike(f.at, together->to, *alone);
}

TEST(BundleNormal, RollingFramesWithAFixedSceneStepAsInAllUnknowns) {
  NormalCase f = footage();
  std::mt19937_64 rng(12);
  std::normal_distribution<double> normal;
  for (BundlePatch& patch : f.patches) {
    BundlePatch::Rows rows;
    rows.by_motion = rows.by_motion.NullaryExpr([&] { return normal(rng); });
    rows.information.setIdentity();
    patch.rows = std::make_shared<const BundlePatch::Rows>(rows);
  }
  f.at.motions.assign(kFrames, Motion::Constant(0.1));
  const auto together = BundleNormal(f.patches, {}, f.at).step(0.0);
  const auto alone = step_of_frames(f.patches, f.at);
  ASSERT_TRUE(together && alone);
  expect_alike(f.at, together->to, *alone);
}

TEST(SmallProducts, AreThoseOfEigen) {
  const Eigen::Matrix<double, 18, 23> a = Eigen::Matrix<double, 18, 23>::Random();
  const Eigen::Matrix<double, 18, 12> b = Eigen::Matrix<double, 18, 12>::Random();
  // 18 products of at most 1 each round by 2e-16.
  EXPECT_LT((normal_matrix(a) - a.transpose() * a).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((product_of_columns(a, b) - a.transpose() * b).cwiseAbs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace moiregauge::internal
