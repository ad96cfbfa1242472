// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/tracked_scene.h"

#include <utility>

#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/precise/precise_prior.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge::internal {

TrackedScene::TrackedScene(const Reference& reference, std::shared_ptr<const Observations> keys, SolveOptions options)
    : reference_(reference),
      keys_(std::move(keys)),
      options_(options),
      min_references_(reference.knows_camera() ? kMinForPose : kMinForHomography) {
  options_.readout_s = 0.0;
  const ScenePrior prior = precise_prior(reference_, options_);
  start_camera_ = prior.camera;
  codec_ = std::make_shared<const CodecHistory>(reference_, *keys_);
  frames_ = bundle_frames(reference_, *keys_, start_camera_, options_, min_references_);
  // As in `solve_precise`, the codec's error comes first.
  frames_.frames = with_codec_error(frames_, codec_);
  locking_ = std::make_shared<const LockingError>(reference_, frames_.frames);
  frames_.frames = with_locking_error(frames_.frames, locking_);
  if (references_in(reference_.site, frames_.frames.front()) < kMinForHomography) {
    scene_.problem = "the gratings of four references could not be learned from the reference frame";
    return;
  }
  scene_ = precise_scene(reference_, frames_.frames, prior, options_, codec_->is_lossy());
  if (scene_.problem.empty()) measured_ = std::make_unique<const FramesInScene>(reference_, scene_, std::nullopt);
}

Samples TrackedScene::measure(const Observation& seen, const std::vector<Extent<frame::Board>>& travel,
                              const std::vector<bool>& is_far) const {
  auto frame = bundle_frame(reference_, seen, start_camera_, travel, min_references_);
  if (frame) frame = with_codec_error(*frame, *codec_, codec_->of_next(reference_, seen));
  if (frame && !locking_->is_zero()) frame = locking_->with_error(*std::move(frame));
  if (frame && scene_.excluded) frame->points[*scene_.excluded].reset();
  if (frame && scene_.movements) frame = scene_.movements->displaced_only(*frame);
  return measured_->measure_one(seen, frame, is_far);
}

}  // namespace moiregauge::internal
