// SPDX-License-Identifier: Apache-2.0
// Observation of one recording, frame by frame: makes the reference frame, maps grey levels to light, tracks the markers.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/run/light.h"
#include "moiregauge/run/measure.h"
#include "moiregauge/run/repeated_frames.h"
#include "moiregauge/run/template_reader.h"

namespace moiregauge::internal {

class FrameObserver {
 public:
  // Uses out.input (bits and tone curve). Sets out.reference, its notes and picture, or out.refusal. Adds no observations
  // to it. Both must outlive this object.
  FrameObserver(const MeasureOptions& options, Measurement& out) : options_(options), out_(out) {}

  // Continues with the reference frame of an unfinished run.
  void resume(Reference reference, int bits);
  // Tries to make `frame` the reference frame. Returns false, and keeps the first failure as the refusal, if it is not
  // measurable.
  bool refer_to(const Frame& frame);
  // Returns what is seen in the frame. Without a reference frame it tries to make this one the reference.
  [[nodiscard]] Observation observe(const Frame& frame);
  // Takes a frame that the unfinished run observed.
  void skip(const Observation& seen);
  // Takes the observation as final: later frames are compared with it.
  void add(const Frame& frame, const Observation& seen);
  // Takes a frame that is not selected. It is observed only if the tests of camera processing need it.
  void pass_skipped(const Frame& frame, const std::function<bool()>& is_whole);
  // Keeps the image of the reference frame, if `frame` is it.
  void keep_picture(const Frame& frame);

  [[nodiscard]] const std::vector<std::string>& reference_notes() const { return reference_notes_; }
  [[nodiscard]] CameraProcessing processing(long since = 0) const { return processing_.result(since); }
  // Returns true if no other frame can be the reference frame either.
  [[nodiscard]] bool cannot_succeed() const { return cannot_succeed_; }

 private:
  bool refer_as_light(const Frame& frame);
  bool refer_against_assumed_tone(const Frame& frame);
  bool follow_shown_tone(const Frame& frame);
  bool refer_in_light(const Frame& frame);
  [[nodiscard]] Tone stated_tone() const;
  // Returns what is seen in a frame, which is not damaged, with the current prediction.
  [[nodiscard]] Observation look_at(const Frame& frame);
  // Passes a measured frame to the tests of camera processing.
  void watch(const Frame& frame, const Observation& seen);
  void learn_templates(const Frame& frame);

  const MeasureOptions& options_;
  Measurement& out_;
  std::vector<std::string> reference_notes_;  // remarks on the reference frame
  std::optional<Follower> follower_;
  std::optional<Observation> last_;
  LightMap light_;
  double rounding_ = 0.0;  // largest so far, grey levels or light levels
  RepeatedFrames repeats_;
  ProcessingWatch processing_;
  TemplateReader templates_;        // for methods that read none
  bool is_after_selected_ = false;  // no skipped frame came since the last selected one
  bool observes_skipped_ = false;   // up to the next selected frame
  long skipped_ = 0;                // skipped frames that were observed
  bool cannot_succeed_ = false;
};

}  // namespace moiregauge::internal
