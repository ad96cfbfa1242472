// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/frame_fit.h"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "moiregauge/calibration/scene/patch_residual.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

struct FittedScene {
  Site site;
  Scene scene;
  BundleFrame frame;
};

// Four references around targets in a row, read with errors of a thousandth of a pitch.
FittedScene scene_with(std::size_t targets, bool is_rolling) {
  std::mt19937_64 rng(5);
  std::normal_distribution<double> normal;
  FittedScene out;
  out.scene.camera.fx = out.scene.camera.fy = 3400.0;
  out.scene.camera.cx = 2000.0, out.scene.camera.cy = 500.0, out.scene.camera.k1 = -0.03;
  const CommonNumbers camera = numbers_of(out.scene);
  out.frame.pose = {{0.02, -0.03, 0.01}, {5.0, -3.0, 1200.0}};
  for (std::size_t i = 0; i < 4 + targets; ++i) {
    const BoardPoint centre = i < 4 ? BoardPoint{i % 2 == 0 ? -300.0 : 300.0, i < 2 ? 90.0 : -90.0}
                                    : BoardPoint{-250.0 + 40.0 * static_cast<double>(i - 4), 0.0};
    Marker marker;
    marker.role = i < 4 ? Role::kReference : Role::kTarget;
    marker.grating = Grating{centre, 30.0, 30.0, 10.0, 0.0, Pattern::kGrid};
    out.site.markers.push_back(marker);
    PatchFit fit;
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      const double x = static_cast<double>(n % 3) - 1.0, y = static_cast<double>(n / 3) - 1.0;
      fit.print[n] = {x + 1e-3 * normal(rng), y + 1e-3 * normal(rng)};
      const auto image = projected(camera.data(), out.frame.pose.turn.data(),
                                   std::array<double, 3>{centre.x + 10.0 * x, centre.y + 10.0 * y, 0.0});
      fit.image[n] = {image[0], image[1]};
    }
    fit.information = 1e6 * PatchInformation::Identity();
    out.frame.points.emplace_back(fit);
    out.frame.shift.push_back({});
  }
  out.scene.markers.resize(out.site.markers.size());
  if (!is_rolling) return out;
  RowDesign rows;
  for (std::size_t i = 0; i < out.site.markers.size(); ++i)
    rows.by_marker.push_back(1e-2 * RowDesign::Columns::NullaryExpr([&] { return normal(rng); }));
  rows.information.setIdentity();
  out.frame.rows = rows;
  return out;
}

// Derivatives of all residuals at a fit: by pose, shifts and motion, by the scene, and by the readout time.
struct DenseDesign {
  Eigen::MatrixXd own, scene, readout, prior;
};

DenseDesign dense_design(const FittedScene& s, const FrameFit& fit) {
  const auto markers = static_cast<Eigen::Index>(s.site.markers.size());
  const Eigen::Index rows = PatchResidual::kSize * markers, size = fit.variance.size();
  DenseDesign d{Eigen::MatrixXd::Zero(rows, size), Eigen::MatrixXd::Zero(rows, scene_parameters(s.site.markers.size())),
                Eigen::MatrixXd::Zero(rows, 1), Eigen::MatrixXd::Zero(size, size)};
  for (std::size_t i = 0; i < s.site.markers.size(); ++i) {
    const PatchResidual patch(*s.frame.points[i], s.site.markers[i]);
    const auto design = patch.design(numbers_of(s.scene), s.scene.markers[i], TurnedPose(fit.pose), fit.shift[i]);
    const Eigen::Index row = PatchResidual::kSize * static_cast<Eigen::Index>(i);
    d.own.block<PatchResidual::kSize, 6>(row, 0) = design.middleCols<6>(PatchColumn::kPose);
    d.scene.block<PatchResidual::kSize, kCommonParameters>(row, 0) = design.leftCols<kCommonParameters>();
    d.scene.block<PatchResidual::kSize, kShapeParameters>(row, shape_row(i, 0)) =
        design.middleCols<kShapeParameters>(PatchColumn::kShape);
    if (fit.shift_row[i] >= 0) {
      d.own.block<PatchResidual::kSize, 2>(row, fit.shift_row[i]) = design.middleCols<2>(PatchColumn::kShape);
      d.prior.block<2, 2>(fit.shift_row[i], fit.shift_row[i])
          .diagonal()
          .setConstant(1.0 / (kUnknownShift * kUnknownShift));
    }
    if (!s.frame.rows) continue;
    const RowDesign::Columns by_rows = patch.root() * s.frame.rows->by_marker[i];
    d.own.block<PatchResidual::kSize, kMotionParameters>(row, size - kMotionParameters) =
        by_rows.leftCols<kMotionParameters>();
    d.readout.middleRows<PatchResidual::kSize>(row) = by_rows.col(kMotionParameters);
    d.prior.bottomRightCorner<kMotionParameters, kMotionParameters>() = s.frame.rows->information;
  }
  return d;
}

