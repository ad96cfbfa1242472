// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/smear_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Standard deviations over random phases, with F = 3.7, that of a binary grating at a point spread of usual width.
// Half a period of a sine has a third moment of up to 0.5 to 0.7 sigma^3, and of 0.35 sigma^3 in the mean square.
constexpr double kOwn = 0.22;
// 3 <c^2 s> of a camera at constant speed and a target with half a period: 1.6 sigma_c^2 sigma_s in the mean square.
constexpr double kWithCamera = 1.0;
constexpr double kLeast = 5e-5;     // pitches, least uncertainty that matters. Chosen.
constexpr double kFaintest = 0.05;  // least amplitude that counts. Chosen.
// Quantiles of the frames that count as the least and the most blur. Chosen.
constexpr double kSharpest = 0.05, kSoftest = 0.95;
// Quantile of the uncertainties that is that of the reference frame, whose blur is unknown. In a vibration it is near
// the rms. A jump in few exposures does not count. Chosen.
constexpr double kUsual = 0.7;
// Least variance of a vibration within any exposure: 0.11 R (R / D)^1.2. R is the range of the variances. D is the
// variance of the mean positions. It is within a tenth for 0.3 to 0.9 periods per exposure. At most 4 R, its value for
// 0.9.
constexpr double kConstant = 0.11, kPower = 1.2, kMostConstant = 4.0;
// Largest variance within an exposure in that of the mean positions. With 0.9 periods per exposure, a vibration shows
// a ninth of its amplitude. With a whole period it shows nothing, and is symmetric.
constexpr double kHidden = 100.0;
constexpr std::size_t kLags = 8;
constexpr double kTurned = 0.1;  // rad, up to which the print's axes are those of the board

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using AxisPair = std::array<double, 2>;  // along the board's x and y

// Returns true if a grating's axes are swapped, and nothing if they are oblique.
std::optional<bool> is_swapped(const Grating& grating) {
  const double quarters = grating.angle_rad / (0.5 * kPi), nearest = std::round(quarters);
  if (std::abs(quarters - nearest) * 0.5 * kPi > kTurned) return std::nullopt;
  return std::fmod(std::abs(nearest), 2.0) == 1.0;
}

// Returns the variance of the blur along both axes, mm^2, up to a constant. Oblique prints and checkerboards, whose
// waves are diagonal, give the mean for both. The contrast of a print is in proportion to its light, and the mean level
// does not change by blur. The fit's own contrast is no measure: blur and contrast of a print with few harmonics are
// alike.
AxisPair blur_variance(const PatchFit& fit, const Grating& grating) {
  AxisPair variance{kNaN, kNaN};
  const double unit = grating.pitch_mm * grating.pitch_mm / (2.0 * kPi * kPi);
  const auto variance_of = [&](double amplitude) {
    return amplitude > kFaintest && fit.light[0] > 0.0 ? -unit * std::log(amplitude / fit.light[0]) : kNaN;
  };
  if (grating.pattern == Pattern::kCheckerboard) {
    variance.fill(0.5 * variance_of(fit.fundamental[0] + fit.fundamental[1] - fit.gain[0]));
    return variance;
  }
  for (std::size_t a = 0; a < 2; ++a) variance[a] = variance_of(fit.fundamental[a]);
  const auto swapped = is_swapped(grating);
  if (!swapped) variance.fill(0.5 * (variance[0] + variance[1]));
  if (swapped.value_or(false)) std::swap(variance[0], variance[1]);
  return variance;
}

// Returns the square of the movement in the image since another frame, mm^2 on the print. `then`: image of the middle.
double movement_squared(const PatchFit& now, ImagePoint then, double pitch_mm) {
  const double across = now.print[5].x - now.print[3].x;
  const double mm_per_px = across > 0.0 ? pitch_mm * across / length(now.image[5] - now.image[3]) : kNaN;
  const double mm = length(now.image[4] - then) * mm_per_px;
  return mm * mm;
}

// Readings of one marker by frame, mm^2. That of the reference frame is missing, because its fit has another template.
using Series = std::vector<AxisPair>;

// Blur of all frames, mm^2: of each target, and the largest of the references, without the constants of the prints.
struct Blurs {
  std::vector<Series> targets;  // by marker; empty for references
  Series references;
  std::vector<double> movement;  // by frame: square of the largest movement since the frame before, mm^2
};

double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return kNaN;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<double> along(const Series& series, std::size_t axis) {
  std::vector<double> out;
  for (const AxisPair& one : series) out.push_back(one[axis]);
  return out;
}

// Subtracts the value of the sharpest frames.
void from_sharpest(Series& series) {
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    const double sharpest = quantile(along(series, axis), kSharpest);
    for (AxisPair& one : series) one[axis] -= sharpest;
  }
}

// Returns the largest of the references in each frame; zero if none shows its blur. A camera that rolls blurs markers
// at the edge of the image more than those in its middle.
Series largest_of(const std::vector<Series>& references, std::size_t frames) {
  Series out(frames, {0.0, 0.0});
  for (std::size_t k = 0; k < frames; ++k) {
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      double largest = kNaN;
      for (const Series& one : references) largest = std::fmax(largest, one[k][axis]);
      if (!std::isnan(largest)) out[k][axis] = largest;
    }
  }
  return out;
}

