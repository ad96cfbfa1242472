// SPDX-License-Identifier: Apache-2.0
// Result of reading one frame, with any method. The pixels are not read again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/detection/identity/identify_markers.h"
#include "moiregauge/image/quantiser.h"
#include "moiregauge/observation/print/print_model.h"
#include "moiregauge/observation/raster/patch.h"

namespace moiregauge::internal {

// Reason why a marker has no reading in a frame. `displacement` derives the status words of displacement.csv from it.
enum class Loss { kNone, kNotSeen, kOutsidePicture, kNoModulation, kCovered, kTooCoarse };

// Occlusion of a part of a grating, now or in the reference frame. `kAtRest`: covered in the reference frame, free now.
enum class Occlusion { kNone, kNow, kAtRest };

struct MarkerObservation {
  std::optional<DetectedCircle> circle;  // px, as displayed
  // By `precise`: nine points of the grating.
  std::optional<PatchFit> points;
  PatchReading patch;  // in the raster of the method's last stage for this marker
  // Displacement of the raster, which moves with a target, mm.
  Extent<frame::Board> window_shift;
  Loss loss = Loss::kNone;
  // By `precise`. The points are then those of the free part.
  Occlusion occlusion = Occlusion::kNone;
  Order order = Order::kUnproven;  // by `precise`: fringe order
  Quantiser quantiser;             // a lossy codec's, at the marker
};

// Readings of one frame, and the homographies through which they were made.
struct Observation {
  long frame = 0;
  double time_s = 0.0;
  bool decode_error = false;
  bool references_seen = false;
  std::string reference_problem;  // reason, if references_seen is false
  // By the circles of this frame. `conventional` has that of the reference frame.
  IdealFromBoard stage1;
  // After the displacements of the references' gratings were added at the circles.
  IdealFromBoard stage2;
  std::vector<MarkerObservation> markers;  // one per site marker
};

}  // namespace moiregauge::internal
