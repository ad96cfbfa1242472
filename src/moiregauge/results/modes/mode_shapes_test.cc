// SPDX-License-Identifier: Apache-2.0
// Mode shapes of three simulated targets on one vibration, with noise that targets share in part.
#include "moiregauge/results/modes/mode_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kTargetCount = 3;
constexpr Eigen::Index kRowCount = kQuantities * static_cast<Eigen::Index>(kTargetCount);

struct ModalPlan {
  int frames = 240;
  double interval_s = 0.04, frequency_hz = 1.73, damping = 0.0;
  std::array<double, kTargetCount> amplitude_mm{0.2, 0.35, 0.12};  // along y
  std::array<double, kTargetCount> phase_rad{0.3, 0.1, -2.6};
  double own_mm = 0.004, shared_mm = 0.003;  // u of a frame: each value's, and common to all targets along an axis
  double scale_u = 0.001;                    // relative u of the scale: all displacements share its error
  double background_mm = 0.0;                // further noise that no u states
};

struct ModalRun {
  Samples samples;
  JointErrors joint;
};

double swing(const ModalPlan& plan, std::size_t target, double t) {
  const double omega = kTwoPi * plan.frequency_hz;
  return plan.amplitude_mm[target] * std::exp(-plan.damping * omega * t) * std::cos(omega * t + plan.phase_rad[target]);
}

FrameErrors frame_errors(const ModalPlan& plan, const Eigen::VectorXd& true_mm) {
  FrameErrors errors;
  errors.rotation_rad = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kTargetCount));
  errors.noise = Eigen::MatrixXd::Zero(kRowCount, kRowCount);
  for (std::size_t a = 0; a < kTargetCount; ++a) {
    for (std::size_t b = 0; b < kTargetCount; ++b) {
      for (const Quantity q : {Quantity::kDx, Quantity::kDy})
        errors.noise(quantity_row(a, q), quantity_row(b, q)) =
            plan.shared_mm * plan.shared_mm + (a == b ? plan.own_mm * plan.own_mm : 0.0);
    }
  }
  errors.varying = plan.scale_u * true_mm;
  return errors;
}

ModalRun modal_run(const ModalPlan& plan, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal;
  ModalRun out;
  for (std::size_t t = 0; t < kTargetCount; ++t) {
    out.joint.targets.push_back(t);
    out.joint.positions.push_back({400.0 * static_cast<double>(t), 0.0});
  }
  out.joint.constant = Eigen::MatrixXd(kRowCount, 0);
  const double scale = 1.0 + plan.scale_u * normal(rng);
  for (int n = 0; n < plan.frames; ++n) {
    const double time_s = plan.interval_s * n;
    const double common_x = plan.shared_mm * normal(rng), common_y = plan.shared_mm * normal(rng);
    Eigen::VectorXd true_mm = Eigen::VectorXd::Zero(kRowCount);
    for (std::size_t t = 0; t < kTargetCount; ++t) {
      const double y = swing(plan, t, time_s);
      true_mm(quantity_row(t, Quantity::kDy)) = y;
      const double noise = std::hypot(plan.own_mm, plan.background_mm);
      Sample sample;
      sample.frame = n, sample.time_s = time_s, sample.marker = t, sample.status = Status::kOk;
      sample.displacement = {common_x + noise * normal(rng), scale * y + common_y + noise * normal(rng)};
      out.samples.push_back(sample);
    }
    out.joint.frames.push_back(frame_errors(plan, true_mm));
  }
  return out;
}

std::vector<TargetSpectra> spectra_of_run(const ModalRun& run) {
  std::vector<TargetSpectra> out;
  for (std::size_t t = 0; t < kTargetCount; ++t)
    out.push_back({spectrum_of(series_of(run.samples, t, &Extent<frame::Board>::x)),
                   spectrum_of(series_of(run.samples, t, &Extent<frame::Board>::y))});
  return out;
}

std::vector<ModeShape> shapes_of(const ModalRun& run) {
  return mode_shapes(run.samples, run.joint, spectra_of_run(run));
}

const ModeEntry& entry(const ModeShape& shape, std::size_t target, BoardAxis axis) {
  for (const ModeEntry& e : shape.entries) {
    if (e.target == target && e.axis == axis) return e;
  }
  return shape.entries.front();
}

struct Inside {
  int ratio = 0, phase = 0, of = 0;
  double ratio_pull = 0.0;
};

