// SPDX-License-Identifier: Apache-2.0
// Tests u of a compressed video, which follows from the quantisation step alone. The codec of this test predicts each
// block from the previous frame. Like all codecs, it drops coefficients of the change below its step.
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/displacement/follower.h"
#include "moiregauge/simulator/scenario/built_in.h"

namespace moiregauge::internal::test {
namespace {

constexpr int kBlock = 8;
using Block = std::array<std::array<double, kBlock>, kBlock>;

// Returns the orthonormal cosine transform of a block, or its inverse.
Block transformed(const Block& in, bool back) {
  static const Block basis = [] {
    Block b{};
    for (std::size_t k = 0; k < kBlock; ++k) {
      for (std::size_t x = 0; x < kBlock; ++x)
        b[k][x] = std::sqrt((k == 0 ? 1.0 : 2.0) / kBlock) *
                  std::cos(std::numbers::pi * double(k) * (double(x) + 0.5) / kBlock);
    }
    return b;
  }();
  Block half{}, out{};
  const auto weight = [&](std::size_t k, std::size_t x) { return back ? basis[x][k] : basis[k][x]; };
  for (std::size_t y = 0; y < kBlock; ++y)
    for (std::size_t k = 0; k < kBlock; ++k)
      for (std::size_t x = 0; x < kBlock; ++x) half[y][k] += weight(k, x) * in[y][x];
  for (std::size_t k = 0; k < kBlock; ++k)
    for (std::size_t l = 0; l < kBlock; ++l)
      for (std::size_t y = 0; y < kBlock; ++y) out[l][k] += weight(l, y) * half[y][k];
  return out;
}

double rounded(double coefficient, double step, bool predicted) {
  return predicted && std::abs(coefficient) < step ? 0.0 : step * std::round(coefficient / step);
}

// Returns `now` as a decoder would show it. `before` is its last image; the first one has none.
Image<std::uint8_t> coded(const Image<std::uint8_t>& now, const Image<std::uint8_t>* before, double step) {
  Image<std::uint8_t> out(now.width(), now.height());
  for (int y0 = 0; y0 < now.height(); y0 += kBlock) {
    for (int x0 = 0; x0 < now.width(); x0 += kBlock) {
      Block change{};
      const auto base = [&](int x, int y) { return before == nullptr ? 0.0 : double{1} * before->at(x0 + x, y0 + y); };
      for (int y = 0; y < kBlock; ++y)
        for (int x = 0; x < kBlock; ++x) change[std::size_t(y)][std::size_t(x)] = now.at(x0 + x, y0 + y) - base(x, y);
      Block kept = transformed(change, false);
      for (auto& row : kept)
        for (double& c : row) c = rounded(c, step, before != nullptr);
      kept = transformed(kept, true);
      for (int y = 0; y < kBlock; ++y)
        for (int x = 0; x < kBlock; ++x)
          out.at(x0 + x, y0 + y) = static_cast<std::uint8_t>(
              std::clamp(std::lround(base(x, y) + kept[std::size_t(y)][std::size_t(x)]), 0L, 255L));
    }
  }
  return out;
}

Image<std::uint8_t> shot(const simulator::Scenario& scenario, long frame) {
  return render8(scenario, frame, {0, simulator::Area::kMarkersOnly});
}

void say(Observation& seen, double step) {
  for (MarkerObservation& marker : seen.markers) marker.quantiser = {step, true};
}

struct Errors {
  std::vector<double> error_mm, u_mm;
};

// Returns errors and u of a target that creeps upwards by `speed_px` per frame before a fixed camera.
Errors creeping(double speed_px, double step, bool is_stated) {
  constexpr long kFrames = 12;
  constexpr double kMmPerPx = 0.345;
  simulator::Scenario scenario = *simulator::built_in("small-still");
  scenario.light.white = 170.0, scenario.light.black = 80.0;
  auto& target = scenario.markers.back();
  const double duration = kFrames / scenario.sensor.fps;
  target.dy = simulator::Track{.knots = {{0.0, 0.0}, {duration, speed_px * kMmPerPx * kFrames}}};
  const Method& method = *method_named("precise");
  Image<std::uint8_t> last = coded(shot(scenario, 0), nullptr, step);
  auto reference = make_reference({last.view(), 8}, simulator::site_of(scenario), {}, {});
  Errors out;
  if (!reference) {
    ADD_FAILURE() << reference.error().message;
    return out;
  }
  method.prepare({last.view(), 8}, *reference);
  if (is_stated) say(reference->seen, step);
  Follower follower(*reference);
  Observations observations(*reference);
  for (long frame = 1; frame < kFrames; ++frame) {
    last = coded(shot(scenario, frame), &last, step);
    Observation seen = method.observe({last.view(), 8, rounding_of_step(step)}, *reference, follower.prediction());
    seen.frame = frame;
    if (is_stated) say(seen, step);
    (void)follower.follow(*reference, seen);
    observations.push_back(seen);
  }
  for (const Sample& sample : method.solve(*reference, observations, {}).samples) {
    if (!has_numbers(sample.status)) continue;
    const auto now = truth(scenario, sample.frame, target), then = truth(scenario, 0, target);
    out.error_mm.push_back(sample.displacement.y - (now.dy_mm - then.dy_mm));
    out.u_mm.push_back(sample.u.y);
  }
  return out;
}

// At least 95 % of the errors over all speeds and steps are within 1.96 u. The mean u is below four times their rms.
TEST(Codec, LagOfACreepingTargetIsWithinU) {
  long count = 0, within = 0;
  double squares = 0.0, u_sum = 0.0;
  for (const double step : {5.0, 10.0, 20.0}) {
    for (const double speed_px : {0.004, 0.012, 0.04}) {
      const Errors errors = creeping(speed_px, step, true);
      EXPECT_EQ(errors.error_mm.size(), 11u) << step << " " << speed_px;
      for (std::size_t k = 0; k < errors.error_mm.size(); ++k, ++count) {
        within += std::abs(errors.error_mm[k]) < 1.96 * errors.u_mm[k] ? 1 : 0;
        EXPECT_LT(std::abs(errors.error_mm[k]), 5.0 * errors.u_mm[k]);
        squares += errors.error_mm[k] * errors.error_mm[k];
        u_sum += errors.u_mm[k];
      }
    }
  }
  EXPECT_GE(double(within), 0.95 * double(count));
  EXPECT_LT(u_sum / double(count), 4.0 * std::sqrt(squares / double(count)));
}

}  // namespace
}  // namespace moiregauge::internal::test
