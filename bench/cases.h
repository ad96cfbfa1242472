// SPDX-License-Identifier: Apache-2.0
// Benchmark cases over the frames of a recording. bench/ratios.py reads them by their names, NAME/SIZE/MEMORY.
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

// One case at one size: the timed function, and its error.
struct Work {
  std::function<bool(const Shot&)> frame;  // timed; returns false for a lost frame
  // Returns measured minus true x and y in one frame; NaN: not measured. Empty for cases without a measured value.
  std::function<Error(const Shot&)> error;
  std::string error_unit;  // "mm", "px"
  std::size_t bytes = 0;   // bytes of the image, or of its part, that the work uses
};
// Returns the centres of all circles in an image; empty if some are missing.
using FindCentres = std::function<std::optional<std::vector<ImagePoint>>(const Shot&)>;
// Returns the case of a detection in the whole image.
[[nodiscard]] std::shared_ptr<Work> detection_of(const Recording& recording, FindCentres find);

using MakeWork = std::function<std::shared_ptr<Work>(const Recording&)>;

// Adds one case per size and memory. The work is made when its first case runs, and shared by the cases of one size.
// Counters:
//     bytes               as in Work
//     lost                share of the frames
//     error_x_<unit>      rms of the error over the ring's frames (x and y)
//     scatter_x_<unit>    scatter of the error around its mean, without the noise of the reference frame (x and y)
//     error_frames        number of these frames
void add_cases(const std::string& name, std::initializer_list<Memory> memories, const MakeWork& make);

void add_yardstick_cases();
void add_chain_cases();
void add_stage_cases();
void add_peer_cases();

}  // namespace moiregauge::internal::bench
