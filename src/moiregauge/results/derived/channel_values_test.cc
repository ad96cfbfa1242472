// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/channel_values.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/results/derived/channel_parser.h"

namespace moiregauge::internal {
namespace {

constexpr double kNoise_mm = 0.001, kShared_mm = 0.01, kPosition_mm = 1.0;

// Two frames of three targets on a line, 100 mm apart. All displacements share one factor of kShared_mm; each has its
// own noise in the second frame. The first frame is the reference frame.
struct TwoFrames {
  Samples samples;
  JointErrors joint;
  explicit TwoFrames(const std::vector<Extent<frame::Board>>& moved) {
    joint.targets = {4, 5, 6};
    joint.positions = {{-100.0, 20.0}, {0.0, 20.0}, {100.0, 20.0}};
    joint.u_position_mm = kPosition_mm;
    joint.constant = Eigen::MatrixXd::Constant(9, 1, kShared_mm);
    for (const long frame : {0L, 1L}) {
      for (std::size_t t = 0; t < 3; ++t) {
        Sample sample;
        sample.frame = frame;
        sample.marker = joint.targets[t];
        sample.displacement = frame == 0 ? Extent<frame::Board>{0.0, 0.0} : moved[t];
        sample.status = Status::kOk;
        samples.push_back(sample);
      }
      FrameErrors errors;
      errors.rotation_rad = Eigen::VectorXd::Zero(3);
      errors.noise = frame == 0 ? Eigen::MatrixXd(Eigen::MatrixXd::Zero(9, 9))
                                : Eigen::MatrixXd(kNoise_mm * kNoise_mm * Eigen::MatrixXd::Identity(9, 9));
      errors.varying = Eigen::MatrixXd::Zero(9, 1);
      errors.constant_share = frame == 0 ? 0.0 : 1.0;
      joint.frames.push_back(errors);
    }
  }
  [[nodiscard]] ChannelSeries of(const std::string& expression) const {
    const std::vector<std::string> names{"a", "b", "c"};
    return *channel_values(*parse_channel("x [1] = " + expression, names, {}), samples, joint);
  }
};

TEST(ChannelValues, ADifferenceLosesWhatItsTargetsShare) {
  const TwoFrames run({{0.0, 0.3}, {0.0, 0.5}, {0.0, 0.0}});
  const auto one = run.of("b.dy"), difference = run.of("b.dy - a.dy"), sum = run.of("b.dy + a.dy");
  EXPECT_NEAR(difference.value(1), 0.2, 1e-15);
  EXPECT_NEAR(one.u(1), std::hypot(kNoise_mm, kShared_mm), 1e-12);
  EXPECT_NEAR(difference.u(1), std::sqrt(2.0) * kNoise_mm, 1e-12);
  EXPECT_NEAR(sum.u(1), std::hypot(std::sqrt(2.0) * kNoise_mm, 2.0 * kShared_mm), 1e-12);
  EXPECT_EQ(difference.u(0), 0.0);
}

TEST(ChannelValues, ARigidRotationIsFoundByTheLineAndLeavesNoStrain) {
  constexpr double kAngle = 0.01;  // rad
  std::vector<Extent<frame::Board>> moved;
  for (const double x : {-100.0, 0.0, 100.0}) {
    const double y = 20.0;
    moved.push_back({x * std::cos(kAngle) - y * std::sin(kAngle) - x, x * std::sin(kAngle) + y * std::cos(kAngle) - y});
  }
  const TwoFrames run(moved);
  for (const char* line : {"rotation(a, c)", "rotation(a, b, c)", "rotation(c, a)"})
    EXPECT_NEAR(run.of(line).value(1), 1e3 * kAngle, 1e-10) << line;
  EXPECT_NEAR(run.of("strain(a, c)").value(1), 0.0, 1e-9);
  EXPECT_NEAR(run.of("chord(a, c)").value(1), 0.0, 1e-12);
  EXPECT_NEAR(run.of("sag(a, b, c)").value(1), 0.0, 1e-12);
}

TEST(ChannelValues, StrainIsTheRelativeChangeOfLength) {
  const TwoFrames run({{-0.05, 0.0}, {0.0, 0.0}, {0.05, 0.0}});
  const auto strain = run.of("strain(a, c)");
  EXPECT_NEAR(strain.value(1), 500.0, 1e-9);
  // Noise of both ends over 200 mm, and 500 um/m of a length that is known to sqrt(2) mm.
  const double u_length = 500.0 * std::sqrt(2.0) * kPosition_mm / 200.0;
  EXPECT_NEAR(strain.u(1), std::hypot(1e6 * std::sqrt(2.0) * kNoise_mm / 200.0, u_length), 1e-9);
}

TEST(ChannelValues, ASagIsPositiveUpForALineToTheRight) {
  const TwoFrames run({{0.0, 0.1}, {0.0, 0.5}, {0.0, 0.3}});
  EXPECT_NEAR(run.of("sag(a, b, c)").value(1), 0.3, 1e-12);
  EXPECT_NEAR(run.of("sag(a, b, c) - (b.dy - (a.dy + c.dy) / 2)").value(1), 0.0, 1e-12);
  EXPECT_NEAR(run.of("sag(c, b, a)").value(1), -0.3, 1e-12);
}

// The derivatives by positions and displacements are those of the values, by central differences.
TEST(ChannelValues, TheUncertaintyOfAPositionIsItsEffectOnTheValue) {
  const TwoFrames run({{0.4, -0.9}, {0.2, 1.1}, {-0.7, 0.6}});
  for (const char* function : {"chord(a, c)", "strain(a, b)", "sag(a, b, c)", "rotation(a, c)"}) {
    double variance = 0.0;
    for (std::size_t k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-3;
      TwoFrames up = run, down = run;
      auto& p = k % 2 == 0 ? up.joint.positions[k / 2].x : up.joint.positions[k / 2].y;
      auto& q = k % 2 == 0 ? down.joint.positions[k / 2].x : down.joint.positions[k / 2].y;
      p += kStep, q -= kStep;
      const double slope = (up.of(function).value(1) - down.of(function).value(1)) / (2.0 * kStep);
      variance += slope * slope;
    }
    const auto series = run.of(function);
    const double stated = series.loadings.row(1).tail(6).squaredNorm();
    EXPECT_NEAR(stated, variance, 1e-6 * variance) << function;
  }
}

TEST(ChannelValues, ARowIsOkOnlyIfAllItsTargetsAre) {
  TwoFrames run({{0.0, 0.1}, {0.0, 0.5}, {0.0, 0.3}});
  run.samples[3].status = Status::kBlurred;
  run.samples[5].status = Status::kLost;
  run.samples[5].displacement = {kNotMeasured, kNotMeasured};
  EXPECT_EQ(run.of("b.dy").status[1], Status::kOk);
  EXPECT_EQ(run.of("b.dy - a.dy").status[1], Status::kBlurred);
  EXPECT_NEAR(run.of("b.dy - a.dy").value(1), 0.4, 1e-15);
  EXPECT_TRUE(std::isnan(run.of("b.dy - c.dy").value(1)));
}

}  // namespace
}  // namespace moiregauge::internal
