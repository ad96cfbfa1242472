// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/layers.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/results/derived/statistics.h"
#include "moiregauge/results/derived/zeroed_samples.h"

namespace moiregauge::internal {
namespace {

constexpr double kFps = 100.0, kNoise = 0.01, kShared = 0.05;
constexpr Eigen::Index kRows = 600;

// A series without a reference frame: noise of kNoise, one shared factor of kShared.
template <typename Signal>
ChannelSeries sampled(Signal signal) {
  ChannelSeries series;
  series.value.resize(kRows);
  series.noise = Eigen::VectorXd::Constant(kRows, kNoise * kNoise);
  series.bounded = Eigen::VectorXd::Zero(kRows);
  series.loadings = Eigen::MatrixXd::Constant(kRows, 1, kShared);
  for (Eigen::Index n = 0; n < kRows; ++n) {
    series.frame.push_back(n);
    series.time_s.push_back(static_cast<double>(n) / kFps);
    series.status.push_back(Status::kOk);
    series.value(n) = signal(static_cast<double>(n) / kFps);
  }
  return series;
}

LayeredSeries with(ChannelSeries series, const std::vector<std::pair<const char*, const char*>>& typed) {
  std::vector<Layer> layers;
  for (const auto& [option, value] : typed) {
    if (std::string(option) == "detrend")
      layers.push_back({DetrendLayer{}, option});
    else
      layers.push_back(parse_layer(option, value).value());
  }
  return layered(std::move(series), "mm", layers).value();
}

double sine(double t, double hz) { return std::sin(2.0 * std::numbers::pi * hz * t); }

// Largest value in the middle of the record, where every filter has its whole width.
double amplitude(const LayeredSeries& series) { return series.value.segment(200, 200).cwiseAbs().maxCoeff(); }

TEST(Layers, AFilterPassesOneSideOfItsFrequencyWithoutPhase) {
  const auto slow = [](double t) { return sine(t, 2.0); };
  const auto fast = [](double t) { return sine(t, 20.0); };
  // The ripple of a Hamming window is 0.2 %, its stop band 53 dB down (0.22 %).
  EXPECT_NEAR(amplitude(with(sampled(slow), {{"filter", "lowpass:6Hz"}})), 1.0, 0.004);
  EXPECT_LT(amplitude(with(sampled(fast), {{"filter", "lowpass:6Hz"}})), 0.004);
  EXPECT_LT(amplitude(with(sampled(slow), {{"filter", "highpass:6Hz"}})), 0.004);
  const auto passed = with(sampled(slow), {{"filter", "lowpass:6Hz"}});
  const auto in_band = with(sampled(fast), {{"filter", "bandpass:6Hz-45Hz"}});
  for (Eigen::Index n = 200; n < 400; ++n) {
    EXPECT_NEAR(passed.value(n), sine(static_cast<double>(n) / kFps, 2.0), 0.004);
    EXPECT_NEAR(in_band.value(n), sine(static_cast<double>(n) / kFps, 20.0), 0.01);
  }
}

TEST(Layers, RowsWithoutAWholeFilterHaveNoValue) {
  ChannelSeries series = sampled([](double t) { return sine(t, 2.0); });
  series.status[300] = Status::kBlurred;
  const auto passed = with(series, {{"filter", "lowpass:10Hz"}});
  const Eigen::Index half = 17;  // 1.65 periods of 10 rows
  for (const Eigen::Index n : {Eigen::Index{0}, half - 1, 300 - half, Eigen::Index{300}, 300 + half, kRows - half})
    EXPECT_TRUE(std::isnan(passed.value(n))) << n;
  for (const Eigen::Index n : {half, 300 - half - 1, 300 + half + 1, kRows - half - 1})
    EXPECT_TRUE(std::isfinite(passed.value(n))) << n;
}

TEST(Layers, VelocityIsTheSlopeOfALineAndTheDerivativeOfASlowSine) {
  const auto line = with(sampled([](double t) { return 3.0 * t + 1.0; }), {{"velocity", "10Hz"}});
  EXPECT_EQ(line.unit, "mm/s");
  EXPECT_NEAR(line.value(300), 3.0, 1e-9);
  const auto swing = with(sampled([](double t) { return sine(t, 2.0); }), {{"velocity", "10Hz"}});
  const double omega = 2.0 * std::numbers::pi * 2.0;
  // The ripple in the pass band is 0.2 %, the error of the difference is less.
  for (Eigen::Index n = 200; n < 300; ++n)
    EXPECT_NEAR(swing.value(n), omega * std::cos(omega * static_cast<double>(n) / kFps), 0.004 * omega);
}

TEST(Layers, DetrendRemovesALineAndResamplingKeepsIt) {
  const auto flat = with(sampled([](double t) { return 5.0 - 2.0 * t; }), {{"detrend", ""}});
  EXPECT_LT(flat.value.cwiseAbs().maxCoeff(), 1e-11);
  const auto dense = with(sampled([](double t) { return 5.0 - 2.0 * t; }), {{"resample", "250Hz"}});
  ASSERT_EQ(dense.value.size(), 1498);
  EXPECT_TRUE(dense.frame.empty());
  for (Eigen::Index n = 0; n < dense.value.size(); ++n)
    EXPECT_NEAR(dense.value(n), 5.0 - 2.0 * dense.time_s[static_cast<std::size_t>(n)], 1e-11);
}

TEST(Layers, AMedianRemovesASpike) {
  ChannelSeries series = sampled([](double t) { return t; });
  series.value(300) = 50.0;
  const auto smooth = with(series, {{"median", "5"}});
  EXPECT_LT(smooth.value(300), 3.1);
  EXPECT_NEAR(smooth.u(300), std::hypot(kNoise, kShared), 1e-12);
  EXPECT_TRUE(smooth.is_u_of_median);
}

// The stated u of a row and of each statistic is the scatter over draws of noise and of the shared factor.
TEST(Layers, TheirUncertaintyIsTheScatterOverDraws) {
  constexpr int kDraws = 400;
  const std::vector<std::vector<std::pair<const char*, const char*>>> stacks{
      {{"filter", "lowpass:6Hz"}},
      {{"filter", "highpass:6Hz"}},
      {{"filter", "lowpass:20Hz"}, {"detrend", ""}},
      {{"detrend", ""}, {"filter", "bandpass:5Hz-20Hz"}},
      {{"velocity", "10Hz"}, {"filter", "lowpass:20Hz"}},
      {{"resample", "70Hz"}, {"filter", "lowpass:6Hz"}, {"detrend", ""}}};
  std::mt19937_64 rng(20);
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < stacks.size(); ++k) {
    double row = 0.0, mean = 0.0, range = 0.0, u_row = 0.0, u_mean = 0.0, u_range = 0.0;
    const auto signal = [](double t) { return sine(t, 0.5); };
    const LayeredSeries truth = with(sampled(signal), stacks[k]);
    Eigen::VectorXd used = Eigen::VectorXd::Zero(truth.value.size()), ends = used;
    for (Eigen::Index n = 0; n < used.size(); ++n) used(n) = std::isfinite(truth.value(n)) ? 1.0 : 0.0;
    used /= used.sum();
    const Eigen::Index at = truth.value.size() / 2;
    ends(at) = 1.0, ends(at + 3) = -1.0;
    for (int draw = 0; draw < kDraws; ++draw) {
      ChannelSeries series = sampled(signal);
      const double common = kShared * normal(rng);
      for (double& value : series.value) value += common + kNoise * normal(rng);
      const LayeredSeries noisy = with(series, stacks[k]);
      row += std::pow(noisy.value(at) - truth.value(at), 2) / kDraws;
      const auto off = [&](const Eigen::VectorXd& weights, double& sum, double& u) {
        const ValueWithU value = weighted_sum(noisy, weights);
        sum += std::pow(value.value - weighted_sum(truth, weights).value, 2) / kDraws;
        u = value.u;
      };
      off(used, mean, u_mean);
      off(ends, range, u_range);
      u_row = noisy.u(at);
    }
    // The scatter of 400 draws has a relative standard error of 1 / sqrt(800) = 3.5 %. Four of them are allowed.
    EXPECT_NEAR(std::sqrt(row), u_row, 0.14 * u_row) << k;
    EXPECT_NEAR(std::sqrt(mean), u_mean, 0.14 * u_mean + 1e-12) << k;
    EXPECT_NEAR(std::sqrt(range), u_range, 0.14 * u_range) << k;
  }
}

TEST(Layers, MistakesSayWhatToDo) {
  EXPECT_FALSE(parse_layer("filter", "lowpass:5"));
  EXPECT_FALSE(parse_layer("filter", "bandpass:5Hz-2Hz"));
  EXPECT_FALSE(parse_layer("filter", "lowpass"));
  EXPECT_FALSE(parse_layer("median", "4"));
  EXPECT_FALSE(parse_layer("velocity", "-1Hz"));
  const auto refusal = [](ChannelSeries series, const Layer& layer) {
    const auto out = layered(std::move(series), "mm", {layer});
    return out ? std::string() : out.error();
  };
  const auto still = sampled([](double) { return 0.0; });
  EXPECT_NE(refusal(still, *parse_layer("filter", "lowpass:60Hz")).find("half the frame rate"), std::string::npos);
  EXPECT_NE(refusal(still, *parse_layer("filter", "lowpass:0.2Hz")).find("needs"), std::string::npos);
  EXPECT_NE(refusal(still, {ZeroLayer{{700, 800}}, "zero"}).find("no row of --zero"), std::string::npos);
  ChannelSeries timeless = still;
  for (double& t : timeless.time_s) t = kNotMeasured;
  EXPECT_NE(refusal(timeless, *parse_layer("filter", "lowpass:5Hz")).find("--fps"), std::string::npos);
  EXPECT_NE(refusal(timeless, *parse_layer("resample", "5Hz")).find("--fps"), std::string::npos);
}

// A zero over N frames: x_n - mean has the variance s^2 (1 + 1/N) outside them and s^2 (1 - 1/N) inside; what all
// frames share cancels.
TEST(Layers, AZeroHasTheNoiseOfItsMean) {
  const auto zeroed = layered(sampled([](double) { return 4.0; }), "mm", {{ZeroLayer{{0, 30}}, "zero"}}).value();
  EXPECT_NEAR(zeroed.value(100), 0.0, 1e-12);
  EXPECT_NEAR(zeroed.u(100), kNoise * std::sqrt(1.0 + 1.0 / 30.0), 1e-12);
  EXPECT_NEAR(zeroed.u(10), kNoise * std::sqrt(1.0 - 1.0 / 30.0), 1e-12);
}

TEST(Layers, SamplesAndChannelsHaveTheSameZero) {
  JointErrors joint;
  joint.targets = {4};
  joint.positions = {{0.0, 0.0}};
  joint.constant = Eigen::MatrixXd::Constant(3, 1, 0.02);
  Samples samples;
  std::mt19937_64 rng(5);
  std::normal_distribution<double> normal;
  for (long n = 0; n < 40; ++n) {
    Sample sample;
    sample.frame = n;
    sample.marker = 4;
    sample.status = n == 5 ? Status::kBlurred : Status::kOk;
    sample.displacement = n == 0 ? Extent<frame::Board>{} : Extent<frame::Board>{normal(rng), normal(rng)};
    FrameErrors errors;
    errors.rotation_rad = Eigen::VectorXd::Zero(1);
    errors.noise = (n == 0 ? 0.0 : 1e-4 * (1.0 + 0.1 * static_cast<double>(n))) * Eigen::MatrixXd::Identity(3, 3);
    errors.bounded = 0.2 * errors.noise;
    errors.varying = Eigen::MatrixXd::Constant(3, 1, 1e-4 * static_cast<double>(n));
    errors.constant_share = n == 0 ? 0.0 : 1.0;
    sample.u = {1.0, 1.0};
    samples.push_back(sample);
    joint.frames.push_back(errors);
  }
  const Channel channel{"y", "mm", {{TermKind::kDy, {0}, 1.0}}, 0.0, {}};
  const FrameRange range{0, 20};
  const auto expected =
      layered(channel_values(channel, samples, joint).value(), "mm", {{ZeroLayer{range}, "zero"}}).value();
  Samples zeroed = samples;
  ASSERT_FALSE(subtract_zero(joint, range, zeroed));
  for (std::size_t n = 0; n < zeroed.size(); ++n) {
    if (n == 5) continue;
    const auto row = static_cast<Eigen::Index>(n);
    EXPECT_NEAR(zeroed[n].displacement.y, expected.value(row), 1e-12) << n;
    EXPECT_NEAR(zeroed[n].u.y, expected.u(row), 1e-9 * expected.u(row)) << n;
    double parts = 0.0;
    for (const BudgetPart& part : kBudgetParts) parts += std::pow((zeroed[n].budget.*part.value).y, 2);
    EXPECT_NEAR(std::sqrt(parts), zeroed[n].u.y, 1e-12) << n;
  }
  EXPECT_EQ(subtract_zero(joint, {100, 200}, zeroed), std::size_t{4});
}

}  // namespace
}  // namespace moiregauge::internal
