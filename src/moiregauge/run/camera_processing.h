// SPDX-License-Identifier: Apache-2.0
// Processing inside the camera that makes displacements wrong without making them noisy: averages over time, and pixels
// that are written more than once.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/displacement/method.h"
#include "moiregauge/image/grain.h"
#include "moiregauge/image/repeated_pixels.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// The evidence in a run's pixels.
struct CameraProcessing {
  GrainSums still, moving;     // grain of the references' prints and discs, by whether the camera moved
  SlopeSteps steps;            // of all prints, in the reference frame
  std::vector<long> repeated;  // numbers of frames that show the one before again
};

// Collects the evidence while frames are read.
class ProcessingWatch {
 public:
  // Chooses where to look, and looks at the reference frame's prints.
  void refer(const Reference& reference, const LumaView& luma);
  [[nodiscard]] bool is_referred() const { return is_referred_; }
  // Adds a measured frame in its order.
  void add(const Reference& reference, const Observation& seen, const Frame& frame, int bits);
  // Adds a frame that shows the one before again.
  void repeat(long frame);
  // Breaks the sequence: a frame shows nothing whole.
  void interrupt();
  [[nodiscard]] CameraProcessing result() const { return {sampler_.still(), sampler_.moving(), steps_, repeated_}; }

 private:
  GrainSampler sampler_;
  SlopeSteps steps_;
  std::vector<long> repeated_;
  bool is_referred_ = false;
  std::vector<std::vector<ImagePoint>> last_;  // the references' centres in the last frames, the newest first
  std::vector<ImagePoint> placed_;             // those by which the tiles are placed
};

// Why rows lost their `ok`, and what to do.
struct ProcessingFault {
  std::string warning;  // empty of repeated frames, which have a note of their own
  std::string remedy;   // as an order
};

// Makes rows `untrusted` that the processing may have made wrong: all where pixels are repeated; those of targets that
// move where frames are averages over time; and of these targets those of frames that show an earlier one again.
// `is_lossy`: a codec may have removed the grain. Returns nothing where no row is concerned.
[[nodiscard]] std::optional<ProcessingFault> distrust_processed(const CameraProcessing& processing, bool is_lossy,
                                                                Samples& samples);

}  // namespace moiregauge::internal
