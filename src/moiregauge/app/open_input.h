// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// Opens any INPUT: a folder of images, a printf pattern (options.sequence), a TIFF stack, else a video file.
// The times of a slow-motion file are those of the scene.
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_input(const std::string& path,
                                                                                const InputOptions& options);

// The same, but frames of a video before `first_frame` may be omitted (DecoderOptions::first_frame).
[[nodiscard]] tl::expected<std::unique_ptr<FrameSource>, InputError> open_input_from(long first_frame,
                                                                                     const std::string& path,
                                                                                     const InputOptions& options);

}  // namespace moiregauge::internal
