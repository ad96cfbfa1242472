// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/reading_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
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

ReadingNoise::ReadingNoise(const Reference& reference, std::size_t max_slopes)
    : last_(reference.plans.size()), max_slopes_(max_slopes) {
  for (const RasterPlan& plan : reference.plans) {
    const bool is_used = plan.reads_x && plan.reads_y && plan.pitch_mm > 0.0;
    slope_per_rad_.push_back(is_used ? slope_noise_per_mean(plan) * plan.pitch_mm / kTwoPi / plan.step_mm : 0.0);
  }
}

void ReadingNoise::add(const Observation& seen) {
  for (std::size_t i = 0; i < last_.size(); ++i) {
    const bool is_read = slope_per_rad_[i] > 0.0 && !seen.decode_error && seen.markers[i].loss == Loss::kNone &&
                         seen.markers[i].patch.valid;
    std::optional<Slopes> now;
    if (is_read) now = {seen.markers[i].patch.gradient, seen.markers[i].patch.u_phase_rad};
    if (now && last_[i]) add_change(*last_[i], *now, slope_per_rad_[i]);
    last_[i] = now;
  }
}

// Adds the squares of the changes of a grating's slopes, relative to those of independent pixels.
void ReadingNoise::add_change(const Slopes& before, const Slopes& now, double slope_per_rad) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double u = slope_per_rad * std::hypot(before.u_phase_rad[axis], now.u_phase_rad[axis]);
    for (std::size_t along = 0; along < 2; ++along) {
      const double square = std::pow((now.gradient[axis][along] - before.gradient[axis][along]) / u, 2);
      if (!std::isfinite(square)) continue;
      if (squares_.size() < max_slopes_)
        squares_.push_back(square);
      else
        squares_[next_++ % max_slopes_] = square;
    }
  }
}

double ReadingNoise::excess() const {
  if (squares_.size() < kMinSlopes) return 1.0;
  std::vector<double> squares = squares_;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  const double ratio = std::sqrt(*middle / kMedianOfSquare);
  return ratio < kIndependent ? 1.0 : ratio;
}

double noise_excess(const Reference& reference, const Observations& observations) {
  ReadingNoise noise(reference, std::numeric_limits<std::size_t>::max());
  const std::size_t step = observations.size() / kMaxPairs + 1;
  for (std::size_t n = 1; n < observations.size(); n += step) {
    noise.forget_frame();
    noise.add(observations[n - 1]);
    noise.add(observations[n]);
  }
  return noise.excess();
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
