// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/movement_blur.h"

#include <cmath>
#include <map>

namespace moiregauge::internal {
namespace {

// Frames that determine a slope: below, a single jump of the target would decide. As for the edges (echo_sums.cc).
constexpr double kMinBlurFrames = 5.0;

struct Means {
  double frames = 0.0, q = 0.0, y = 0.0;
};

// Sums over one frame, about the means of each grating and axis. q is D^2, y the variance.
struct FrameSums {
  double qq = 0.0, qy = 0.0;
};

}  // namespace

BlurSlope blur_slope(std::span<const BlurReading> readings) {
  std::map<std::size_t, Means> means;
  for (const BlurReading& r : readings) {
    Means& m = means[r.at];
    m.frames += 1.0, m.q += r.moved * r.moved, m.y += r.variance;
  }
  std::map<int, FrameSums> frames;
  double qq = 0.0, qy = 0.0;
  for (const BlurReading& r : readings) {
    const Means& m = means.at(r.at);
    const double q = r.moved * r.moved - m.q / m.frames, y = r.variance - m.y / m.frames;
    FrameSums& f = frames[r.frame];
    f.qq += q * q, f.qy += q * y;
    qq += q * q, qy += q * y;
  }
  if (!(qq > 0.0)) return {};
  const double slope = qy / qq;
  double weights = 0.0, scatter = 0.0;
  for (const auto& [number, f] : frames) {
    weights += f.qq * f.qq;
    scatter += std::pow(f.qy - slope * f.qq, 2);
  }
  const double effective = qq * qq / weights;
  if (!(effective >= kMinBlurFrames)) return {};
  // Student's t, as in echo_sums.cc.
  const double freedom = effective - 2.0, few = 1.0 + 4.25 / freedom + 16.0 / (freedom * freedom);
  return {slope, few * std::sqrt(scatter) / qq};
}

}  // namespace moiregauge::internal
