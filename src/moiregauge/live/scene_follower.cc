// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/scene_follower.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "moiregauge/displacement/continuity.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/run/codec.h"

namespace moiregauge::internal {
namespace {

// Movement of the camera beyond that of the key frames which is worth a new scene (chosen): a quarter more, and at least
// 2 px.
constexpr double kMoreMovement = 1.25;
constexpr double kMinMovement_px = 2.0;
// One over the share of new key frames that is worth a new scene (chosen).
constexpr long kReplacedShare = 4;
// Changes of a slope from which the noise of raster readings is determined: u of the noise is 2 % (chosen).
constexpr std::size_t kSlopes = 8000;
constexpr long kFramesPerExcess = 8;  // between two sorts of these slopes (chosen)

}  // namespace

SceneFollower::SceneFollower(const Reference& reference, const MeasureOptions& options, KeyFrameLimits limits)
    : reference_(reference),
      options_(options),
      follower_(reference),
      keys_(limits),
      is_far_(reference.site.markers.size(), false),
      last_travel_(reference.site.markers.size(), {kNotMeasured, kNotMeasured}),
      noise_(reference, kSlopes) {
  keys_.refer_to(reference);
  if (options.method->name == kDefaultMethod) solver_.emplace(reference, options.solve);
}

void SceneFollower::mark_leaps(const Travel& travel) {
  for (std::size_t i = 0; i < travel.size(); ++i) {
    const auto& grating = reference_.site.markers[i].grating;
    if (!grating) continue;
    const auto step = travel[i] - last_travel_[i];
    const double limit = kSureOfOrder * grating->pitch_mm;
    if (std::abs(step.x) > limit || std::abs(step.y) > limit) is_far_[i] = true;
    if (!std::isnan(travel[i].x)) last_travel_[i].x = travel[i].x;
    if (!std::isnan(travel[i].y)) last_travel_[i].y = travel[i].y;
  }
}

// Returns the largest movement of a reference in the image since the reference frame.
double SceneFollower::movement_px(const Observation& seen) const {
  if (!seen.references_seen) return 0.0;
  const View view{seen.stage1, reference_.lens};
  double largest = 0.0;
  for (const CirclePoint& point : reference_.circles)
    largest = std::max(largest, length(view(point.board) - reference_.view(point.board)));
  return largest;
}

// Solves when a quarter of the key frames is new, and when the camera has moved further than in them.
void SceneFollower::solve_if_due(bool has_moved) {
  constexpr long kMinFrames = 2;
  const long added = keys_.added() - keys_solved_;
  const bool is_replaced = added * kReplacedShare > static_cast<long>(keys_.frames().size());
  if (measured_ < kMinFrames || !(is_replaced || has_moved)) return;
  keys_solved_ = keys_.added();
  solver_->solve(std::make_shared<const Observations>(keys_.frames()));
}

// Replaces the scene between two frames, with the curve continuous.
void SceneFollower::take_scene(const Observation& seen, const Travel& travel) {
  ScenePtr next = solver_->take();
  if (!next || !next->problem().empty()) return;
  if (scene_) change_.begin(scene_->measure(seen, travel, is_far_), next->measure(seen, travel, is_far_));
  scene_.swap(next);
  solver_->retire(std::move(next));
}

// One frame does not show the noise that its neighbouring pixels share, but the frames before do.
void SceneFollower::listen_to_noise(const Observation& seen) {
  if (solver_ || is_lossy(seen)) return;
  noise_.add(seen);
  if (measured_ % kFramesPerExcess != 0) return;
  const double excess = noise_.excess();
  if (excess == excess_) return;
  excess_ = excess;
  noisier_ = reference_;
  noisier_->seen = with_noise(std::move(noisier_->seen), excess);
}

// Without a scene, `two-stage` gives the displacement, which is not trusted. The other methods need no scene.
Samples SceneFollower::without_scene(const Observation& seen) const {
  const Reference& reference = noisier_ ? *noisier_ : reference_;
  Observations one(reference);
  one.push_back(with_noise(seen, excess_));
  Samples samples = (solver_ ? solve_two_stage : options_.method->solve)(reference, one, options_.solve).samples;
  if (seen.frame == reference_.seen.frame) return samples;
  for (Sample& sample : samples) {
    if (solver_ && sample.status == Status::kOk) sample.status = Status::kUntrusted;
    if (solver_ || !is_far_[sample.marker]) continue;
    sample.displacement = sample.u = {kNotMeasured, kNotMeasured};
    sample.status = Status::kOrderUnproven;
  }
  return samples;
}

void SceneFollower::replay(const Observation& seen) {
  mark_leaps(follower_.follow(reference_, seen));
  ++measured_;
  listen_to_noise(seen);
  movement_seen_px_ = std::max(movement_seen_px_, movement_px(seen));
  keys_.add(seen);
}

void SceneFollower::solve_replayed() {
  if (!solver_ || keys_.frames().size() < 2) return;
  solve_if_due(true);
}

Samples SceneFollower::add(const Observation& seen) {
  const Travel travel = follower_.follow(reference_, seen);
  mark_leaps(travel);
  ++measured_;
  listen_to_noise(seen);
  const double movement = movement_px(seen);
  const bool has_moved = movement > kMoreMovement * movement_seen_px_ + kMinMovement_px;
  const bool may_solve = solver_ && solver_->is_idle();
  keys_.add(seen, has_moved && may_solve);
  if (may_solve) {
    movement_seen_px_ = std::max(movement_seen_px_, movement);
    solve_if_due(has_moved);
  }
  if (solver_) take_scene(seen, travel);
  if (!scene_) return without_scene(seen);
  Samples samples = scene_->measure(seen, travel, is_far_);
  if (seen.frame != reference_.seen.frame) change_.apply(samples);
  return samples;
}

}  // namespace moiregauge::internal
