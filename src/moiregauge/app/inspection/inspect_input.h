// SPDX-License-Identifier: Apache-2.0
// One frame of an input, inspected: `moiregauge inspect` as an application runs it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/app/measurement_run.h"
#include "moiregauge/io/run_dir/inspect_json.h"

namespace moiregauge::internal {

struct InspectArgs {
  MeasureArgs measure;  // arguments that `measure` shares
  long frame = 0;
};

struct InspectedFrame {
  InspectReport report;
  Image<std::uint8_t> grey;  // the frame, for the overlay
};

// Parses the arguments (parse_inspect_options) and checks the frame number.
[[nodiscard]] tl::expected<InspectOptions, UsageError> inspect_options(const InspectArgs& args);

// Reads the frame and detects everything in it. `on_progress` receives frames read and wanted.
// Fails: unreadable input, no such frame, or a camera of another image size. An unusable frame is no failure: its
// report holds the reason, with exit kRefused.
[[nodiscard]] tl::expected<InspectedFrame, RunFailure> inspect_input(
    const InspectArgs& args, const InspectOptions& options, const std::function<void(long, long)>& on_progress);

// Detects everything in an image. `name` describes it in the caption.
// Fails: as inspect_input.
[[nodiscard]] tl::expected<InspectedFrame, RunFailure> inspect_image(const GreyPicture& picture,
                                                                     const std::string& name,
                                                                     const InspectOptions& options);

// Returns overlay.png. Empty: out of memory.
[[nodiscard]] std::vector<std::uint8_t> overlay_of_inspection(const InspectedFrame& inspected);

// Returns the text of inspect.json.
[[nodiscard]] std::string inspect_json_text(const InspectReport& report);

}  // namespace moiregauge::internal
