// SPDX-License-Identifier: Apache-2.0
// Maps grey levels to light before the measurement (image/tone.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Maps the images of one recording to light, unless its tone curve is linear.
class LightMap {
 public:
  LightMap() = default;
  LightMap(const Tone& tone, int bits);
  // Returns the image to measure. A mapped image is valid until the next call. `rounding` must be in units of the
  // result.
  [[nodiscard]] GreyPicture picture(const LumaView& luma, double rounding = 0.0);
  // Returns the light per grey level, in the units of picture(). Empty: grey levels are light.
  [[nodiscard]] std::span<const std::uint16_t> table() const { return table_; }
  [[nodiscard]] bool maps() const { return !table_.empty(); }
  [[nodiscard]] const Tone& tone() const { return tone_; }

 private:
  Tone tone_;
  int bits_ = 8;
  std::vector<std::uint16_t> table_;  // light per grey level; empty: grey levels are light
  Image<std::uint16_t> light_;
};

// Returns true if the grating edges of the reference frame, measured in grey levels, are those of light. Returns false
// if they determine no curve.
[[nodiscard]] bool shows_light(const Reference& reference, int bits);

struct ShownTone {
  Tone tone;
  double deviation = 0.0;  // |ln e| of the exponent e that still makes the edges symmetric
};

// Returns the tone curve that the grating edges of the reference frame show, if it contradicts `mapped_by`. Returns
// nothing if the edges agree with `mapped_by` or determine no curve. Model: light is a power of the grey level.
[[nodiscard]] std::optional<ShownTone> contradicting_tone(const Reference& reference, const Tone& mapped_by, int bits);

// Returns the light levels per grey level at every marker of the reference frame. It is the ratio of the standard
// deviations in both images there.
[[nodiscard]] std::vector<double> light_per_grey(const Reference& reference, const LumaView& stored,
                                                 const LumaView& light);

}  // namespace moiregauge::internal
