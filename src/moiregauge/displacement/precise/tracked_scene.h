// SPDX-License-Identifier: Apache-2.0
// A scene solved from chosen frames, in which further frames are measured one at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "moiregauge/displacement/bundle_frames.h"
#include "moiregauge/displacement/locking_error.h"
#include "moiregauge/displacement/precise/frames_in_scene.h"

namespace moiregauge::internal {

class TrackedScene {
 public:
  // Solves the scene from the observations `keys`. `reference` must outlive this object.
  // Rows are assumed to be read at once: footage that contradicts this is not trusted (`problem`).
  TrackedScene(const Reference& reference, std::shared_ptr<const Observations> keys, SolveOptions options);
  TrackedScene(const TrackedScene&) = delete;
  TrackedScene& operator=(const TrackedScene&) = delete;
  TrackedScene(TrackedScene&&) = delete;
  TrackedScene& operator=(TrackedScene&&) = delete;
  ~TrackedScene() = default;

  // Returns why no frame can be measured in this scene; empty if frames can.
  [[nodiscard]] const std::string& problem() const { return scene_.problem; }
  [[nodiscard]] const PreciseScene& scene() const { return scene_; }
  // Returns the samples of one frame, targets in the site's order. `travel`: of each site marker since the reference
  // frame, mm (Follower). `is_far`: targets whose fringe order continuity does not give.
  // Requires an empty problem().
  [[nodiscard]] Samples measure(const Observation& seen, const std::vector<Extent<frame::Board>>& travel,
                                const std::vector<bool>& is_far) const;

 private:
  const Reference& reference_;
  std::shared_ptr<const Observations> keys_;
  SolveOptions options_;
  std::size_t min_references_;
  Camera start_camera_;
  std::shared_ptr<const CodecHistory> codec_;
  BundleFrames frames_;
  std::shared_ptr<const LockingError> locking_;
  PreciseScene scene_;
  std::unique_ptr<const FramesInScene> measured_;
};

}  // namespace moiregauge::internal
