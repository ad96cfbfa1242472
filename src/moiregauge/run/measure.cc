// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/measure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/detection/identity/layout_symmetry.h"
#include "moiregauge/displacement/budget_errors.h"
#include "moiregauge/results/derived/zeroed_samples.h"
#include "moiregauge/run/codec.h"
#include "moiregauge/run/frame_notes.h"
#include "moiregauge/run/image_motion.h"
#include "moiregauge/run/observing_run.h"

namespace moiregauge::internal {
namespace {

std::string as_typed(const FrameRange& range) {
  if (range.seconds)
    return fmt::format("{}s:{}{}", range.seconds->first_s,
                       std::isinf(range.seconds->end_s) ? std::string{} : fmt::format("{}s", range.seconds->end_s),
                       range.step != 1 ? fmt::format(":{}", range.step) : std::string{});
  return fmt::format("{}:{}{}", range.first, range.end >= 0 ? std::to_string(range.end) : std::string{},
                     range.step != 1 ? fmt::format(":{}", range.step) : std::string{});
}

InputError no_pictures(const std::string& path) {
  return {InputErrorKind::kUnreadable, "the input has no frames: " + path + ": give a video or a folder of images"};
}

std::string no_such_frame(const std::string& option, const InputInfo& input, long frames) {
  return fmt::format("the selected frame does not exist: {} of {}: choose from its {}, the first is 0", option,
                     input.path, frames == 1 ? "1 frame" : fmt::format("{} frames", frames));
}

// Reads up to the frame of --reference-frame from a separate source, because it may be outside the selection.
tl::expected<void, InputError> refer_to_frame(const OpenInput& open, long number, ObservingRun& run, Measurement& out) {
  auto source = open();
  if (!source) return tl::unexpected(source.error());
  out.input = (*source)->info();
  long frames = 0;
  while (true) {
    auto frame = (*source)->next();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) {
      if (frames == 0) return tl::unexpected(no_pictures(out.input.path));
      out.contradiction = no_such_frame(fmt::format("--reference-frame {}", number), out.input, frames);
      return {};
    }
    frames = (*frame)->number + 1;
    if ((*frame)->number < number) continue;
    if (out.reference)
      run.keep_picture(**frame);
    else if ((*frame)->damaged)
      out.refusal = fmt::format("reference frame {} is damaged", number);
    else if (!run.refer_to(**frame) && out.contradiction.empty())
      out.refusal = fmt::format("reference frame {}: {}", number, out.refusal);
    return {};
  }
}

InputError not_the_same(const std::string& path) {
  return {
      InputErrorKind::kUnreadable,
      fmt::format("the unfinished run cannot be resumed: {} has other frames now: start again with --restart", path)};
}

// Returns the number of frames that will be measured. -1: unknown.
long selected(const FrameRange& range, long frames) {
  if (range.seconds || (frames < 0 && range.end < 0)) return -1;
  const long end = frames < 0 ? range.end : range.end < 0 ? frames : std::min(range.end, frames);
  return std::max(0L, (end - range.first + range.step - 1) / range.step);
}

tl::expected<void, InputError> measure_all(FrameSource& source, const MeasureOptions& options, ObservingRun& run,
                                           Measurement& out, const OnProgress& on_progress) {
  const long expected = selected(options.frames, source.info().frames);
  FrameSelector selector(options.frames);
  long frames = 0;  // read so far
  while (true) {
    auto frame = source.next();
    if (!frame) {
      if (frames == 0) return tl::unexpected(frame.error());
      note_damage(out, frame.error().message);
      break;
    }
    if (!*frame) break;
    const Frame& now = **frame;
    frames = now.number + 1;
    if (selector.is_past(now.number, now.time_s)) break;
    const auto is_whole = [&source] { return source.is_frame_whole(); };
    if (!selector.holds(now.number, now.time_s)) {
      if (!out.observations.empty()) run.pass_skipped(now, is_whole);
      continue;
    }
    if (!run.is_kept())
      (void)run.measure_frame(now, is_whole);
    else if (!run.pass_over(now))
      return tl::unexpected(not_the_same(source.info().path));
    if (!out.contradiction.empty()) return {};
    if (run.cannot_succeed() && !out.reference) break;
    if (!run.may_continue() || (on_progress && !on_progress(static_cast<long>(out.observations.size()), expected))) {
      run.stop();
      break;
    }
  }
  if (run.is_kept()) return tl::unexpected(not_the_same(source.info().path));
  if (frames == 0) return tl::unexpected(no_pictures(source.info().path));
  if (out.observations.empty() && !out.interrupted)
    out.contradiction = no_such_frame("--frames " + as_typed(options.frames), source.info(), frames);
  return {};
}

}  // namespace

