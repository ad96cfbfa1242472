// SPDX-License-Identifier: Apache-2.0
#include "product_chain.h"

#include <stdexcept>

#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/bundle_frames.h"
#include "moiregauge/observation/frame/track.h"

namespace moiregauge::internal::bench {
namespace {

Reference prepared(const Recording& recording, const Method& method) {
  Reference reference = recording.reference();
  if (method.prepare != nullptr) method.prepare({recording.reference_frame().view(), 8}, reference);
  return reference;
}

std::size_t first_target(const Site& site) {
  std::size_t i = 0;
  while (site.markers[i].role != Role::kTarget) ++i;
  return i;
}

FrameFit fit_turned(const Site& site, const Scene& scene, BundleFrame frame) {
  frame.pose = pose_of(site, scene, frame).value_or(frame.pose);
  return fit_frame(site, scene, frame, FrameDetail::kSamples);
}

}  // namespace

ProductChain::ProductChain(const Recording& recording, const Method& method)
    : method_(method),
      reference_(prepared(recording, method)),
      target_(first_target(reference_.site)),
      follower_(reference_) {
  Observations run(reference_);
  seen_ = Observations(reference_);
  seen_.push_back({});
  for (const Shot& shot : recording.shots(Memory::kRing)) {
    observe(shot);
    run.append(seen_, 0, 1);
  }
  scene_ = method_.solve(reference_, run, {}).scene;
  if (!scene_) return;
  if (!scene_->solved) throw std::runtime_error("the recording's scene is not solved: " + scene_->problem);
  auto [frames, place] = bundle_frames(reference_, run, scene_->camera, {}, kMinForHomography);
  budget_ = std::make_unique<PreciseBudget>(reference_.site, scene_->full_covariance,
                                            fit_turned(reference_.site, *scene_, frames.front()));
}

void ProductChain::observe(const Shot& shot) {
  keep(method_.observe({shot.picture, 8}, reference_, follower_.prediction()), shot.frame);
}

void ProductChain::track(const Shot& shot) {
  const GreyPicture picture{shot.picture, 8};
  auto seen = track_references(picture, reference_, follower_.prediction(), Rows::kSome);
  if (!seen) return observe(shot);  // detection, because a marker is not at its predicted position
  const View view{seen->stage2, reference_.lens};
  auto target = track_target({picture, view}, reference_, target_, follower_.prediction(), Rows::kSome);
  if (!target) return observe(shot);
  seen->markers[target_] = *std::move(target);
  keep(*std::move(seen), shot.frame);
}

void ProductChain::keep(Observation seen, long frame) {
  seen.frame = frame;
  seen_.replace(0, seen);
  seen = seen_.front();
  (void)follower_.follow(reference_, seen);
}

ProductChain::Reading ProductChain::solve(const Observations& one) const {
  if (scene_) return solve_in_scene(one);
  const Solution solution = method_.solve(reference_, one, {});
  for (const Sample& sample : solution.samples) {
    if (sample.marker == target_) return {sample.displacement, sample.u};
  }
  return {};
}

// Solves one frame as `precise` does with a known scene.
ProductChain::Reading ProductChain::solve_in_scene(const Observations& one) const {
  auto [frames, place] = bundle_frames(reference_, one, scene_->camera, {}, kMinForHomography);
  if (place.front() == 0) return {};
  const FrameFit now = fit_turned(reference_.site, *scene_, frames[place.front()]);
  if (!now.ok) return {};
  const auto displacement = now.shift[target_] - budget_->then().shift[target_];
  return {displacement, total(budget_->of_frame(now).budget(target_, displacement))};
}

}  // namespace moiregauge::internal::bench
