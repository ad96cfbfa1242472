// SPDX-License-Identifier: Apache-2.0
// The tone curve between light and the grey levels of a picture. Cameras for people store grey levels that are far from
// proportional to light, and an edge blurred in light is no longer symmetric in grey levels: more blur then moves it.
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
  double gamma = 1.0;         // of kGamma: light = grey^gamma
  bool is_full_range = true;  // false: black at 16 and white at 235 of 255, as in video

  [[nodiscard]] bool is_linear() const { return kind == Kind::kLinear || (kind == Kind::kGamma && gamma == 1.0); }
  friend bool operator==(const ToneCurve&, const ToneCurve&) = default;
};

// A recording's tone curve, and what says so.
enum class ToneSource {
  kAssumed,  // usual for this kind of file, which does not say
  kTag,      // the file or stream says so
  kOption,   // the user does
  kFootage   // the edges of the prints show it
};
struct Tone {
  ToneCurve curve;
  ToneSource source = ToneSource::kAssumed;
};
[[nodiscard]] std::string_view name_of(ToneSource source);

// Returns the light that caused a grey level; both relative to white (1). Continues each curve beyond white, and
// gives 0 below black. Sources: IEC 61966-2-1 (sRGB), ITU-R BT.709-6, ITU-R BT.2100-2 (HLG, PQ).
[[nodiscard]] double light_of(const ToneCurve& curve, double grey);

// Returns the light of every grey level of `bits` bits, in 16 bits: 0 for the lowest light, kMaxLight for the highest.
[[nodiscard]] std::vector<std::uint16_t> light_table(const ToneCurve& curve, int bits);
inline constexpr int kLightBits = 16;
inline constexpr double kMaxLight = 65535.0;

// Writes the light of every pixel into `light`, which takes the picture's size. `table` holds all levels of the picture.
void to_light(const LumaView& luma, const std::vector<std::uint16_t>& table, Image<std::uint16_t>& light);

// Returns a curve's name as --tone takes it (`gamma:2.2`).
[[nodiscard]] std::string name_of(const ToneCurve& curve);
// Returns the curve of a name; nothing for another word, or a gamma outside 0.2 to 5.
[[nodiscard]] std::optional<ToneCurve> tone_curve_named(std::string_view name);

}  // namespace moiregauge::internal
