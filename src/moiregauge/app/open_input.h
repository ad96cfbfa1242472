// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace CLI {
class App;
}

namespace moiregauge::internal {

// Any INPUT: a folder of pictures, a printf pattern with --sequence, a picture or TIFF stack, else a video file.
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_input(const std::string& path,
                                                                                const InputOptions& options);

// The option that goes with it: --max-pixels.
void add_max_pixels(CLI::App& command, std::int64_t& max_pixels);

}  // namespace moiregauge::internal
