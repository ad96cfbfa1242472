// SPDX-License-Identifier: Apache-2.0
// What was seen in one frame: the pixel side of all methods, kept; the pixels are not looked at again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/detection/identity/identify_markers.h"
#include "moiregauge/image/quantiser.h"
#include "moiregauge/observation/print/print_model.h"
#include "moiregauge/observation/raster/patch.h"

namespace moiregauge::internal {

// Why a marker has no reading in a frame. The words of displacement.csv's `status` are made of these by `displacement`.
enum class Loss { kNone, kNotSeen, kOutsidePicture, kNoModulation, kCovered, kTooCoarse };

// Does something lie over a part of the print? At rest: in the reference frame it did, and now does not.
enum class Occlusion { kNone, kNow, kAtRest };

struct MarkerObservation {
  std::optional<DetectedCircle> circle;  // px, as displayed
  std::optional<PatchFit> points;        // of `precise`: what nine pixels show of the print
  PatchReading patch;                    // in the raster of the method's last stage for this marker
  Extent<frame::Board> window_shift;     // by which the raster followed a travelling target, mm
  Loss loss = Loss::kNone;
  Occlusion occlusion = Occlusion::kNone;  // of `precise`; the points are then those of the part that is free
  Order order = Order::kUnproven;          // of `precise`: the whole pitch it stands in
  Quantiser quantiser;                     // of a lossy codec, where the marker is seen
};

// Stages of the two-stage method, as they were used on the pixels of this frame.
struct Observation {
  long frame = 0;
  double time_s = 0.0;
  bool decode_error = false;
  bool references_seen = false;
  std::string reference_problem;  // why not, in words
  IdealFromBoard stage1;          // circles of this frame -> board (two-stage; conventional: the reference frame's)
  IdealFromBoard stage2;          // after the patches' displacements were added at the circles
  std::vector<MarkerObservation> markers;  // one per site marker
};

}  // namespace moiregauge::internal
