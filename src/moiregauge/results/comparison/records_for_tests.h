// SPDX-License-Identifier: Apache-2.0
// Simulated records of one movement: a channel with its u, and another sensor with a clock of its own.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "moiregauge/results/derived/channel_values.h"
#include "moiregauge/results/series.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::test {

struct RecordPlan {
  double duration_s = 30.0;
  double frame_s = 0.1, reference_s = 0.01;
  double offset_s = 0.1372;  // at the middle of the recording; the reference's stamps are larger
  double rate = 40e-6;
  double slope = 1.0, bias_mm = 2.5;
  double noise_mm = 0.004, reference_noise_mm = 0.003;
  double autocorrelation = 0.0;  // between neighbours of the channel's noise
  double lead_s = 4.0;           // by which the reference begins earlier and ends later
};

// Movement of a deck, mm: three vibrations of different damping and a passage.
inline double movement_mm(double t) {
  const double passage = (t - 14.0) / 2.5;
  return 0.8 * std::sin(kTwoPi * 0.31 * t) + 0.35 * std::sin(kTwoPi * 1.17 * t + 0.4) * std::exp(-0.03 * t) +
         0.2 * std::cos(kTwoPi * 1.9 * t + 0.05 * t * t / 30.0) - 1.5 * std::exp(-passage * passage);
}

struct SimulatedRecords {
  ChannelSeries channel;
  Series reference;
};

inline SimulatedRecords simulated_records(const RecordPlan& plan, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal;
  SimulatedRecords out;
  const auto frames = static_cast<Eigen::Index>(plan.duration_s / plan.frame_s);
  out.channel.value = Eigen::VectorXd(frames);
  out.channel.noise = Eigen::VectorXd::Constant(frames, plan.noise_mm * plan.noise_mm);
  out.channel.bounded = Eigen::VectorXd::Zero(frames);
  out.channel.loadings.setZero(frames, 1);
  double noise = normal(rng);
  for (Eigen::Index n = 0; n < frames; ++n) {
    const double t = plan.frame_s * static_cast<double>(n), rho = plan.autocorrelation;
    noise = rho * noise + std::sqrt(1.0 - rho * rho) * normal(rng);
    out.channel.frame.push_back(n);
    out.channel.time_s.push_back(t);
    out.channel.status.push_back(Status::kOk);
    out.channel.value(n) = plan.bias_mm + plan.slope * movement_mm(t) + plan.noise_mm * noise;
  }
  const double middle = 0.5 * out.channel.time_s.back();
  for (double tau = -plan.lead_s; tau < plan.duration_s + plan.lead_s; tau += plan.reference_s) {
    const double t = middle + (tau - middle - plan.offset_s) / (1.0 + plan.rate);
    out.reference.time_s.push_back(tau);
    out.reference.value.push_back(movement_mm(t) + plan.reference_noise_mm * normal(rng));
  }
  return out;
}

}  // namespace moiregauge::internal::test
