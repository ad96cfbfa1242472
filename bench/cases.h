// SPDX-License-Identifier: Apache-2.0
// Benchmark cases over the frames of a recording, named NAME/SIZE/MEMORY; bench/ratios.py reads them by these names.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "recording.h"

namespace moiregauge::internal::bench {

// One case at one size: what is timed, and how far it is from the truth.
struct Work {
  std::function<bool(const Shot&)> frame;  // false: lost; timed
  // Measured minus true x and y of the same in one frame; NaN: not measured. Without it nothing is measured.
  std::function<Error(const Shot&)> error;
  std::string error_unit;  // "mm", "px"
  std::size_t bytes = 0;   // of the picture that the work is about
};
// Finding the circles of a whole picture: `find` gives their centres, or nothing when some are missing.
using FindCentres = std::function<std::optional<std::vector<ImagePoint>>(const Shot&)>;
[[nodiscard]] std::shared_ptr<Work> detection_of(const Recording& recording, FindCentres find);

using MakeWork = std::function<std::shared_ptr<Work>(const Recording&)>;

// Counters: bytes; lost, the share of the frames; of what is measured, along either axis, error_x_<unit>, rms over the
// ring's frames, scatter_x_<unit>, about their mean, in which the noise of the one reference frame has dropped out, and
// error_frames, how many they are. Work is made when its first case runs, and shared by the cases of one size.
void add_cases(const std::string& name, std::initializer_list<Memory> memories, const MakeWork& make);

void add_yardstick_cases();
void add_chain_cases();
void add_stage_cases();

}  // namespace moiregauge::internal::bench
