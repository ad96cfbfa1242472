// SPDX-License-Identifier: Apache-2.0
// Reads a YUV4MPEG2 stream from a pipe as a LiveSource.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include <tl/expected.hpp>

#include "moiregauge/run/live_source.h"

namespace moiregauge::internal {

struct PipeOptions {
  std::optional<double> fps{};                                    // --fps, frames/s; replaces the rate of the stream
  std::int64_t max_pixels = 64'000'000;                           // --max-pixels
  std::chrono::milliseconds patience = std::chrono::seconds(30);  // until the header must have arrived (chosen)
};

// Opens the stream that arrives on a descriptor, which remains the caller's.
//
// Frames are read when they are requested, so the writer waits and nothing is lost. The time of a frame is its number
// divided by the rate, or the host's clock if no rate is known.
// A stream that ends within a frame loses that frame only, which counts as incomplete.
// Fails: no header within `patience`, another kind of data (kUnsupported), an empty pipe (kUnreadable).
[[nodiscard]] tl::expected<std::unique_ptr<LiveSource>, InputError> open_y4m_pipe(int file, const PipeOptions& options);

}  // namespace moiregauge::internal
