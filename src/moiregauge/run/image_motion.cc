// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/image_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moiregauge::internal {
namespace {

// Returns the smallest pitch of a grating in the image of the reference frame, px. No grating: infinite.
double smallest_pitch_px(const Reference& reference) {
  double smallest = INFINITY;
  for (const RasterPlan& plan : reference.plans) {
    if (plan.pitch_mm > 0.0) smallest = std::min(smallest, plan.pitch_mm / reference.view.mm_per_px(plan.centre));
  }
  return smallest;
}

}  // namespace

std::vector<ImagePoint> reference_centres(const Reference& reference, const Observation& seen) {
  std::vector<ImagePoint> centres;
  const View view{seen.stage2, reference.lens};
  for (const CirclePoint& point : reference.circles) {
    const std::size_t i = point.marker;
    Extent<frame::Board> moved{0.0, 0.0};  // within the view; conventional views do not follow the camera
    if (seen.markers[i].patch.valid && reference.seen.markers[i].patch.valid)
      moved = displacement_between(reference.plans[i], reference.seen.markers[i].patch, seen.markers[i].patch);
    centres.push_back(view(point.board + Extent<frame::Board>{or_zero(moved.x), or_zero(moved.y)}));
  }
  return centres;
}

double largest_distance(const std::vector<ImagePoint>& a, const std::vector<ImagePoint>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, length(a[i] - b[i]));
  return largest;
}

FrameMovement ImageMotion::add(const Reference& reference, const Observation& seen) {
  if (!seen.references_seen) return {seen.frame, INFINITY};
  if (pitch_px_ == 0.0) pitch_px_ = smallest_pitch_px(reference);
  std::vector<ImagePoint> now = reference_centres(reference, seen);
  double largest = 0.0;
  for (const auto& before : last_) {
    if (before.size() == now.size()) largest = std::max(largest, largest_distance(before, now));
  }
  last_.push_front(std::move(now));
  if (last_.size() > kLagSamples) last_.pop_back();
  return {seen.frame, largest / pitch_px_};
}

std::vector<FrameMovement> movement_in_frames(const Reference& reference, const Observations& observations) {
  std::vector<FrameMovement> all;
  ImageMotion motion;
  for (const Observation& seen : observations) all.push_back(motion.add(reference, seen));
  return all;
}

}  // namespace moiregauge::internal
