// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/continuity.h"

#include <algorithm>
#include <cmath>

namespace moiregauge {
namespace {

constexpr double kSure = 0.25;  // pitches

bool outruns(const Marker& target, std::span<const BundleFrame> frames, std::size_t i) {
  const BundleFrame* before = nullptr;
  for (const BundleFrame& frame : frames) {
    if (!frame.points[i]) continue;
    if (before != nullptr) {
      const auto went = frame.shift[i] - before->shift[i];
      if (std::max(std::abs(went.x), std::abs(went.y)) > kSure * target.grating->pitch_mm) return true;
    }
    before = &frame;
  }
  return false;
}

}  // namespace

std::vector<bool> outruns_continuity(const Site& site, std::span<const BundleFrame> frames) {
  std::vector<bool> out;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const Marker& marker = site.markers[i];
    out.push_back(marker.role == Role::kTarget && marker.grating && outruns(marker, frames, i));
  }
  return out;
}

}  // namespace moiregauge
