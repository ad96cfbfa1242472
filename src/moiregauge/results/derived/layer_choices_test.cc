// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/layer_choices.h"

#include <cmath>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr Eigen::Index kLineRows = 60;

// A line that rises by 1 mm per second from 5 mm, at 10 rows per second, without a reference frame.
ChannelSeries steady_rise() {
  ChannelSeries series;
  series.value.resize(kLineRows);
  series.noise = Eigen::VectorXd::Constant(kLineRows, 1e-4);
  series.bounded = Eigen::VectorXd::Zero(kLineRows);
  series.loadings = Eigen::MatrixXd::Zero(kLineRows, 1);
  for (Eigen::Index n = 0; n < kLineRows; ++n) {
    series.frame.push_back(n);
    series.time_s.push_back(0.1 * static_cast<double>(n));
    series.status.push_back(Status::kOk);
    series.value(n) = 5.0 + 0.1 * static_cast<double>(n);
  }
  return series;
}

std::vector<Channel> one_channel() { return {Channel{"rise", "mm", {}, 0.0, "mid.dy"}}; }

std::vector<Layer> zero_and_filter() {
  return {Layer{ZeroLayer{FrameRange{0, 1}}, "zero 0:1"}, parse_layer("filter", "lowpass:2Hz").value()};
}

TEST(LayerChoices, EveryLayerCanBeSwitchedWithoutTheOthers) {
  const auto choices = layer_choices(one_channel(), {steady_rise()}, zero_and_filter(), 1e6);
  ASSERT_EQ(choices.size(), 4U);
  for (const LayerChoice& choice : choices) {
    const DerivedColumn& column = choice.channels.table.columns.front();
    // A zero over the first row removes its 5 mm. A symmetric low pass keeps a straight line, but has no first row.
    const double expected = choice.is_on[0] ? 3.0 : 8.0;
    EXPECT_NEAR(column.value[30], expected, 1e-9);
    EXPECT_EQ(std::isnan(column.value[0]), choice.is_on[1]);
    EXPECT_EQ(choice.channels.statistics.front().ok < kLineRows, choice.is_on[1]);
  }
  EXPECT_EQ(choices.front().is_on, (std::vector<bool>{false, false}));
  EXPECT_EQ(choices.back().is_on, (std::vector<bool>{true, true}));
}

TEST(LayerChoices, AFilterThatNeedsResamplingIsOmittedWithoutIt) {
  ChannelSeries uneven = steady_rise();
  for (std::size_t n = 0; n < uneven.time_s.size(); ++n) uneven.time_s[n] += n % 2 == 1 ? 0.05 : 0.0;
  const std::vector<Layer> layers{parse_layer("resample", "10Hz").value(),
                                  parse_layer("filter", "lowpass:2Hz").value()};
  const auto choices = layer_choices(one_channel(), {uneven}, layers, 1e6);
  ASSERT_EQ(choices.size(), 3U);
  for (const LayerChoice& choice : choices) EXPECT_TRUE(choice.is_on[0] || !choice.is_on[1]);
}

TEST(LayerChoices, AreFewerWhereRowsAreMany) {
  const std::vector<Layer> layers = zero_and_filter();
  EXPECT_EQ(layer_choices(one_channel(), {steady_rise()}, layers, 3.0 * kLineRows).size(), 3U);  // the first k layers
  EXPECT_EQ(layer_choices(one_channel(), {steady_rise()}, layers, 2.0 * kLineRows).size(), 2U);  // none and all
  const auto least = layer_choices(one_channel(), {steady_rise()}, layers, 1.0);
  ASSERT_EQ(least.size(), 1U);
  EXPECT_EQ(least.front().is_on, (std::vector<bool>{true, true}));
}

}  // namespace
}  // namespace moiregauge::internal
