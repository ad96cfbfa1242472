// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/scenario/tone.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/simulator/scenario/scenario.h"
#include "moiregauge/simulator/scenario/setting_collector.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {
namespace {

double curve(const ToneCurve& tone, double x) {
  switch (tone.kind) {
    case ToneCurve::Kind::kSrgb:
      return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
    case ToneCurve::Kind::kBt709:
      return x < 0.018 ? 4.5 * x : 1.099 * std::pow(x, 0.45) - 0.099;
    case ToneCurve::Kind::kGamma:
      return std::pow(x, 1.0 / tone.gamma);
    default:
      return x;
  }
}

}  // namespace

std::optional<ToneCurve> tone_named(const std::string& text) {
  using Kind = ToneCurve::Kind;
  if (text == "linear") return ToneCurve{};
  if (text == "srgb") return ToneCurve{.kind = Kind::kSrgb};
  if (text == "bt709") return ToneCurve{.kind = Kind::kBt709};
  if (text == "s-curve") return ToneCurve{.kind = Kind::kSrgb, .contrast = kUsualContrast};
  const auto colon = text.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const std::string word = text.substr(0, colon);
  const auto number = number_in(text.substr(colon + 1));
  if (!number) return std::nullopt;
  if (word == "gamma" && *number > 0.1 && *number < 10.0) return ToneCurve{.kind = Kind::kGamma, .gamma = *number};
  if (word == "s-curve" && *number >= 0.0 && *number <= 1.0) return ToneCurve{.kind = Kind::kSrgb, .contrast = *number};
  return std::nullopt;
}

double encoded(const ToneCurve& tone, double light) {
  const double y = curve(tone, std::clamp(light / 255.0, 0.0, 1.0));
  return 255.0 * (tone.contrast == 0.0 ? y : y - tone.contrast * std::sin(kTwoPi * y) / kTwoPi);
}

bool stores_light(const Scenario& scenario) {
  return scenario.sensor.gamma == 1.0 && scenario.processing.tone.is_linear() &&
         scenario.processing.local_tone.strength == 0.0;
}

}  // namespace moiregauge::internal::simulator
