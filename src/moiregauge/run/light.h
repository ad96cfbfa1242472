// SPDX-License-Identifier: Apache-2.0
// The step from grey levels to light that comes before all measuring (image/tone.h).
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Pictures of one recording, mapped to light where their tone curve is not a straight line.
class LightMap {
 public:
  LightMap() = default;
  LightMap(const Tone& tone, int bits);
  // Returns the picture to measure; of a mapped one it is valid until the next call. `rounding` is in its units already.
  [[nodiscard]] GreyPicture picture(const LumaView& luma, double rounding = 0.0);
  [[nodiscard]] bool maps() const { return !table_.empty(); }
  [[nodiscard]] const Tone& tone() const { return tone_; }

 private:
  Tone tone_;
  int bits_ = 8;
  std::vector<std::uint16_t> table_;  // empty: grey levels are light
  Image<std::uint16_t> light_;
};

// Are the edges of the reference frame's prints, measured in grey levels, those of light? Not known where they show no curve.
[[nodiscard]] bool shows_light(const Reference& reference, int bits);

// Returns the tone curve that the edges of the reference frame's prints show, where they contradict the one by which the
// frame was mapped: a power of the grey level. Returns nothing where they agree with it or show none.
[[nodiscard]] std::optional<Tone> contradicting_tone(const Reference& reference, const Tone& mapped_by, int bits);

// Returns light per grey level over every marker of the reference frame: the ratio of both pictures' scatter there.
[[nodiscard]] std::vector<double> light_per_grey(const Reference& reference, const LumaView& stored,
                                                 const LumaView& light);

}  // namespace moiregauge::internal
