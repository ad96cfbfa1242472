// SPDX-License-Identifier: Apache-2.0
// Error of a displacement from a lossy codec (docs/methods/precise/codec.md).
//
// A grating that moves by d px changes its pixels by g d, with g the slope of the grey levels, rms over the grating. If
// a codec predicts a block from another frame, it stores the change only above about one quantisation step. A block of
// 8 x 8 pixels therefore stays unchanged below the dead zone.
//
//     d0 = step / (8 g)     px
//
// The whole grating lags, so the error does not average out, and its pixels do not look noisier. Beyond a quarter of a
// pixel the encoder moves the block instead, so the error is limited for faint gratings.
// References that follow a moving camera share most of their lag, which then cancels. A target's lag is its own.
// Without prediction (Motion JPEG, key frames) errors differ between blocks and average out over the grating. The rest
// shows in its residuals.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/observation/reference/observations.h"
#include "moiregauge/planning/reference_weights.h"

namespace moiregauge::internal {

// Standard uncertainty as a share of the dead zone: 0.55 for a target (kOwn), 0.2 for references (kShared).
// Source: x264, constant rate factors 18 to 28, gratings of 60 to 170 grey levels. Targets that creep before a still
// camera have errors of 0.1 to 0.6 of it rms, at most 1.1. References before a moving camera differ by at most 0.2.
enum class Lag { kOwn, kShared };

// Standard uncertainties along one axis. The whole grating lags. Rounding is independent in every block.
struct CodecParts {
  double lag = 0.0, rounding = 0.0;
};

// Return both parts, or the standard uncertainty by both, along one axis, px. 0 if nothing is lost, or if the grating
// does not show the axis.
// `slope_rms`: slope of the grey levels along the axis, grey levels/px. `area_px`: area of the grating, px^2.
[[nodiscard]] CodecParts codec_parts_px(const Quantiser& quantiser, Lag lag, double slope_rms, double area_px);
[[nodiscard]] double codec_u_px(const Quantiser& quantiser, Lag lag, double slope_rms, double area_px);

// Quantisers by observation and marker. Skipped blocks report the step of an earlier block, so the largest step within
// 16 frames counts. An unknown step counts as that of a usual H.264 stream.
class CodecHistory {
 public:
  CodecHistory(const Reference& reference, const Observations& observations);
  [[nodiscard]] bool is_lossy() const { return lossy_; }
  // Returns the quantiser at a marker in the n-th observation.
  [[nodiscard]] Quantiser at(std::size_t n, std::size_t marker) const;
  [[nodiscard]] Quantiser in_reference_frame(std::size_t marker) const;
  // Returns the quantisers of a frame after these observations, by marker. The frames after it are not known.
  [[nodiscard]] std::vector<Quantiser> of_next(const Reference& reference, const Observation& seen) const;
  // A target's movement is its own. Frame 0 is always a key frame, which does not lag.
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

// Returns the frame with the codec's error in the points' covariance. Lag counts once for each coordinate of the nine
// points and once in common. Rounding counts for each point with its ninth of the area.
// `observation`: its index; nothing for the reference frame.
[[nodiscard]] BundleFrame with_codec_error(const BundleFrame& frame, const CodecHistory& codec,
                                           std::optional<std::size_t> observation);
// Does the same for a frame after the observations of `codec`. `quantisers`: by marker.
[[nodiscard]] BundleFrame with_codec_error(const BundleFrame& frame, const CodecHistory& codec,
                                           const std::vector<Quantiser>& quantisers);

// Returns the error of a raster reading, mm along the board's axes. Its slope follows from the modulation of the
// fundamental.
[[nodiscard]] BoardExtent codec_mm(const Reference& reference, std::size_t marker, const PatchReading& patch,
                                   const Quantiser& quantiser, Lag lag);

}  // namespace moiregauge::internal
