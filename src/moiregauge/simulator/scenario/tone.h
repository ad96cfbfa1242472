// SPDX-License-Identifier: Apache-2.0
// Tone curves of cameras: relation between light and the stored grey level.
#pragma once

#include <optional>
#include <string>

namespace moiregauge::internal::simulator {

// Map from light (0 to 255) to grey levels (0 to 255). x is light / 255, clipped to 0 to 1.
struct ToneCurve {
  enum class Kind {
    kLinear,  // y = x
    kSrgb,    // IEC 61966-2-1: 12.92 x up to 0.0031308, then 1.055 x^(1 / 2.4) - 0.055
    kBt709,   // ITU-R BT.709: 4.5 x below 0.018, then 1.099 x^0.45 - 0.099
    kGamma    // y = x^(1 / gamma)
  };
  Kind kind = Kind::kLinear;
  double gamma = 2.2;
  // Additional S-curve: y - contrast sin(2 pi y) / (2 pi). At 1 the slope is 0 at black and white, 2 in the middle.
  double contrast = 0.0;
  [[nodiscard]] bool is_linear() const { return kind == Kind::kLinear && contrast == 0.0; }
};

inline constexpr double kUsualContrast = 0.4;  // "s-curve" without a number

// Reads "linear", "srgb", "bt709", "gamma:2.2", "s-curve" or "s-curve:0.4". An S-curve is added to sRGB. Empty for any
// other text, a gamma outside 0.1 to 10, or a contrast outside 0 to 1.
[[nodiscard]] std::optional<ToneCurve> tone_named(const std::string& text);

// Returns the grey level for an amount of light, both 0 to 255.
[[nodiscard]] double encoded(const ToneCurve& tone, double light);

}  // namespace moiregauge::internal::simulator
