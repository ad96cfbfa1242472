// SPDX-License-Identifier: Apache-2.0
// Provisional samples of a live run: the scene is solved from bounded key frames, again and again, as the camera moves.
#pragma once

#include <optional>
#include <vector>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/reading_noise.h"
#include "moiregauge/live/key_frames.h"
#include "moiregauge/live/scene_change.h"
#include "moiregauge/live/scene_solver.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

class SceneFollower {
 public:
  // Both must outlive this object. The reference frame is the first observation to add.
  SceneFollower(const Reference& reference, const MeasureOptions& options, KeyFrameLimits limits);

  // Adds the observation of a frame and returns its samples, one per target in the site's order. Never waits for a
  // solution.
  Samples add(const Observation& seen);
  // Adds the observation of a frame that an earlier process measured.
  void replay(const Observation& seen);
  // Begins to solve the scene of the replayed frames. Rows are not trusted until it is solved.
  void solve_replayed();
  // Returns the number of scenes solved.
  [[nodiscard]] long scenes() const { return solver_ ? solver_->solved() : 0; }
  [[nodiscard]] std::size_t key_frames() const { return keys_.frames().size(); }

 private:
  using Travel = std::vector<Extent<frame::Board>>;
  void mark_leaps(const Travel& travel);
  [[nodiscard]] double movement_px(const Observation& seen) const;
  void solve_if_due(bool has_moved);
  void take_scene(const Observation& seen, const Travel& travel);
  void listen_to_noise(const Observation& seen);
  [[nodiscard]] Samples without_scene(const Observation& seen) const;

  const Reference& reference_;
  const MeasureOptions& options_;
  Follower follower_;
  KeyFrames keys_;
  SceneChange change_;
  std::vector<bool> is_far_;  // targets whose fringe order continuity does not give, one per site marker
  Travel last_travel_;
  ScenePtr scene_;
  std::optional<SceneSolver> solver_;  // `precise` only
  // Other methods only: noise that neighbouring pixels share, and the reference frame with it if there is any.
  ReadingNoise noise_;
  double excess_ = 1.0;
  std::optional<Reference> noisier_;
  long measured_ = 0;              // frames
  long keys_solved_ = 0;           // KeyFrames::added() at the last request
  double movement_seen_px_ = 0.0;  // largest movement in the key frames of the last request
};

}  // namespace moiregauge::internal