Blurs blurs_of(const Site& site, const FrameSeries& frames) {
  const std::size_t markers = site.markers.size();
  std::vector<Series> all(markers, Series(frames.size(), {kNaN, kNaN}));
  std::vector<std::optional<ImagePoint>> last(markers);
  Blurs out;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const BundleFrame frame = frames[k];
    double movement = 0.0;
    for (std::size_t i = 0; i < markers; ++i) {
      const auto& now = frame.points[i];
      const auto& grating = site.markers[i].grating;
      if (now && grating && k > 0) all[i][k] = blur_variance(*now, *grating);
      if (now && grating && last[i]) movement = std::max(movement, movement_squared(*now, *last[i], grating->pitch_mm));
      last[i] = now ? std::optional(now->image[4]) : std::nullopt;
    }
    out.movement.push_back(movement);
  }
  std::vector<Series> references;
  out.targets.resize(markers);
  for (std::size_t i = 0; i < markers; ++i) {
    if (!site.markers[i].grating) continue;
    from_sharpest(all[i]);
    if (site.markers[i].role == Role::kTarget)
      out.targets[i] = std::move(all[i]);
    else if (site.markers[i].grating->pattern != Pattern::kCheckerboard)  // whose fits confuse blur and contrast
      references.push_back(std::move(all[i]));
  }
  out.references = largest_of(references, frames.size());
  return out;
}

// Returns the variance of the mean positions along both axes, mm^2: half the mean square of the movement over one to
// eight frames. So slow movement counts little, and a vibration near the frame rate counts in full.
AxisPair positions_of(std::span<const FrameStart> frames, std::size_t marker) {
  AxisPair sum{};
  double count = 0.0;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    for (std::size_t lag = 1; lag <= std::min(kLags, k); ++lag) {
      if (!frames[k].has_points[marker] || !frames[k - lag].has_points[marker]) continue;
      const auto went = frames[k].shift[marker] - frames[k - lag].shift[marker];
      sum[0] += went.x * went.x, sum[1] += went.y * went.y, count += 2.0;
    }
  }
  return {sum[0] / count, sum[1] / count};
}

// Returns by frame the variance of a uniform movement within the frame interval, mm^2. The movement before and after
// the frame must be alike. Such a smear is symmetric.
Series uniform_part(std::span<const FrameStart> frames, std::size_t marker) {
  Series out(frames.size(), {0.0, 0.0});
  const auto part = [](double before, double after) {
    return before * after > 0.0 ? std::min(before * before, after * after) / 12.0 : 0.0;
  };
  for (std::size_t k = 1; k + 1 < frames.size(); ++k) {
    if (!frames[k - 1].has_points[marker] || !frames[k].has_points[marker] || !frames[k + 1].has_points[marker])
      continue;
    const auto before = frames[k].shift[marker] - frames[k - 1].shift[marker];
    const auto after = frames[k + 1].shift[marker] - frames[k].shift[marker];
    out[k] = {part(before.x, after.x), part(before.y, after.y)};
  }
  if (frames.size() > 2) out.back() = out[frames.size() - 2];
  return out;
}

// Movement of a target between frames.
struct TargetMotion {
  AxisPair positions;  // variance of the mean positions, mm^2
  Series uniform;      // by frame, mm^2
};

// Returns the least variance within any exposure, mm^2. `range`: of the variances. `positions`: variance of the means.
double constant_part(double range, double positions) {
  if (!(range > 0.0 && positions > 0.0)) return 0.0;
  return range * std::min(kMostConstant, kConstant * std::pow(range / positions, kPower));
}

// Returns the uncertainties of a target along one axis by frame, mm. That of the reference frame is usual for the
// others.
std::vector<double> along_axis(const Blurs& blurs, std::size_t marker, std::size_t axis, double pitch_mm,
                               const TargetMotion& motion) {
  const std::vector<double> all = along(blurs.targets[marker], axis);
  std::vector<double> own, u;
  for (std::size_t k = 0; k < all.size(); ++k)
    own.push_back(all[k] - blurs.references[k][axis] - motion.uniform[k][axis]);
  for (double& one : own) one = one < 0.0 ? 0.0 : one;  // keeps NaN
  const double constant = constant_part(quantile(own, kSoftest), motion.positions[axis]);
  const double most = kHidden * motion.positions[axis];
  for (std::size_t k = 0; k < all.size(); ++k) {
    // Light changes contrast, too. But an exposure is no longer than the frame interval, and a uniform movement by d in
    // it has the variance d^2 / 12.
    const double moved = std::max(blurs.movement[k], k + 1 < all.size() ? blurs.movement[k + 1] : 0.0);
    const double camera = std::min(std::max(0.0, all[k]), moved / 12.0);
    const double square = std::min(own[k] + constant, most);
    const double part = std::sqrt(square) * (kOwn * square + kWithCamera * camera);
    const double found = std::pow(kTwoPi / pitch_mm, 2) * part;
    u.push_back(found > kLeast * pitch_mm ? found : 0.0);  // 0, too, if the target was not read
  }
  const double usual = quantile(u, kUsual);
  if (usual > kLeast * pitch_mm) u.front() = usual;
  return u;
}

}  // namespace

SmearError smear_error(const Site& site, const FrameSeries& frames) {
  SmearError out;
  if (frames.size() < 2) return out;
  const Blurs blurs = blurs_of(site, frames);
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (blurs.targets[i].empty()) continue;
    const TargetMotion motion{positions_of(frames.starts(), i), uniform_part(frames.starts(), i)};
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      const auto u = along_axis(blurs, i, axis, site.markers[i].grating->pitch_mm, motion);
      if (std::ranges::none_of(u, [](double one) { return one > 0.0; })) continue;
      if (out.empty()) out.assign(frames.size(), std::vector<Extent<frame::Board>>(site.markers.size()));
      for (std::size_t k = 0; k < u.size(); ++k) (axis == 0 ? out[k][i].x : out[k][i].y) = u[k];
    }
  }
  return out;
}

}  // namespace moiregauge::internal
