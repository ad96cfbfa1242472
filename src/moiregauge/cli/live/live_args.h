// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/app/live/live_run.h"
#include "moiregauge/app/measure_options.h"
#include "moiregauge/cli/live/outlet_options.h"
#include "moiregauge/cli/live/source_options.h"

namespace moiregauge::internal::cli {

// Arguments of `moiregauge live` as typed.
struct LiveArgs {
  MeasureArgs measure;  // its `input` is SOURCE
  SourceTexts source;   // options of cameras
  OutletTexts outlets;
  bool is_list = false;  // --list
  std::string pace;
  std::string max_time;
  std::string segment;
  std::string keep;
  std::string quota;
  std::string preview;   // --preview
  std::string progress;  // --progress
};

// Fails with the first mistake.
[[nodiscard]] tl::expected<LiveRequest, UsageError> live_request(const LiveArgs& args);

}  // namespace moiregauge::internal::cli
