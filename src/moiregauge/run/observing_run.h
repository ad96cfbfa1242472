// SPDX-License-Identifier: Apache-2.0
// State of a run while frames arrive, shared by `measure` and `live`: observes each frame, journals it, and continues an
// unfinished run.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/run/frame_observer.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// Observations that stay in memory. An endless run has them in its journal only.
enum class Keep { kAll, kNone };

class ObservingRun {
 public:
  // Continues `hooks.so_far` if it has a reference frame. Without one, every frame is tried again.
  ObservingRun(const MeasureOptions& options, Measurement& out, RunHooks hooks, Keep keep = Keep::kAll);

  bool refer_to(const Frame& frame) { return observer_.refer_to(frame); }
  void keep_picture(const Frame& frame) { observer_.keep_picture(frame); }

  // Observes and journals a frame. `is_whole` returns false if its pixels changed meanwhile.
  // Fails (nothing): the frame contradicts the options (out.contradiction).
  std::optional<Observation> measure_frame(const Frame& frame, const std::function<bool()>& is_whole);

  // Takes a frame between the selected ones.
  void pass_skipped(const Frame& frame, const std::function<bool()>& is_whole) {
    observer_.pass_skipped(frame, is_whole);
  }

  // Returns true if the unfinished run has observed the next selected frame.
  [[nodiscard]] bool is_kept() const { return passed_ < kept_.size(); }
  // Returns the number of the next frame that the unfinished run observed. Requires is_kept().
  [[nodiscard]] long next_kept() const { return kept_[passed_].frame; }
  // Passes over a frame that the unfinished run observed. Fails (nothing): it is another frame.
  std::optional<Observation> pass_over(const Frame& frame);
  // Passes over the next observed frame without its image, which a camera cannot show again. Requires is_kept().
  Observation pass_over_unseen();
  // Keeps all earlier observations, even if the resumed run stops while it passes over frames.
  void stop();

  [[nodiscard]] const std::vector<std::string>& reference_notes() const { return observer_.reference_notes(); }
  [[nodiscard]] CameraProcessing processing(long since = 0) const { return observer_.processing(since); }
  [[nodiscard]] bool cannot_succeed() const { return observer_.cannot_succeed(); }
  [[nodiscard]] bool may_continue() const { return journal_ == nullptr || journal_->good(); }

 private:
  void put(const Frame& frame, const Observation& seen);

  const MeasureOptions& options_;
  Measurement& out_;
  FrameSink* frames_;
  JournalSink* journal_;
  Keep keep_;
  FrameObserver observer_;
  Observations kept_;          // from the unfinished run
  std::size_t passed_ = 0;     // those of `kept_` that were passed over
  bool is_journaled_ = false;  // the reference frame is in the journal
};

// Completes a log after its last frame: tone curve, evidence of processing, and the notes on input and frames.
// `frames`: number of observed frames.
void conclude_log(const CameraProcessing& processing, long frames, ObservationLog& log);

// Adds the error of a source that ended early to the log. Earlier frames stay valid.
void note_damage(ObservationLog& log, const std::string& message);

}  // namespace moiregauge::internal
