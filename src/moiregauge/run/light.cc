// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/light.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "moiregauge/phase/fit/tone_evidence.h"
#include "moiregauge/run/codec.h"

namespace moiregauge::internal {
namespace {

// Largest deviation of the exponent from 1 that is no tone curve. Ink that spreads and light scatter in paper make
// edges asymmetric, which looks like an exponent up to 0.1 from 1.
constexpr double kSameExponent = 0.1;
constexpr double kSureOfIt = 3.0;                   // deviation that proves a curve, in u
constexpr double kMaxU = 0.2;                       // largest u of an exponent that is applied (chosen)
constexpr double kMinGamma = 0.5, kMaxGamma = 3.5;  // range of camera exponents (chosen)
constexpr double kGammaSteps = 100.0;               // steps of the rounded exponent per 1

bool differs(const ToneExponent& exponent) {
  return std::abs(exponent.value - 1.0) > std::max(kSameExponent, kSureOfIt * exponent.u);
}

double scatter_in(const LumaView& luma, const PixelRectangle& at) {
  double sum = 0.0, sum2 = 0.0, count = 0.0;
  std::visit(
      [&](const auto& picture) {
        const auto inside = [](double v, int most) { return static_cast<int>(std::clamp(v, 0.0, double(most))); };
        const int x1 = inside(at.x1, picture.width), y1 = inside(at.y1, picture.height);
        for (int y = inside(at.y0, picture.height); y < y1; ++y) {
          for (int x = inside(at.x0, picture.width); x < x1; ++x) {
            const double grey = picture.at(x, y);
            sum += grey, sum2 += grey * grey, count += 1.0;
          }
        }
      },
      luma);
  return count > 1.0 ? std::sqrt(std::max(0.0, sum2 / count - (sum / count) * (sum / count))) : 0.0;
}

}  // namespace

LightMap::LightMap(const Tone& tone, int bits) : tone_(tone), bits_(bits) {
  if (!tone.curve.is_linear()) table_ = light_table(tone.curve, bits);
}

GreyPicture LightMap::picture(const LumaView& luma, double rounding) {
  if (!maps()) return {luma, bits_, rounding};
  to_light(luma, table_, light_);
  return {light_.view(), kLightBits, rounding};
}

namespace {

// `most`: the highest level of the measured image. Samples are relative to it.
std::vector<ToneSample> samples_of(const Reference& reference, double most) {
  std::vector<ToneSample> samples;
  for (std::size_t i = 0; i < reference.prints.size(); ++i) {
    const auto& points = reference.seen.markers[i].points;
    if (!reference.prints[i] || !points) continue;
    samples.push_back({&reference.prints[i]->print, points->light[0] / most, points->gain[0] / most});
  }
  return samples;
}

}  // namespace

bool shows_light(const Reference& reference, int bits) {
  const auto exponent = edge_exponent(samples_of(reference, std::exp2(bits) - 1.0), {});
  return exponent && !differs(*exponent);
}

std::optional<ShownTone> contradicting_tone(const Reference& reference, const Tone& mapped_by, int bits) {
  const auto samples = samples_of(reference, mapped_by.curve.is_linear() ? std::exp2(bits) - 1.0 : kMaxLight);
  ToneCurve as_measured = mapped_by.curve;
  if (!as_measured.is_linear()) as_measured = {};
  const auto exponent = edge_exponent(samples, as_measured);
  if (!exponent || !differs(*exponent)) return std::nullopt;
  const auto gamma = edge_exponent(samples, mapped_by.curve);
  if (!gamma || !(gamma->u < kMaxU) || !(gamma->value > kMinGamma && gamma->value < kMaxGamma)) return std::nullopt;
  Tone tone{{.kind = ToneCurve::Kind::kGamma, .gamma = std::round(kGammaSteps * gamma->value) / kGammaSteps},
            ToneSource::kFootage};
  tone.curve.is_full_range = mapped_by.curve.is_full_range;
  if (!differs(*gamma)) tone.curve = {.is_full_range = mapped_by.curve.is_full_range};
  if (tone.curve == mapped_by.curve || (tone.curve.is_linear() && mapped_by.curve.is_linear())) return std::nullopt;
  return ShownTone{tone, std::abs(std::log(exponent->value))};
}

std::vector<double> light_per_grey(const Reference& reference, const LumaView& stored, const LumaView& light) {
  std::vector<double> ratios;
  for (const Marker& marker : reference.site.markers) {
    const PixelRectangle at = rectangle_round(marker, {}, reference.view);
    const double grey = scatter_in(stored, at);
    ratios.push_back(grey > 0.0 ? scatter_in(light, at) / grey : 1.0);
  }
  return ratios;
}

}  // namespace moiregauge::internal
