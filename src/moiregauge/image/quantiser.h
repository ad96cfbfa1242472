// SPDX-License-Identifier: Apache-2.0
// What a lossy codec was allowed to round away: the step of its quantiser.
//
// Codecs transform blocks of the picture, or of its difference from a prediction, and round every coefficient to a
// multiple of a step. Steps are stated here for an orthonormal transform, in grey levels of the picture as stored: a
// coefficient then weighs as much as one pixel. An uncompressed picture, and a lossless codec's, has step 0.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

struct Quantiser {
  double step = 0.0;       // grey levels; 0: nothing is lost; NaN: something is, how much is not known
  bool predicted = false;  // blocks may be taken from other frames: a small movement may be left out altogether

  [[nodiscard]] bool is_lossless() const { return step == 0.0; }
};
inline constexpr double kUnknownStep = std::numeric_limits<double>::quiet_NaN();
// Where the stream does not tell: that of a telephone's H.264 at parameter 28, 8 bits.
inline constexpr double kUsualStep = 15.9;
[[nodiscard]] inline double step_or_usual(double step) { return std::isnan(step) ? kUsualStep : step; }

// Coefficients are off by up to a step where they were dropped and half of one where they were kept: a pixel by half a
// step, rms, at most.
[[nodiscard]] inline double rounding_of_step(double step) { return 0.5 * step; }
// How far a print may move before its codec shows it, px: a block of 8 x 8 pixels whose grey levels slope by g (rms, per
// px) changes by 8 g a pixel of movement in one coefficient.
[[nodiscard]] inline double dead_zone_px(double step, double slope_rms) { return step / (8.0 * slope_rms); }
// Motion vectors are multiples of a quarter of a pixel, and cost little: of a faint print no more than half of one is
// left, or about so much.
inline constexpr double kMaxLag_px = 0.12;

// H.264's scale, a step of 0.625 at 0 and twice as much every 6 (ITU-T H.264, 8.5.9); other codecs' steps are put on
// it.
[[nodiscard]] inline double step_of_parameter(int parameter) { return 0.625 * std::exp2(parameter / 6.0); }
inline constexpr int kMaxParameter = 87;  // 51, and 6 for each bit beyond 8
[[nodiscard]] std::uint8_t parameter_of_step(double step);

inline constexpr int kQuantiserBlock = 16;  // px
[[nodiscard]] inline int blocks_across(int pixels) { return (pixels + kQuantiserBlock - 1) / kQuantiserBlock; }

// Of one picture.
struct QuantiserMap {
  Quantiser whole;                 // its blocks' mean step
  ImageView<std::uint8_t> blocks;  // parameters, a block of 16 px each; no rows: `whole` everywhere

  // In the rectangle from (x0, y0) to (x1, y1), px: the upper quartile of the blocks it touches, for blocks that were
  // skipped report whatever step stood there before.
  [[nodiscard]] Quantiser within(double x0, double y0, double x1, double y1) const;
};

// Of a JPEG quantisation table in zigzag order: rms of entries 1 to 20 (all up to two and a half periods a block but
// the mean), which is where prints of four pixels a period and more keep their movement.
[[nodiscard]] double step_of_jpeg_table(std::span<const std::uint16_t, 64> zigzag);

}  // namespace moiregauge::internal
