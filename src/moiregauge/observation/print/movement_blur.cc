// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/movement_blur.h"

#include <cmath>
#include <map>

#include "moiregauge/observation/print/few_frames.h"

namespace moiregauge::internal {
namespace {

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
  if (!(effective >= kMinMovingFrames)) return {};
  return {slope, enlargement_of_few(effective - 2.0) * std::sqrt(scatter) / qq};
}

}  // namespace moiregauge::internal
