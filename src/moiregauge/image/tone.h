// SPDX-License-Identifier: Apache-2.0
// Tone curve: relation between light and the grey levels of an image. Consumer cameras store grey levels that are not
// proportional to light. An edge blurred in light is not symmetric in grey levels, so more blur shifts it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

struct ToneCurve {
  enum class Kind { kLinear, kSrgb, kBt709, kHlg, kPq, kGamma };
  Kind kind = Kind::kLinear;
  double gamma = 1.0;         // for kGamma: light = grey^gamma
  bool is_full_range = true;  // false: black at 16 and white at 235 of 255, as in video

  [[nodiscard]] bool is_linear() const { return kind == Kind::kLinear || (kind == Kind::kGamma && gamma == 1.0); }
  friend bool operator==(const ToneCurve&, const ToneCurve&) = default;
};

// Tone curve of a recording, and its source.
enum class ToneSource {
  kAssumed,  // usual for this kind of file, which states none
  kTag,      // stated by the file or stream
  kOption,   // stated by the user
  kFootage   // determined from the edges of the gratings
};
struct Tone {
  ToneCurve curve;
  ToneSource source = ToneSource::kAssumed;
};
[[nodiscard]] std::string_view name_of(ToneSource source);

// Returns the light of a grey level, both relative to white (1). Each curve continues beyond white, and is 0 below
// black. Sources: IEC 61966-2-1 (sRGB), ITU-R BT.709-6, ITU-R BT.2100-2 (HLG, PQ).
[[nodiscard]] double light_of(const ToneCurve& curve, double grey);

// Returns the light of every grey level of `bits` bits, with 16 bits: 0 for the lowest level, kMaxLight for the
// highest.
[[nodiscard]] std::vector<std::uint16_t> light_table(const ToneCurve& curve, int bits);
inline constexpr int kLightBits = 16;
inline constexpr double kMaxLight = 65535.0;

// Writes the light of every pixel into `light`, which gets the image's size. `table` must contain all levels of the
// image.
void to_light(const LumaView& luma, const std::vector<std::uint16_t>& table, Image<std::uint16_t>& light);

// Returns a curve's name for --tone (`gamma:2.2`).
[[nodiscard]] std::string name_of(const ToneCurve& curve);
// Returns the curve of a name. Nothing for another word, or for a gamma outside 0.2 to 5.
[[nodiscard]] std::optional<ToneCurve> tone_curve_named(std::string_view name);

}  // namespace moiregauge::internal
