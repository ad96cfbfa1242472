// SPDX-License-Identifier: Apache-2.0
// What a lossy codec does to a displacement (docs/methods/precise.md, "Compressed footage").
//
// A print that moves by d changes its pixels by d times the grey levels' slope g. Where the codec predicts a block from
// the frame before, it stores the change only if a coefficient of the change exceeds about its quantiser's step: a
// block of 8 x 8 pixels whose change is spread over a few coefficients of 8 g d each is left as it was up to
//
//   d = step / (8 g)     the codec's dead zone, px, g rms over the print
//
// and the whole print lags together, so nothing averages out, and its pixels look less noisy, not more. Beyond a
// quarter of a pixel the encoder would rather move the block, so however faint the print, the error levels off.
// The lag of prints that all follow a moving camera is largely common to them, and cancels; the target's own does not.
// Without prediction (Motion JPEG, key frames) errors differ from block to block and average out over the print; what
// they leave is seen in its residuals.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/observation/reference/observations.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {

// The part of the dead zone that is one standard uncertainty. Measured on x264, constant rate factors 18 to 28, prints
// of 60 to 170 grey levels: targets creeping before a still camera err by 0.1 to 0.6 of it rms and by 1.1 at most;
// references before a moving one by 0.2 at most against each other.
enum class Lag { kOwn, kShared };

// Along one axis, px. slope_rms: of the grey levels along it, per px. area_px: of the print.
[[nodiscard]] double codec_u_px(const Quantiser& quantiser, Lag lag, double slope_rms, double area_px);

// Quantisers by observation and marker, as they are to be reckoned with: skipped blocks report no step of their own, so
// the largest that stood round about counts; where the stream says nothing, one of H.264's usual ones is assumed.
class CodecHistory {
 public:
  CodecHistory(const Reference& reference, const Observations& observations);
  [[nodiscard]] bool is_lossy() const { return lossy_; }
  // Of the n-th observation.
  [[nodiscard]] Quantiser at(std::size_t n, std::size_t marker) const;
  [[nodiscard]] Quantiser in_reference_frame(std::size_t marker) const;
  // A target's movement is its own; in frame 0, which is always a key frame, there is none yet to lag.
  [[nodiscard]] Lag lag_of(std::size_t marker) const { return is_target_[marker] ? Lag::kOwn : Lag::kShared; }
  [[nodiscard]] Lag lag_in_reference_frame(std::size_t marker) const {
    return starts_with_key_frame_ ? Lag::kShared : lag_of(marker);
  }

 private:
  struct Step {
    float step = 0.0F;
    bool predicted = false;
  };
  std::vector<Step> steps_;  // by observation, then marker
  std::vector<Quantiser> then_;
  std::vector<bool> is_target_;
  bool starts_with_key_frame_ = true;
  bool lossy_ = false;
};

// The frame's patches with the codec's error in their covariance: u in each coordinate of each of the nine points, and
// once more in common to the nine.
[[nodiscard]] BundleFrame with_codec_error(const BundleFrame& frame, const CodecHistory& codec,
                                           std::optional<std::size_t> observation);  // none: the reference frame

// Of a raster's reading: its modulation is that of the print's fundamental. mm along the board's axes.
[[nodiscard]] BoardExtent codec_mm(const Reference& reference, std::size_t marker, const PatchReading& patch,
                                   const Quantiser& quantiser, Lag lag);

}  // namespace moiregauge::internal