// Counts draws whose ratio and phase are within U (k = 2) of the truth, over both other targets.
Inside inside(const ModalPlan& plan, int draws) {
  Inside out;
  for (int n = 0; n < draws; ++n) {
    const auto shapes = shapes_of(modal_run(plan, static_cast<std::uint64_t>(n) + 1));
    const auto shape = std::find_if(shapes.begin(), shapes.end(), [&](const ModeShape& one) {
      return std::abs(one.peak.frequency_hz - plan.frequency_hz) < one.resolution_hz;
    });
    EXPECT_NE(shape, shapes.end()) << "seed " << n + 1;
    if (shape == shapes.end()) continue;
    EXPECT_EQ(shape->entries[shape->reference].target, 1U) << "the strongest is the reference";
    for (const std::size_t t : {std::size_t{0}, std::size_t{2}}) {
      const ModeEntry& e = entry(*shape, t, BoardAxis::kY);
      const double ratio = plan.amplitude_mm[t] / plan.amplitude_mm[1];
      const double phase = plan.phase_rad[t] - plan.phase_rad[1];
      out.ratio += std::abs(e.ratio - ratio) < 2.0 * e.u_ratio;
      out.phase += std::abs(std::remainder(e.phase_rad - phase, kTwoPi)) < 2.0 * e.u_phase_rad;
      out.ratio_pull += std::pow((e.ratio - ratio) / e.u_ratio, 2.0);
      ++out.of;
    }
  }
  return out;
}

// 200 draws with two targets. A share of 95.4 % has a standard error of 1.5 % over 200 independent draws. Both targets
// share the reference's noise, so no more independence is assumed. Three standard errors are allowed below 95 %.
TEST(ModeShapes, RatioAndPhaseAreWithinTheirUncertainty) {
  constexpr int kDraws = 200;
  const Inside steady = inside({}, kDraws);
  ASSERT_EQ(steady.of, 2 * kDraws);
  std::printf("ratio: %d, phase: %d of %d within U\n", steady.ratio, steady.phase, steady.of);
  EXPECT_GE(steady.ratio, static_cast<int>(0.905 * steady.of));
  EXPECT_GE(steady.phase, static_cast<int>(0.905 * steady.of));
  // u is no larger than the scatter needs: the rms of 400 pulls has a relative standard error below 5 %.
  EXPECT_NEAR(std::sqrt(steady.ratio_pull / steady.of), 1.0, 0.15);
}

TEST(ModeShapes, ADecayHasTheShapeOfItsAmplitudes) {
  constexpr int kDraws = 100;
  const Inside decay = inside({.damping = 0.012}, kDraws);
  ASSERT_EQ(decay.of, 2 * kDraws);
  EXPECT_GE(decay.ratio, static_cast<int>(0.885 * decay.of));  // standard error 2.1 %
  EXPECT_GE(decay.phase, static_cast<int>(0.885 * decay.of));
}

// Noise that no u states is read from the record around the peak.
TEST(ModeShapes, ANoisyRecordWidensTheUncertainty) {
  constexpr int kDraws = 100;
  const Inside noisy = inside({.background_mm = 0.02}, kDraws);
  ASSERT_EQ(noisy.of, 2 * kDraws);
  EXPECT_GE(noisy.ratio, static_cast<int>(0.885 * noisy.of));
  EXPECT_GE(noisy.phase, static_cast<int>(0.885 * noisy.of));
}

// Scale moves all targets by the same share, so the ratio does not contain it.
TEST(ModeShapes, AnErrorThatAllTargetsShareCancels) {
  const auto run = modal_run({.scale_u = 0.0}, 5), scaled = modal_run({.scale_u = 0.05}, 5);
  const auto a = shapes_of(run), b = shapes_of(scaled);
  ASSERT_EQ(a.size(), 1U);
  ASSERT_EQ(b.size(), 1U);
  const ModeEntry &e = entry(a[0], 0, BoardAxis::kY), &f = entry(b[0], 0, BoardAxis::kY);
  EXPECT_NEAR(f.ratio, e.ratio, e.u_ratio);
  EXPECT_NEAR(f.u_ratio, e.u_ratio, 0.05 * e.u_ratio);
}

// An axis without the vibration has a ratio of noise, and no phase.
TEST(ModeShapes, AnAxisWithoutVibrationHasNoPhase) {
  const auto shapes = shapes_of(modal_run({}, 3));
  ASSERT_EQ(shapes.size(), 1U);
  const ModeEntry& e = entry(shapes[0], 0, BoardAxis::kX);
  EXPECT_LT(e.ratio, 4.0 * e.u_ratio);
  EXPECT_GT(e.u_phase_rad, 0.2);
}

TEST(ModeShapes, ARecordWithoutAPeakHasNoShape) {
  EXPECT_TRUE(shapes_of(modal_run({.amplitude_mm = {0.0, 0.0, 0.0}}, 4)).empty());
}

}  // namespace
}  // namespace moiregauge::internal
