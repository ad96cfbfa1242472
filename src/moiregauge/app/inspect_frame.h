// SPDX-License-Identifier: Apache-2.0
// Inspects one frame as `moiregauge inspect` does.
#pragma once

#include <functional>
#include <optional>

#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/io/run_dir/inspect_json.h"

namespace moiregauge::internal {

// Parses the arguments as `measure` does. Here site and pitch may both be missing.
[[nodiscard]] tl::expected<InspectOptions, UsageError> parse_inspect_options(const MeasureArgs& args);

// Returns true if the options state the scale. Lengths are otherwise in pitches.
[[nodiscard]] inline bool has_scale(const InspectOptions& options) { return options.site || options.pitch_mm; }

// Returns the quantiser of the frame after the inspected one, or nothing at the end of the input.
using NextQuantiser = std::function<std::optional<QuantiserMap>()>;

// Inspects a frame, with the expected uncertainties of its targets. `next` is called at most once, after the pixels of
// `frame` have been read. The report's exit states whether a measurement can begin with this frame.
[[nodiscard]] InspectReport inspect_frame(const InputInfo& input, const Frame& frame, const InspectOptions& options,
                                          const NextQuantiser& next);

}  // namespace moiregauge::internal
