// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/image/tone.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <variant>

namespace moiregauge::internal {
namespace {

using Kind = ToneCurve::Kind;

constexpr std::array kNames{
    std::pair{Kind::kLinear, std::string_view("linear")}, std::pair{Kind::kSrgb, std::string_view("srgb")},
    std::pair{Kind::kBt709, std::string_view("bt709")}, std::pair{Kind::kHlg, std::string_view("hlg")},
    std::pair{Kind::kPq, std::string_view("pq")}};
constexpr std::string_view kGammaPrefix = "gamma:";
constexpr double kMinGamma = 0.2, kMaxGamma = 5.0;  // limits of `gamma:`; chosen

// Returns the light of a level by ITU-R BT.2100-2 (HLG), relative to white.
double hlg_light(double v) {
  constexpr double kA = 0.17883277, kB = 1.0 - 4.0 * kA, kC = 0.55991073;
  return v <= 0.5 ? v * v / 3.0 : (std::exp((v - kC) / kA) + kB) / 12.0;
}

// Returns the light of a level by ITU-R BT.2100-2 (PQ), relative to 10 000 cd/m^2.
double pq_light(double v) {
  constexpr double kM1 = 2610.0 / 16384.0, kM2 = 2523.0 / 32.0;
  constexpr double kC1 = 3424.0 / 4096.0, kC2 = 2413.0 / 128.0, kC3 = 2392.0 / 128.0;
  const double p = std::pow(v, 1.0 / kM2);
  return std::pow(std::max(0.0, p - kC1) / (kC2 - kC3 * p), 1.0 / kM1);
}

constexpr std::array kSources{std::pair{ToneSource::kAssumed, std::string_view("assumed")},
                              std::pair{ToneSource::kTag, std::string_view("tag")},
                              std::pair{ToneSource::kOption, std::string_view("option")},
                              std::pair{ToneSource::kFootage, std::string_view("footage")}};

}  // namespace

std::string_view name_of(ToneSource source) {
  for (const auto& [value, name] : kSources) {
    if (value == source) return name;
  }
  return {};
}

double light_of(const ToneCurve& curve, double grey) {
  constexpr double kBlack = 16.0 / 255.0, kRange = 219.0 / 255.0;  // ITU-R BT.709-6: black 16, white 235
  const double v = std::max(0.0, curve.is_full_range ? grey : (grey - kBlack) / kRange);
  switch (curve.kind) {
    case Kind::kLinear:
      return v;
    case Kind::kSrgb:
      return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    case Kind::kBt709:
      return v < 0.081 ? v / 4.5 : std::pow((v + 0.099) / 1.099, 1.0 / 0.45);
    case Kind::kHlg:
      return hlg_light(v);
    case Kind::kPq:
      return pq_light(std::min(v, 1.0));
    case Kind::kGamma:
      return std::pow(v, curve.gamma);
  }
  return v;
}

std::vector<std::uint16_t> light_table(const ToneCurve& curve, int bits) {
  const int levels = 1 << bits;
  const double most = light_of(curve, 1.0);
  std::vector<std::uint16_t> table;
  table.reserve(static_cast<std::size_t>(levels));
  for (int grey = 0; grey < levels; ++grey)
    table.push_back(
        static_cast<std::uint16_t>(std::lround(kMaxLight * light_of(curve, double(grey) / (levels - 1)) / most)));
  return table;
}

void to_light(const LumaView& luma, const std::vector<std::uint16_t>& table, Image<std::uint16_t>& light) {
  if (light.width() != width_of(luma) || light.height() != height_of(luma))
    light = Image<std::uint16_t>(width_of(luma), height_of(luma));
  const std::size_t highest = table.size() - 1;
  std::visit(
      [&](const auto& picture) {
        for (int y = 0; y < picture.height; ++y) {
          const auto from = picture.row(y);
          std::transform(from.begin(), from.end(), light.row(y).begin(),
                         [&](auto grey) { return table[std::min<std::size_t>(grey, highest)]; });
        }
      },
      luma);
}

std::string name_of(const ToneCurve& curve) {
  for (const auto& [kind, name] : kNames) {
    if (kind == curve.kind) return std::string(name);
  }
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), curve.gamma).ptr;
  return std::string(kGammaPrefix) + std::string(digits.data(), end);
}

std::optional<ToneCurve> tone_curve_named(std::string_view name) {
  for (const auto& [kind, word] : kNames) {
    if (word == name) return ToneCurve{.kind = kind};
  }
  if (!name.starts_with(kGammaPrefix)) return std::nullopt;
  const std::string_view digits = name.substr(kGammaPrefix.size());
  double gamma = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), gamma);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  if (!(gamma >= kMinGamma && gamma <= kMaxGamma)) return std::nullopt;
  return ToneCurve{.kind = Kind::kGamma, .gamma = gamma};
}

}  // namespace moiregauge::internal
