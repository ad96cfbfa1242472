// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/fast_vibration.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

// Displacements beyond the path above which a vibration is too large, pitches. The first holds if it is faster than the
// rows show, the second if chi2/dof exceeds its limit. In recordings of the second renderer no value was off by
// more than 5 u below 0.007 pitch. At 0.13 pitch, with a chi2/dof of 130, rows were off by 11 u. Chosen.
constexpr double kMaxFast_pitches = 0.01, kMaxUnfitted_pitches = 0.05;
constexpr double kUnfittedChi2 = 4.0;
// chi2/dof up to which rate and acceleration describe the motion: 1.4 for a hand at 6 Hz, 2.4 at 42 Hz. Chosen.
constexpr double kDescribedChi2 = 2.0;

constexpr int kRates = kMotionParameters / 2;  // the rest are the accelerations

using Points = Eigen::Matrix<double, 2 * kPatchPoints, 1>;  // displacements of the nine points, pitches: x, then y

// Returns the squared displacement of a grating along both axes, mm^2.
Eigen::Array2d squared(const Points& points, double pitch_mm) {
  return Eigen::Array2d(points.head<kPatchPoints>().mean(), points.tail<kPatchPoints>().mean()).square() * pitch_mm *
         pitch_mm;
}

}  // namespace

FastVibration fast_vibration(const Site& site, std::span<const MotionBeyondPath> motions, double chi2_dof) {
  Eigen::Array2d by_rate(0.0, 0.0), by_acceleration(0.0, 0.0), by_both(0.0, 0.0);
  double count = 0.0, pitch_mm = 0.0;
  for (const auto& [frame, motion] : motions) {
    for (std::size_t i = 0; i < site.markers.size(); ++i) {
      const Marker& marker = site.markers[i];
      if (marker.role != Role::kReference || !frame.points[i] || !marker.grating) continue;
      const auto& by_motion = frame.rows->by_marker[i];
      const Points rate = by_motion.leftCols<kRates>() * motion.head<kRates>();
      const Points acceleration = by_motion.middleCols<kRates>(kRates) * motion.tail<kRates>();
      by_rate += squared(rate, marker.grating->pitch_mm);
      by_acceleration += squared(acceleration, marker.grating->pitch_mm);
      by_both += squared(rate + acceleration, marker.grating->pitch_mm);
      count += 1.0;
      pitch_mm = std::max(pitch_mm, marker.grating->pitch_mm);
    }
  }
  if (!(by_rate.sum() > 0.0 && chi2_dof > kDescribedChi2)) return {};
  const double phase = 2.0 * std::sqrt(by_acceleration.sum() / by_rate.sum());  // w t, rad
  const double share = std::min(1.0, phase * phase * std::max(1.0, phase) / 6.0);
  const double displaced_mm = std::sqrt(by_both.sum() / count);
  const double displaced_pitches = displaced_mm / pitch_mm;
  return {{share * std::sqrt(by_both.x() / count), share * std::sqrt(by_both.y() / count)},
          displaced_mm,
          (phase > 1.0 && displaced_pitches > kMaxFast_pitches) ||
              (chi2_dof > kUnfittedChi2 && displaced_pitches > kMaxUnfitted_pitches)};
}

}  // namespace moiregauge::internal
