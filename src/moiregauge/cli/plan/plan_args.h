// SPDX-License-Identifier: Apache-2.0
// Parses the arguments of `moiregauge plan`.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/cli/common/layout_args.h"
#include "moiregauge/planning/recording_plan.h"

namespace moiregauge::internal::cli {

// Pitches in the image that measure well, px.
inline constexpr double kFinestGoodPitch_px = 8.0, kCoarsestGoodPitch_px = 30.0;

// Arguments as typed.
struct PlanArgs {
  LayoutArgs layout;
  std::string distance, camera, resolution, pixel, focal, exposure, readout, vibration, camera_vibration;
  std::optional<double> fov_deg;
  double noise = 1.5, contrast = 170.0, psf_px = 0.7, fps = 30.0;
  bool lossless = false, compressed = false;
  bool json = false;
};

struct PlanOrder {
  RecordingSetup setup;
  std::string camera_name;                   // from the table, or the file; empty: stated in numbers
  std::string camera_source;                 // from the table
  bool readout_unknown = false;              // a rolling shutter without a stated readout time
  std::optional<sheet::SetRequest> request;  // none: the markers are those of `site_file`
  std::string site_file;
  std::string layout_note;       // for the user; may be empty
  bool is_pitch_chosen = false;  // no pitch was stated
};

[[nodiscard]] tl::expected<PlanOrder, UsageError> parse_plan_options(const PlanArgs& args);

}  // namespace moiregauge::internal::cli