// Largest difference relative to the largest number.
double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

// Targets are eliminated one by one. The tolerance is the condition number (1e5 at most) times the rounding of doubles,
// with a margin of a thousand.
TEST(FrameFit, EqualsTheSolutionOfAllUnknownsTogether) {
  constexpr double kRounding = 1e-8;
  for (const bool is_rolling : {false, true}) {
    const FittedScene s = scene_with(3, is_rolling);
    const FrameFit fit = fit_frame(s.site, s.scene, s.frame);
    ASSERT_TRUE(fit.ok);
    const DenseDesign d = dense_design(s, fit);
    const Eigen::MatrixXd covariance = (d.own.transpose() * d.own + d.prior).inverse();
    const Eigen::MatrixXd sensitivity = -covariance * d.own.transpose() * d.scene;
    EXPECT_LT(difference(full_covariance(fit), covariance), kRounding);
    EXPECT_LT(difference(fit.variance, covariance.diagonal()), kRounding);
    EXPECT_LT(difference(full_sensitivity(fit), sensitivity), kRounding);
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(d.scene.cols(), d.scene.cols());
    add_scene_information(fit, information);
    EXPECT_LT(difference(information, d.scene.transpose() * (d.scene + d.own * sensitivity)), kRounding);
    if (!is_rolling) continue;
    EXPECT_LT(difference(fit.by_readout, -covariance * d.own.transpose() * d.readout), kRounding);
  }
}

// A grating of lines at 0.3 deg to the board's x does not show movement along them. Its own reading error of 1e-3 pitch
// is the only error left. Without the residual along the lines, the weak information of the perspective moves it by
// metres, and 0.3 deg of that appear across the lines.
TEST(FrameFit, ATargetOfLinesStaysStillAlongThem) {
  FittedScene s = scene_with(1, false);
  Marker& target = s.site.markers.back();
  target.grating->pattern = Pattern::kLinesY;
  target.grating->angle_rad = 0.3 * kPi / 180.0;
  s.frame.points.back()->information.topLeftCorner<kPatchPoints, kPatchPoints>().setZero();
  const CommonNumbers camera = numbers_of(s.scene);
  const double c = std::cos(target.grating->angle_rad), sn = std::sin(target.grating->angle_rad);
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const double x = 10.0 * (static_cast<double>(n % 3) - 1.0), y = 10.0 * (static_cast<double>(n / 3) - 1.0);
    const BoardPoint at = target.grating->centre;
    const auto image = projected(camera.data(), s.frame.pose.turn.data(),
                                 std::array<double, 3>{at.x + c * x - sn * y, at.y + sn * x + c * y + 0.7, 0.0});
    s.frame.points.back()->image[n] = {image[0], image[1]};
  }
  const FrameFit fit = fit_frame(s.site, s.scene, s.frame);
  ASSERT_TRUE(fit.ok);
  EXPECT_EQ(fit.dof, 4 * 18 + 10 - 6 - 2);
  const auto& moved = fit.shift.back();
  const double across = std::sqrt(fit.variance(fit.shift_row.back() + 1));
  EXPECT_LT(across, 0.03);  // 1e-3 pitch is 0.01 mm; the references leave as much again, at the edge of their area
  EXPECT_NEAR(moved.y, 0.7, 4.0 * across);
  EXPECT_NEAR(moved.x, 0.0, 4.0 * 10.0 * kStillAlongLines);
}

// Numbers that a fit for samples keeps.
Eigen::Index kept_numbers(const FrameFit& fit) {
  Eigen::Index sum =
      fit.variance.size() + fit.pose_sensitivity.size() + fit.pose_covariance.size() + fit.by_scene.size();
  for (const ShiftPart& part : fit.shift_parts)
    sum += part.covariance.size() + part.by_own.size() + part.by_pose.size();
  return sum + 196 * static_cast<Eigen::Index>(fit.own_scene.size());
}

TEST(FrameFit, KeepsTheSameAmountForEachFurtherTarget) {
  const auto kept = [](std::size_t targets) {
    const FittedScene s = scene_with(targets, false);
    const FrameFit fit = fit_frame(s.site, s.scene, s.frame, FrameDetail::kSamples);
    EXPECT_TRUE(fit.ok);
    return kept_numbers(fit);
  };
  const Eigen::Index first = kept(1), eleventh = kept(11), hundredth = kept(101);
  EXPECT_EQ(hundredth - eleventh, 9 * (eleventh - first));
}

}  // namespace
}  // namespace moiregauge::internal
