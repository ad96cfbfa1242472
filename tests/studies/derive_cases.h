// SPDX-License-Identifier: Apache-2.0
// Simulated short runs with derived channels: errors against the truth, and the stated u.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/simulated_run.h"
#include "moiregauge/results/derived/channel_values.h"

namespace moiregauge::internal::study {

// Errors of one channel in the frames of one run, in the channel's unit.
struct ChannelErrors {
  std::vector<double> error, u;
  std::vector<double> u_by_hand;  // root of the sum of the targets' variances, as without the covariance
};

struct DerivedRun {
  std::string problem;                            // reason why the run has no values
  std::map<std::string, ChannelErrors> channels;  // by name
};

// Returns the channels of the study as for --channel. The targets are `left`, `mid` and `right`.
[[nodiscard]] const std::vector<std::string>& study_channels();

// Returns the small rig with three targets that move differently, before a camera that turns by 1 deg about three axes.
// The markers differ from the site by its known_to.
[[nodiscard]] simulator::Scenario derived_scenario(std::uint64_t seed);

// Measures the scenario with `precise` in 14 frames and derives the study's channels.
[[nodiscard]] DerivedRun derived_run(std::uint64_t seed);

inline constexpr long kZeroFrames = 30;

// Measures kZeroFrames + kFramesAfterZero frames of the scenario. Returns the errors of mid.dy in the last ones, relative
// to the reference frame ("reference frame") and to the mean over the first kZeroFrames ("zero").
inline constexpr long kFramesAfterZero = 4;
[[nodiscard]] DerivedRun zeroed_run(std::uint64_t seed);

// Own rotation of a print in every frame after the first, and the Cramér-Rao bound of one frame's rotation, both in rad.
struct RotationRun {
  std::string problem;
  std::vector<double> error, u, bound;  // by frame
  double bound_of_reference = 0.0;
};

// Measures `frames` frames of the scenario. The print is that of `mid`.
// The bound follows from the pixels alone, with pose and print known. A rotation by t changes the light I by t dI/dt.
// Independent noise of variance s^2 then gives u = 1 / sqrt(sum (dI/dt)^2 / s^2), by the Fisher information. The slope is
// the difference of two images without noise, in which the simulator rotates the print by a small angle either way.
[[nodiscard]] RotationRun rotation_run(std::uint64_t seed, long frames);

// Solves a measured run again with its joint errors. The samples are those of all targets.
struct JointSolution {
  Solution solution;
  JointErrors joint;
};
[[nodiscard]] JointSolution solve_jointly(const test::MeasuredRun& run, const SolveOptions& options = {});

}  // namespace moiregauge::internal::study
