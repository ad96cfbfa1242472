// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/tone_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace moiregauge::internal {
namespace {

// All limits are chosen (docs/methods/precise/light.md).
constexpr int kLines = 48;    // per period
constexpr int kPoints = 256;  // along a line, per period
// Largest angle between edge and axis, rad, as the mean over a line weighted by the squared slope.
constexpr double kStraight = 0.05;
// Share of the slope power of the steepest line. A line with less runs between the edges.
constexpr double kSteep = 0.3;
constexpr double kFlat = 0.1;          // share of the steepest slope; flatter parts are black or white
constexpr double kMinFlatShare = 0.1;  // share of a line, for black and for white each
// Share of the period in which edges must be straight. That of a dot is straight over a twentieth only.
constexpr double kMinLines = 0.2;
// Range of the search.
constexpr double kMinExponent = 0.25, kMaxExponent = 4.0;
constexpr int kSteps = 14;  // in the search for a change of sign, each by a fifth
// Lowest level relative to white. The power of a lower one carries no information.
constexpr double kMinLevel = 1e-4;

using Profile = std::vector<double>;

// Returns grey levels (0 to 1) on lines across the straight edges of one axis. Returns none if too few lines are
// straight.
std::vector<Profile> straight_profiles(const ToneSample& sample, bool along_x, const ToneCurve& from,
                                       double (*grey_of)(const ToneCurve&, double)) {
  struct Line {
    Profile levels;
    double power = 0.0, lean = 0.0;
  };
  std::vector<Line> lines(kLines);
  double most = 0.0;
  for (int n = 0; n < kLines; ++n) {
    Line& line = lines[static_cast<std::size_t>(n)];
    for (int k = 0; k < kPoints; ++k) {
      const double s = (k + 0.5) / kPoints, c = (n + 0.5) / kLines;
      const PrintLevel at = sample.print->at(along_x ? PrintPoint{s, c} : PrintPoint{c, s});
      const double along = along_x ? at.dx : at.dy, across = along_x ? at.dy : at.dx;
      line.power += along * along;
      line.lean += std::abs(across * along);
      line.levels.push_back(grey_of(from, std::max(0.0, sample.level + sample.contrast * at.t)));
    }
    line.lean = line.power > 0.0 ? line.lean / line.power : 1.0;
    most = std::max(most, line.power);
  }
  std::vector<Profile> out;
  for (Line& line : lines) {
    if (line.power > kSteep * most && line.lean < kStraight) out.push_back(std::move(line.levels));
  }
  if (static_cast<double>(out.size()) < kMinLines * kLines) out.clear();
  return out;
}

// Returns the first moment of the level about the middle of black and white, weighted by the squared slope. It is 0 for
// symmetric edges, positive if their bright ends are steeper, and NaN without black or white.
double asymmetry(const std::vector<Profile>& profiles, double exponent) {
  double moment = 0.0, norm = 0.0;
  Profile level(kPoints), slope(kPoints);
  for (const Profile& grey : profiles) {
    std::ranges::transform(grey, level.begin(), [&](double g) { return std::pow(std::max(g, kMinLevel), exponent); });
    double steepest = 0.0;
    for (std::size_t k = 0; k < kPoints; ++k) {
      slope[k] = level[(k + 1) % kPoints] - level[(k + kPoints - 1) % kPoints];
      steepest = std::max(steepest, std::abs(slope[k]));
    }
    const auto [low, high] = std::ranges::minmax(level);
    double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
    for (std::size_t k = 0; k < kPoints; ++k) {
      if (std::abs(slope[k]) > kFlat * steepest) continue;
      const int side = level[k] > 0.5 * (low + high) ? 1 : 0;
      sum[side] += level[k], count[side] += 1.0;
    }
    if (std::min(count[0], count[1]) < kMinFlatShare * kPoints) return std::numeric_limits<double>::quiet_NaN();
    const double black = sum[0] / count[0], white = sum[1] / count[1], middle = 0.5 * (black + white);
    for (std::size_t k = 0; k < kPoints; ++k) {
      moment += (level[k] - middle) * slope[k] * slope[k];
      norm += (white - black) * slope[k] * slope[k];
    }
  }
  return norm > 0.0 ? moment / norm : std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> exponent_of(const std::vector<Profile>& profiles) {
  if (profiles.empty()) return std::nullopt;
  // Far from the true power, black or white may have no flat part. The change of sign is searched where both have one.
  double low = std::log(kMinExponent), high = low, before = asymmetry(profiles, kMinExponent);
  bool found = false;
  for (int k = 1; k <= kSteps && !found; ++k) {
    low = high;
    high = std::log(kMinExponent) + k * std::log(kMaxExponent / kMinExponent) / kSteps;
    const double now = asymmetry(profiles, std::exp(high));
    found = before < 0.0 && now > 0.0;
    before = now;
  }
  if (!found) return std::nullopt;
  for (int k = 0; k < 30; ++k) {
    const double middle = 0.5 * (low + high), there = asymmetry(profiles, std::exp(middle));
    if (std::isnan(there)) return std::nullopt;
    (there > 0.0 ? high : low) = middle;
  }
  return std::exp(0.5 * (low + high));
}

// Returns the grey level (0 to 1) of a light relative to white, by bisection of the curve.
double grey_by(const ToneCurve& curve, double light) {
  if (curve.is_linear()) return light;
  const double wanted = light * light_of(curve, 1.0);
  double low = 0.0, high = 1.5;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (light_of(curve, middle) > wanted ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::optional<ToneExponent> edge_exponent(std::span<const ToneSample> samples, const ToneCurve& from) {
  std::vector<double> logs;
  for (const ToneSample& sample : samples) {
    for (const bool along_x : {true, false}) {
      if (const auto e = exponent_of(straight_profiles(sample, along_x, from, grey_by))) logs.push_back(std::log(*e));
    }
  }
  if (logs.size() < 2) return std::nullopt;
  std::ranges::sort(logs);
  const double median = 0.5 * (logs[(logs.size() - 1) / 2] + logs[logs.size() / 2]);
  std::vector<double> off;
  off.reserve(logs.size());
  for (const double l : logs) off.push_back(std::abs(l - median));
  std::ranges::sort(off);
  const double scatter = 1.4826 * 0.5 * (off[(off.size() - 1) / 2] + off[off.size() / 2]);
  const double value = std::exp(median);
  return ToneExponent{value, value * 1.2533 * scatter / std::sqrt(static_cast<double>(logs.size())),
                      static_cast<int>(logs.size())};
}

}  // namespace moiregauge::internal
