// SPDX-License-Identifier: Apache-2.0
// Tone curves of cameras: which grey level they store for how much light.
#pragma once

#include <optional>
#include <string>

namespace moiregauge::internal::simulator {

// Light and grey levels of 0 to 255 are mapped onto each other, 0 to 0 and 255 to 255. x is light / 255, cut to 0 to 1.
struct ToneCurve {
  enum class Kind {
    kLinear,  // y = x
    kSrgb,    // IEC 61966-2-1: 12.92 x up to 0.0031308, then 1.055 x^(1 / 2.4) - 0.055
    kBt709,   // ITU-R BT.709: 4.5 x below 0.018, then 1.099 x^0.45 - 0.099
    kGamma    // y = x^(1 / gamma)
  };
  Kind kind = Kind::kLinear;
  double gamma = 2.2;
  // An S-curve on top of it: y - contrast sin(2 pi y) / (2 pi). At 1 black and white have slope 0, the middle slope 2.
  double contrast = 0.0;
  [[nodiscard]] bool is_linear() const { return kind == Kind::kLinear && contrast == 0.0; }
};

inline constexpr double kUsualContrast = 0.4;  // "s-curve" without a number

// Reads "linear", "srgb", "bt709", "gamma:2.2", "s-curve" or "s-curve:0.4"; an S-curve is that of sRGB.
[[nodiscard]] std::optional<ToneCurve> tone_named(const std::string& text);

// Returns the grey level that the curve makes of light, both 0 to 255.
[[nodiscard]] double encoded(const ToneCurve& tone, double light);

}  // namespace moiregauge::internal::simulator
