// SPDX-License-Identifier: Apache-2.0
// Detects processing inside the camera that falsifies displacements without adding noise: averaging over time, repeated
// pixels, and a tone curve with a step.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "moiregauge/displacement/method.h"
#include "moiregauge/image/edge_levels.h"
#include "moiregauge/image/grain.h"
#include "moiregauge/image/repeated_pixels.h"
#include "moiregauge/observation/print/echo.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/run/frame_source.h"
#include "moiregauge/run/image_motion.h"
#include "moiregauge/run/light.h"

namespace moiregauge::internal {

// Grey levels at the edges of the reference circles, in the reference frame.
struct EdgeGap {
  long all = 0;     // edge pixels
  long in_gap = 0;  // those in the emptiest range of 0.3 of the contrast
};

// Evidence from the pixels of one run.
struct CameraProcessing {
  GrainSums still, moving;     // grain of reference gratings and circles, camera still or moving
  SlopeSteps steps;            // steps at the edges of all gratings in the reference frame
  std::vector<long> repeated;  // numbers of frames that repeat the previous frame
  EdgeGap gap;
  EchoSums echo;  // the previous frame in the gratings of the current one
};

// Collects the evidence while frames are read.
class ProcessingWatch {
 public:
  // Starts with the reference frame: counts the steps at the edges of its gratings, and the levels at those of its
  // circles. Resets all but the repeated frames.
  void refer(const Reference& reference, const LumaView& luma);
  [[nodiscard]] bool is_referred() const { return is_referred_; }
  // Adds a measured frame. Call it in frame order. A frame whose predecessor was not added starts a new sequence.
  void add(const Reference& reference, const Observation& seen, const Frame& frame, int bits, const LightMap& light);
  // Adds a frame that repeats the previous one.
  void repeat(long frame);
  // Breaks the sequence of frames, because a frame is damaged or not measured.
  void interrupt();
  // Returns true if the tests need the skipped frames after the selected frame `seen`. They do not if no marker moved since
  // the selected frame of the last call, or if they are finished.
  [[nodiscard]] bool needs_skipped_frames(const Observation& seen);
  // Returns true if fits of templates in further frames can contribute to the result.
  [[nodiscard]] bool needs_templates() const { return !echo_.is_finished(); }
  // `since`: repeated frames with a smaller number are excluded.
  [[nodiscard]] CameraProcessing result(long since = 0) const;

 private:
  void listen(const Reference& reference, const Observation& seen, const Frame& frame, const LightMap& light);
  void interrupt_grain();

  GrainSampler sampler_;
  EchoWatch echo_;
  SlopeSteps steps_;
  EdgeGap gap_;
  std::vector<long> repeated_;
  bool is_referred_ = false;
  std::optional<long> newest_;                 // number of the last added frame
  std::vector<ImagePoint> markers_;            // px, in the last call of needs_skipped_frames; NaN: not seen
  bool is_testable_ = false;                   // the codec of the last added frame leaves grain
  std::vector<std::vector<ImagePoint>> last_;  // px, centres of the references in up to three frames, newest first
  std::vector<ImagePoint> placed_;             // px, centres at which the tiles were placed
};

// Reason why samples are untrusted, and the remedy.
struct ProcessingFault {
  std::string warning;  // empty for repeated frames, which have their own note
  std::string remedy;   // imperative
};

// Marks samples as `untrusted` that the processing may have falsified.
// Repeated pixels and a tone curve with a step concern all samples. Averages over time concern those of moving targets,
// and all samples while the camera moves. Repeated frames concern the samples of moving targets in these frames.
// `movement`: of consecutive frames, among them those of the samples. It is called only if the camera averages over time,
// because it takes a pass over all frames.
// `is_lossy`: a codec may have removed the grain. Returns nothing if no sample is concerned.
[[nodiscard]] std::optional<ProcessingFault> distrust_processed(
    const CameraProcessing& processing, bool is_lossy, const std::function<std::vector<FrameMovement>()>& movement,
    Samples& samples);

}  // namespace moiregauge::internal