const std::optional<Scene>& stated_scene(const Measurement& measurement) {
  static const std::optional<Scene> nothing;
  const bool is_stated = measurement.scene && measurement.scene->solved && measurement.exit != Exit::kRefused;
  return is_stated ? measurement.scene : nothing;
}

const Site& site_of(const Measurement& measurement, const MeasureOptions& options) {
  return measurement.reference ? measurement.reference->site : options.site;
}

void complete_markers(ObservationLog& seen) {
  if (!seen.reference) return;
  MarkerObservation not_seen;
  not_seen.loss = Loss::kNotSeen;
  const std::size_t markers = seen.reference->site.markers.size();
  for (std::size_t n = 0; n < seen.observations.size(); ++n) {
    Observation frame = seen.observations[n];
    if (frame.markers.size() == markers) break;
    frame.markers.resize(markers, not_seen);
    seen.observations.replace(n, frame);
  }
}

namespace {

// Returns a note on frames before the reference frame, whose references may all be visible.
std::optional<std::string> note_on_first_frames(const Measurement& measured, const MeasureOptions& options) {
  if (options.reference_frame) return std::nullopt;
  const long reference = measured.reference->seen.frame;
  std::optional<Observation> first;
  long last = 0;
  for (const Observation& seen : measured.observations) {
    if (seen.frame >= reference) break;
    if (seen.decode_error) continue;
    if (!first) first = seen;
    last = seen.frame;
  }
  if (!first) return std::nullopt;
  return fmt::format(
      "frames {} to {} have no values (reference-lost): frame {} is the first that shows every marker. In frame {}, "
      "{}. Choose another with --reference-frame",
      first->frame, last, reference, first->frame, first->reference_problem);
}

std::string rest_contradiction(const Measurement& measured, const MeasureOptions& options, const MovedAtRest& moved) {
  return fmt::format(
      "target '{}' is not at rest: it moves by {:.4f} mm (u {:.4f} mm) between frames {} and {} of --rest {}",
      measured.reference->site.markers[moved.marker].name, moved.mm, moved.u_mm, moved.from, moved.to,
      as_typed(*options.solve.rest));
}

// Returns the rest frames by number. Fails with a contradiction: none of them was measured.
tl::expected<std::optional<FrameRange>, std::string> rest_in_frames(const MeasureOptions& options,
                                                                    const Measurement& measured) {
  if (!options.solve.rest) return std::nullopt;
  auto rest = in_frames(*options.solve.rest, measured.observations);
  // The reference frame may be outside the selection.
  const auto& reference = measured.reference->seen;
  if (options.solve.rest->seconds && FrameSelector(*options.solve.rest).holds(reference.frame, reference.time_s)) {
    if (!rest) rest = FrameRange{reference.frame, reference.frame + 1};
    rest->first = std::min(rest->first, reference.frame);
    if (rest->end >= 0) rest->end = std::max(rest->end, reference.frame + 1);
  }
  if (!rest)
    return tl::unexpected(
        fmt::format("none of the measured frames is in the range: --rest {}", as_typed(*options.solve.rest)));
  return rest;
}

// Subtracts the zero. A target without an ok row in it contradicts the option.
void take_zero(const JointErrors& joint, const FrameRange& stated, Measurement& out) {
  const auto zero = in_frames(stated, out.observations);
  const auto lost = zero ? subtract_zero(joint, *zero, out.samples) : std::nullopt;
  if (!zero)
    out.contradiction = fmt::format("none of the measured frames is in the range: --zero {}", as_typed(stated));
  else if (lost)
    out.contradiction = fmt::format("target '{}' has no ok row in the frames of the zero: --zero {}",
                                    out.reference->site.markers[*lost].name, as_typed(stated));
}

// Computes the joint errors, for `joint` (may be null) and for the zero.
void take_joint_errors(const Solution& solution, const MeasureOptions& options, JointErrors* joint, Measurement& out) {
  JointErrors errors =
      solution.joint_errors ? solution.joint_errors() : budget_errors(out.reference->site, out.samples);
  if (options.zero) take_zero(errors, *options.zero, out);
  if (joint != nullptr) *joint = std::move(errors);
}

}  // namespace

std::optional<std::string> time_problem(const MeasureOptions& options, const InputInfo& input) {
  if (!std::isnan(input.fps)) return std::nullopt;
  std::string needs_times;
  if (options.frames.seconds) needs_times = "--frames " + as_typed(options.frames);
  if (options.solve.rest && options.solve.rest->seconds) needs_times = "--rest " + as_typed(*options.solve.rest);
  if (options.zero && options.zero->seconds) needs_times = "--zero " + as_typed(*options.zero);
  if (input.slow_motion != 1.0) needs_times = fmt::format("--slow-motion {}", input.slow_motion);
  if (needs_times.empty()) return std::nullopt;
  return fmt::format("the frames of the input have no times: {}: give --fps", needs_times);
}

