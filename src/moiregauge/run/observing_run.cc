// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/observing_run.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

std::optional<std::string> note_on_repeats(const std::vector<long>& repeated, long frames) {
  if (repeated.empty()) return std::nullopt;
  return fmt::format(
      "moving targets are not trusted in {} of {} frames, which repeat the frame before exactly (first: frame {}). "
      "Record without dropped frames",
      repeated.size(), frames, repeated.front());
}

}  // namespace

ObservingRun::ObservingRun(const MeasureOptions& options, Measurement& out, RunHooks hooks, Keep keep)
    : options_(options),
      out_(out),
      frames_(hooks.frames),
      journal_(hooks.journal),
      keep_(keep),
      observer_(options, out) {
  if (!hooks.so_far.reference) return;
  observer_.resume(*std::move(hooks.so_far.reference), hooks.so_far.input.bits);
  out_.notes = std::move(hooks.so_far.notes);
  kept_ = std::move(hooks.so_far.observations);
  is_journaled_ = true;
}

std::optional<Observation> ObservingRun::measure_frame(const Frame& frame, const std::function<bool()>& is_whole) {
  const bool had_reference = out_.reference.has_value();
  Observation seen = observer_.observe(frame);
  if (!out_.contradiction.empty()) return std::nullopt;
  if (!is_whole()) {
    Frame torn = frame;
    torn.damaged = true;
    if (!had_reference && out_.reference) {
      out_.reference.reset();
      out_.refusal = "the file became shorter while its first frames were read";
    }
    seen = observer_.observe(torn);
  }
  if (keep_ == Keep::kAll) out_.observations.push_back(seen);
  put(frame, seen);
  if (journal_ == nullptr) return seen;
  if (out_.reference && !std::exchange(is_journaled_, true))
    journal_->refer(*out_.reference, observer_.reference_notes());
  journal_->add(keep_ == Keep::kAll ? out_.observations.packed(out_.observations.size() - 1)
                                    : out_.observations.packed(seen));
  return seen;
}

std::optional<Observation> ObservingRun::pass_over(const Frame& frame) {
  Observation seen = kept_[passed_];
  if (seen.frame != frame.number) return std::nullopt;
  keep_picture(frame);
  observer_.skip(seen);
  if (keep_ == Keep::kAll) out_.observations.append(kept_, passed_, passed_ + 1);
  ++passed_;
  put(frame, seen);
  return seen;
}

Observation ObservingRun::pass_over_unseen() {
  Observation seen = kept_[passed_++];
  observer_.skip(seen);
  return seen;
}

void ObservingRun::stop() {
  out_.interrupted = true;
  if (keep_ == Keep::kAll) out_.observations.append(kept_, passed_, kept_.size());
  passed_ = kept_.size();
}

// Forwards a frame that was added to the observations.
void ObservingRun::put(const Frame& frame, const Observation& seen) {
  observer_.add(frame, seen);
  if (frames_ == nullptr) return;
  const bool is_before = !out_.reference || (!options_.reference_frame && frame.number < out_.reference->seen.frame);
  frames_->add(frame, out_.input.bits, is_before ? nullptr : &*out_.reference, seen);
}

void conclude_log(const CameraProcessing& processing, long frames, ObservationLog& log) {
  if (log.reference) log.input.tone = log.reference->tone;
  log.processing = processing;
  if (auto note = note_on_repeats(processing.repeated, frames)) log.notes.push_back(*std::move(note));
  log.notes.insert(log.notes.begin(), log.input.warnings.begin(), log.input.warnings.end());
  if (std::isnan(log.input.fps)) log.notes.emplace_back(kNoTimesNote);
}

void note_damage(ObservationLog& log, const std::string& message) {
  log.input_damaged = true;
  log.notes.push_back(message);
}

}  // namespace moiregauge::internal
