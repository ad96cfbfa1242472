// SPDX-License-Identifier: Apache-2.0
// Sample: displacement of one target in one frame with its uncertainty, one row of displacement.csv.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "moiregauge/units/point.h"

namespace moiregauge::internal {

// The closed list of displacement.csv's `status` (docs/file-formats.md).
enum class Status {
  kOk,
  // These may have values.
  kUntrusted,
  kCameraMoved,
  kBlurred,
  kSaturated,
  kPartlyCovered,
  // These have NaN.
  kLost,
  kReferenceLost,
  kOrderUnproven,
  kDecodeError,
  kTooCoarse
};

// Returns the word of displacement.csv.
[[nodiscard]] const char* word_for(Status status);
// Returns true if rows with this status may have values.
[[nodiscard]] bool has_numbers(Status status);

// Standard uncertainties (k = 1) along the board's x and y by cause, mm.
struct Budget {
  Extent<frame::Board> noise;            // by the target's window in this frame
  Extent<frame::Board> references;       // by the references' windows in this frame
  Extent<frame::Board> reference_frame;  // both of these in the reference frame
  Extent<frame::Board> model;            // error that four points do not show: lens, depth, a bent board
  Extent<frame::Board> lens;             // by the solved or given camera
  Extent<frame::Board> geometry;         // positions, rotations and heights of the markers
  Extent<frame::Board> axis;             // direction of the board's axes, which follows from reference positions only
  Extent<frame::Board> print_scale;      // scale and stretch of the gratings
  Extent<frame::Board> codec;            // error of a lossy codec, in both frames
  Extent<frame::Board> shutter;          // motion during readout and exposure
};

// Parts of the budget with their names in run.json.
struct BudgetPart {
  const char* name;
  Extent<frame::Board> Budget::*value;
};
inline constexpr std::array kBudgetParts{BudgetPart{"noise", &Budget::noise},
                                         BudgetPart{"references", &Budget::references},
                                         BudgetPart{"reference_frame", &Budget::reference_frame},
                                         BudgetPart{"model", &Budget::model},
                                         BudgetPart{"lens", &Budget::lens},
                                         BudgetPart{"geometry", &Budget::geometry},
                                         BudgetPart{"axis", &Budget::axis},
                                         BudgetPart{"print_scale", &Budget::print_scale},
                                         BudgetPart{"codec", &Budget::codec},
                                         BudgetPart{"shutter", &Budget::shutter}};

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();  // never 0, never interpolated

struct Sample {
  long frame = 0;
  double time_s = kNotMeasured;
  std::size_t marker = 0;                                         // index in the site
  Extent<frame::Board> displacement{kNotMeasured, kNotMeasured};  // mm since the reference frame, x right, y up
  Extent<frame::Board> u{kNotMeasured, kNotMeasured};             // mm, standard uncertainty (k = 1)
  Budget budget;
  Status status = Status::kLost;
};

}  // namespace moiregauge::internal
