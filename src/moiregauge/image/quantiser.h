// SPDX-License-Identifier: Apache-2.0
// Quantiser of a lossy codec: the step to which it rounds.
//
// Codecs transform blocks of the image, or of its difference from a prediction, and round every coefficient to a
// multiple of a step. Here steps are those of an orthonormal transform, in grey levels of the stored image, so a
// coefficient counts as much as one pixel. Uncompressed and lossless images have step 0.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

struct Quantiser {
  double step = 0.0;       // grey levels; 0: lossless; NaN: lossy, but unknown
  bool predicted = false;  // blocks may be copied from other frames: small movements may be missing

  [[nodiscard]] bool is_lossless() const { return step == 0.0; }
  // Returns true if the codec itself may show parts of other frames, as a camera that averages does.
  [[nodiscard]] bool shows_other_frames() const { return predicted && !is_lossless(); }
};
inline constexpr double kUnknownStep = std::numeric_limits<double>::quiet_NaN();  // lossy, but unknown
// Assumed if the stream does not report it: that of a phone's H.264 at parameter 28, 8 bits.
inline constexpr double kUsualStep = 15.9;
[[nodiscard]] inline double step_or_usual(double step) { return std::isnan(step) ? kUsualStep : step; }

// Returns the largest rms error of a pixel, grey levels. Coefficients are wrong by up to a step if they were dropped,
// and by half a step if they were kept.
[[nodiscard]] inline double rounding_of_step(double step) { return 0.5 * step; }
// Returns the dead zone: the largest movement of a grating that the codec may suppress, px. Let g be the rms slope of
// the grey levels per px. A block of 8 x 8 pixels then changes by 8 g per px of movement in one coefficient.
[[nodiscard]] inline double dead_zone_px(double step, double slope_rms) { return step / (8.0 * slope_rms); }
// Largest lag, px. Motion vectors are multiples of a quarter of a pixel and cost little, so about half of that remains
// for faint gratings.
inline constexpr double kMaxLag_px = 0.12;

// Returns the step of a parameter on H.264's scale: 0.625 at 0, and twice as much every 6 (ITU-T H.264, 8.5.9).
// Steps of other codecs are expressed on it.
[[nodiscard]] inline double step_of_parameter(int parameter) { return 0.625 * std::exp2(parameter / 6.0); }
inline constexpr int kMaxParameter = 87;  // 51, and 6 for each bit beyond 8
// Returns the nearest parameter of a step.
[[nodiscard]] std::uint8_t parameter_of_step(double step);

inline constexpr int kQuantiserBlock = 16;  // px
[[nodiscard]] inline int blocks_across(int pixels) { return (pixels + kQuantiserBlock - 1) / kQuantiserBlock; }

// Quantisation of one image.
struct QuantiserMap {
  Quantiser whole;                 // mean step of its blocks
  ImageView<std::uint8_t> blocks;  // parameters, one per block of 16 px; no rows: `whole` everywhere

  // Returns the quantiser in the rectangle from (x0, y0) to (x1, y1), px: the upper quartile of the blocks that it
  // touches. Skipped blocks report the step of an earlier block.
  [[nodiscard]] Quantiser within(double x0, double y0, double x1, double y1) const;
};

// Returns the step of a JPEG quantisation table in zigzag order: the rms of entries 1 to 20. These are all up to two
// and a half periods per block, without the mean. They carry the movement of gratings with at least four pixels per
// period.
[[nodiscard]] double step_of_jpeg_table(std::span<const std::uint16_t, 64> zigzag);

}  // namespace moiregauge::internal
