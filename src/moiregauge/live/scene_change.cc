// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/scene_change.h"

#include <algorithm>
#include <cmath>

namespace moiregauge::internal {
namespace {

constexpr double kMaxStep = 0.5;  // largest change of the offset per frame, in u (chosen)

double offset_of(double before_mm, double after_mm, double remaining_mm) {
  const double offset = before_mm + remaining_mm - after_mm;
  return std::isnan(offset) ? 0.0 : offset;
}

// Reduces the offset and adds it to a value. Without a value the offset waits.
void add(double& offset_mm, double& value_mm, double& u_mm) {
  if (std::isnan(value_mm) || !(u_mm > 0.0)) return;
  offset_mm = std::copysign(std::max(0.0, std::abs(offset_mm) - kMaxStep * u_mm), offset_mm);
  value_mm += offset_mm;
  u_mm = std::hypot(u_mm, offset_mm);
}

}  // namespace

void SceneChange::begin(const Samples& before, const Samples& after) {
  offset_mm_.resize(after.size());
  for (std::size_t k = 0; k < after.size() && k < before.size(); ++k) {
    const auto& from = before[k].displacement;
    const auto& to = after[k].displacement;
    offset_mm_[k] = {offset_of(from.x, to.x, offset_mm_[k].x), offset_of(from.y, to.y, offset_mm_[k].y)};
  }
}

void SceneChange::apply(Samples& samples) {
  for (std::size_t k = 0; k < samples.size() && k < offset_mm_.size(); ++k) {
    add(offset_mm_[k].x, samples[k].displacement.x, samples[k].u.x);
    add(offset_mm_[k].y, samples[k].displacement.y, samples[k].u.y);
  }
}

}  // namespace moiregauge::internal
