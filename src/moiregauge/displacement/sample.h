// SPDX-License-Identifier: Apache-2.0
// A displacement of one target in one frame, with its uncertainty: one row of displacement.csv.
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
  // numbers may be present
  kUntrusted,
  kCameraMoved,
  kBlurred,
  kSaturated,
  kPartlyCovered,
  // numbers are NaN
  kLost,
  kReferenceLost,
  kOrderUnproven,
  kDecodeError,
  kTooCoarse
};

[[nodiscard]] const char* word_for(Status status);
[[nodiscard]] bool has_numbers(Status status);

// Standard uncertainties (k = 1) along the board's x and y by cause, mm.
struct Budget {
  Extent<frame::Board> noise;            // of the target's own window in this frame
  Extent<frame::Board> references;       // of the references' windows, through the homography
  Extent<frame::Board> reference_frame;  // both of the above in the reference frame
  Extent<frame::Board> model;            // what four points cannot absorb: lens, depth, a bent board
  Extent<frame::Board> lens;             // of the solved or given camera
  Extent<frame::Board> geometry;         // places, turns and heights of the markers
  Extent<frame::Board> axis;             // the direction of the board's axes, told by the references' places alone
  Extent<frame::Board> print_scale;      // of every print
  Extent<frame::Board> codec;            // what a lossy codec left out, in both frames
  Extent<frame::Board> shutter;          // what moves while the rows of a frame are read
};

// The budget's parts by the names of run.json.
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

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

struct Sample {
  long frame = 0;
  double time_s = kNotMeasured;
  std::size_t marker = 0;                                         // index in the site
  Extent<frame::Board> displacement{kNotMeasured, kNotMeasured};  // mm since the reference frame, x right, y up
  Extent<frame::Board> u{kNotMeasured, kNotMeasured};             // mm, standard uncertainty, k = 1
  Budget budget;
  Status status = Status::kLost;
};

}  // namespace moiregauge::internal
