// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/continuity.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace moiregauge::internal {
namespace {

bool outruns(const Marker& target, std::span<const FrameStart> frames, std::size_t i) {
  const FrameStart* before = nullptr;
  for (const FrameStart& frame : frames) {
    if (!frame.has_points[i]) continue;
    if (before != nullptr) {
      const auto went = frame.shift[i] - before->shift[i];
      if (std::max(std::abs(went.x), std::abs(went.y)) > kSureOfOrder * target.grating->pitch_mm) return true;
    }
    before = &frame;
  }
  return false;
}

}  // namespace

std::vector<bool> outruns_continuity(const Site& site, std::span<const FrameStart> frames) {
  std::vector<bool> out;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const Marker& marker = site.markers[i];
    out.push_back(marker.role == Role::kTarget && marker.grating && outruns(marker, frames, i));
  }
  return out;
}

void doubt_after_leaps(const Site& site, std::span<Sample> samples) {
  std::vector<std::optional<Extent<frame::Board>>> last(site.markers.size());
  std::vector<bool> leapt(site.markers.size(), false);
  for (Sample& sample : samples) {
    if (!has_numbers(sample.status)) continue;
    const double sure = kSureOfOrder * site.markers[sample.marker].grating->pitch_mm;
    if (const auto& before = last[sample.marker]) {
      const auto went = sample.displacement - *before;
      if (std::abs(went.x) > sure || std::abs(went.y) > sure) leapt[sample.marker] = true;
    }
    last[sample.marker] = sample.displacement;
    if (!leapt[sample.marker]) continue;
    sample.status = Status::kOrderUnproven;
    sample.displacement = sample.u = {kNotMeasured, kNotMeasured};
  }
}

}  // namespace moiregauge::internal
