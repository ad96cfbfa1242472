// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/reading_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Largest ratio that independent pixels may show. Simulated scenes give 0.89 to 1.05. Chosen.
constexpr double kIndependent = 1.2;
// Least number of slopes: u of the ratio is 0.17 then. Chosen.
constexpr std::size_t kMinSlopes = 100;
// Largest number of pairs of frames, which are spread over the run. Chosen.
constexpr std::size_t kMaxPairs = 1000;
constexpr double kMedianOfSquare = 0.4549;  // median of chi2 with one degree of freedom

bool is_readable(const MarkerObservation& seen) { return seen.loss == Loss::kNone && seen.patch.valid; }

// Adds the squares of the changes of a grating's slopes, relative to those of independent pixels.
void add_slopes(const RasterPlan& plan, double slope_per_mean, const PatchReading& a, const PatchReading& b,
                std::vector<double>& squares) {
  const double per_rad = slope_per_mean * plan.pitch_mm / kTwoPi / plan.step_mm;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double u = per_rad * std::hypot(a.u_phase_rad[axis], b.u_phase_rad[axis]);
    for (std::size_t along = 0; along < 2; ++along) {
      const double square = std::pow((b.gradient[axis][along] - a.gradient[axis][along]) / u, 2);
      if (std::isfinite(square)) squares.push_back(square);
    }
  }
}

std::string noise_note(double excess) {
  return fmt::format(
      "note: the noise of neighbouring pixels is alike, as after a blur or an enlargement. So u contains {:.1f} times "
      "the noise of independent pixels. Record at the sensor's own resolution without filters to avoid this",
      excess);
}

}  // namespace

double slope_noise_per_mean(const RasterPlan& plan) {
  const int period = plan.sampling_pitch_px, side = plan.region_px;
  const double middle = 0.5 * (side - 1);
  double mean2 = 0.0, slope2 = 0.0, lever = 0.0;
  for (int pixel = -period; pixel < side + period; ++pixel) {
    double mean = 0.0, slope = 0.0;
    for (int at = std::max(0, pixel - period); at <= std::min(side - 1, pixel + period); ++at) {
      const double weight = period - std::abs(pixel - at);
      mean += weight, slope += weight * (at - middle);
    }
    mean2 += mean * mean, slope2 += slope * slope;
  }
  for (int at = 0; at < side; ++at) lever += std::pow(at - middle, 2);
  return std::sqrt(slope2 / mean2) * side / lever;
}

double noise_excess(const Reference& reference, const Observations& observations) {
  if (observations.size() < 2) return 1.0;
  std::vector<double> per_mean;
  for (const RasterPlan& plan : reference.plans)
    per_mean.push_back(plan.reads_x && plan.reads_y && plan.pitch_mm > 0.0 ? slope_noise_per_mean(plan) : 0.0);
  std::vector<double> squares;
  const std::size_t step = observations.size() / kMaxPairs + 1;
  for (std::size_t n = 1; n < observations.size(); n += step) {
    const Observation before = observations[n - 1], now = observations[n];
    if (before.decode_error || now.decode_error) continue;
    for (std::size_t i = 0; i < per_mean.size(); ++i) {
      if (!(per_mean[i] > 0.0) || !is_readable(before.markers[i]) || !is_readable(now.markers[i])) continue;
      add_slopes(reference.plans[i], per_mean[i], before.markers[i].patch, now.markers[i].patch, squares);
    }
  }
  if (squares.size() < kMinSlopes) return 1.0;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  const double ratio = std::sqrt(*middle / kMedianOfSquare);
  return ratio < kIndependent ? 1.0 : ratio;
}

Observation with_noise(Observation seen, double excess) {
  for (MarkerObservation& marker : seen.markers) {
    for (double& u : marker.patch.u_phase_rad) u *= excess;
    marker.patch.u_gradient *= excess;
    marker.patch.u_straightness_mm *= excess;
  }
  return seen;
}

Solution solve_in_own_noise(const Reference& reference, const Observations& observations, SolveInNoise solve) {
  const CodecHistory codec(reference, observations);
  const double excess = codec.is_lossy() ? 1.0 : noise_excess(reference, observations);
  if (!(excess > 1.0)) return solve(reference, observations, codec, 1.0);
  Reference noisier = reference;
  noisier.seen = with_noise(std::move(noisier.seen), excess);
  Solution solution = solve(noisier, observations, codec, excess);
  solution.notes.push_back(noise_note(excess));
  return solution;
}

}  // namespace moiregauge::internal