void evaluate(const MeasureOptions& options, Measurement& out, JointErrors* joint) {
  out.warnings = out.notes;
  for (std::string& note : notes_on_frames(out.observations)) out.warnings.push_back(std::move(note));
  for (const Observation& seen : out.observations) out.input_damaged |= seen.decode_error;
  if (!out.reference) {
    out.exit = !out.contradiction.empty() ? Exit::kUsage : out.interrupted ? Exit::kInterrupted : Exit::kRefused;
    return;
  }
  out.refusal.clear();
  complete_markers(out);
  // Without a site file the axes follow the image, so no layout can contradict them.
  if (!options.pitch_mm) {
    if (auto note = symmetry_note(options.site)) out.warnings.push_back(*std::move(note));
  }
  if (auto note = note_on_first_frames(out, options)) out.warnings.push_back(*std::move(note));
  SolveOptions how = options.solve;
  how.rotation_deg = out.input.rotation_deg;
  auto rest = rest_in_frames(options, out);
  if (rest)
    how.rest = *rest;
  else
    how.rest.reset();
  Solution solution = options.method->solve(*out.reference, out.observations, how);
  out.samples = std::move(solution.samples);
  out.chi2_dof = std::move(solution.chi2_dof);
  out.scene = std::move(solution.scene);
  out.poses = std::move(solution.poses);
  out.references_verified = solution.references_verified;
  out.warnings.insert(out.warnings.end(), solution.notes.begin(), solution.notes.end());
  if (out.scene && !out.scene->solved)
    out.warnings.push_back("the method two-stage was used instead of precise: " + out.scene->problem);
  if (!rest) out.contradiction = std::move(rest.error());
  if (solution.moved_at_rest) out.contradiction = rest_contradiction(out, options, *solution.moved_at_rest);
  bool is_processed = false;  // an average over time or repeated pixels can look like a moving reference
  const auto movement = [&out] { return movement_in_frames(*out.reference, out.observations); };
  if (auto fault = distrust_processed(out.processing, is_lossy(out.observations), movement, out.samples)) {
    is_processed = !fault->warning.empty();
    if (is_processed) out.warnings.push_back(std::move(fault->warning));
    out.remedy = std::move(fault->remedy);
  }
  if (joint != nullptr || options.zero) take_joint_errors(solution, options, joint, out);
  out.targets = summarise(*out.reference, out.samples);
  out.spectra = spectra_of(out.samples, out.targets);
  if (auto note = codec_note(out)) out.warnings.push_back(*std::move(note));
  out.exit = out.interrupted ? Exit::kInterrupted : exit_of(out.samples, out.reference->seen.frame, out.input_damaged);
  if (out.exit != Exit::kRefused)
    out.warnings.insert(out.warnings.end(), solution.findings.begin(), solution.findings.end());
  if (!out.contradiction.empty()) out.exit = Exit::kUsage;
  if (out.exit != Exit::kRefused) return;
  if (!solution.remedy.empty() && !is_processed) out.remedy = std::move(solution.remedy);
  std::map<std::string, long> counts;
  for (const Sample& sample : out.samples) {
    if (sample.frame != out.reference->seen.frame) ++counts[word_for(sample.status)];
  }
  std::string list;
  for (const auto& [word, count] : counts) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, word);
  out.refusal = counts.empty() ? "only the reference frame was measured, and two frames are needed"
                               : "no row is ok (" + list + ")";
}

tl::expected<Measurement, InputError> observe_all(const OpenInput& open, const MeasureOptions& options,
                                                  const OnProgress& on_progress, RunHooks doors) {
  Measurement out;
  ObservingRun run(options, out, std::move(doors));
  auto source = open();
  if (!source) return tl::unexpected(source.error());
  if (auto problem = time_problem(options, (*source)->info())) {
    out.contradiction = *std::move(problem);
    return out;
  }
  if (options.reference_frame) {
    if (auto done = refer_to_frame(open, *options.reference_frame, run, out); !done)
      return tl::unexpected(done.error());
  }
  out.input = (*source)->info();
  if (out.reference || !options.reference_frame) {
    if (auto done = measure_all(**source, options, run, out, on_progress); !done) return tl::unexpected(done.error());
    out.input = (*source)->info();
  }
  conclude_log(run.processing(), static_cast<long>(out.observations.size()), out);
  return out;
}

tl::expected<Measurement, InputError> measure(const OpenInput& open, const MeasureOptions& options,
                                              const OnProgress& on_progress, FrameSink* frames) {
  auto out = observe_all(open, options, on_progress, {.frames = frames});
  if (out) evaluate(options, *out);
  return out;
}

}  // namespace moiregauge::internal
