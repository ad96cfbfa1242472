// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/measure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/detection/identity/layout_symmetry.h"
#include "moiregauge/displacement/follower.h"
#include "moiregauge/image/upper_bits.h"
#include "moiregauge/observation/reference/reference_by_gratings.h"
#include "moiregauge/run/codec.h"
#include "moiregauge/run/frame_notes.h"
#include "moiregauge/run/light.h"
#include "moiregauge/run/repeated_frames.h"

namespace moiregauge::internal {
namespace {

Observation unmeasured(const Frame& frame, std::size_t markers, std::string why) {
  Observation observation;
  observation.frame = frame.number;
  observation.time_s = frame.time_s;
  observation.decode_error = frame.damaged;
  observation.reference_problem = std::move(why);
  observation.markers.resize(markers);
  for (MarkerObservation& marker : observation.markers) marker.loss = Loss::kNotSeen;
  return observation;
}

// `notes`: what the user should know about a site that was made from the picture.
tl::expected<Reference, ReferenceFailure> reference_of(const GreyPicture& picture, const MeasureOptions& options,
                                                       std::vector<std::string>& notes) {
  const Camera lens = options.camera.value_or(Camera{});
  if (!options.pitch_mm && !options.method->needs_circles && lacks_circles(options.site))
    return make_reference_by_gratings(picture, options.site, lens, options.observe);
  if (!options.pitch_mm) return make_reference(picture, options.site, lens, options.observe);
  const bool needs_circles = options.method->needs_circles;
  auto found = detect_site(picture, lens, {*options.pitch_mm, options.axes, options.observe.circles, needs_circles});
  if (!found) return tl::unexpected(std::move(found.error()));
  found->site = with_prints_scaled(std::move(found->site), {1.0, options.print_scale.u, options.print_scale.spread});
  auto made = needs_circles ? make_reference(picture, found->site, lens, options.observe)
                            : make_reference_in_view(picture, found->site, {found->view, lens},
                                                     std::move(found->search), options.observe);
  if (made) notes = std::move(found->notes);
  return made;
}

// A template learned by a wrong tone curve shows the right one roughly: each round leaves a third of its error or less.
constexpr int kMaxToneRounds = 5;

// The run's state while frames go by.
class Run {
 public:
  // Of a run that goes on without a reference frame nothing is kept: it tries every frame again.
  Run(const MeasureOptions& options, Measurement& out, RunHooks doors)
      : options_(options), out_(out), frames_(doors.frames), journal_(doors.journal) {
    if (!doors.so_far.reference) return;
    light_ = LightMap(doors.so_far.reference->tone, doors.so_far.input.bits);
    out_.reference = std::move(doors.so_far.reference);
    out_.notes = std::move(doors.so_far.notes);
    out_.observations.refer_to(*out_.reference);
    kept_ = std::move(doors.so_far.observations);
    is_journaled_ = true;
    follower_.emplace(*out_.reference);
  }

  // Tries to make `frame` the reference frame; the failure is kept in words (the first one is the one to report).
  bool refer_to(const Frame& frame) {
    if (!refer_as_light(frame)) {
      light_ = LightMap(stated_tone(), out_.input.bits);
      if (!refer_in_light(frame) || !follow_shown_tone(frame)) return false;
    }
    out_.notes.insert(out_.notes.end(), reference_notes_.begin(), reference_notes_.end());
    return true;
  }

  // An input that does not say which curve made its grey levels may well be of none: an industrial camera's. False where
  // something says so, or where the prints' edges do not show it.
  bool refer_as_light(const Frame& frame) {
    const Tone stated = stated_tone();
    if (options_.tone || stated.source != ToneSource::kAssumed || stated.curve.is_linear()) return false;
    light_ = LightMap({{.is_full_range = stated.curve.is_full_range}, ToneSource::kFootage}, out_.input.bits);
    return refer_in_light(frame) && shows_light(*out_.reference, out_.input.bits);
  }

  // If the prints' edges contradict the stated tone curve, the reference frame is made again by theirs.
  bool follow_shown_tone(const Frame& frame) {
    const Tone stated = light_.tone();
    for (int round = 0; round < kMaxToneRounds && !options_.tone; ++round) {
      const auto shown = contradicting_tone(*out_.reference, light_.tone(), out_.input.bits);
      if (!shown) break;
      light_ = LightMap(*shown, out_.input.bits);
      if (refer_in_light(frame)) continue;
      light_ = LightMap(stated, out_.input.bits);
      return refer_in_light(frame);
    }
    if (light_.tone().source != ToneSource::kFootage) return true;
    reference_notes_.push_back(
        fmt::format("note: grey levels are mapped to light by {}: the edges of the prints show this tone curve (the "
                    "input {} {}). Give --tone to state another",
                    name_of(light_.tone().curve), stated.source == ToneSource::kTag ? "says" : "does not say; usual is",
                    name_of(stated.curve)));
    return true;
  }

  // The user's statement of the tone curve, or the input's.
  [[nodiscard]] Tone stated_tone() const {
    Tone tone = out_.input.tone;
    if (!options_.tone) return tone;
    const bool is_full_range = tone.curve.is_full_range;  // black and white are the stream's whatever the curve
    tone = {*options_.tone, ToneSource::kOption};
    tone.curve.is_full_range = is_full_range;
    return tone;
  }

  bool refer_in_light(const Frame& frame) {
    std::vector<std::string> notes;
    const GreyPicture picture = light_.picture(frame.luma);
    auto made = reference_of(picture, options_, notes);
    if (!made) {
      if (out_.refusal.empty()) {
        out_.refusal = made.error().message;
        out_.picture = KeptPicture{upper_bits(frame.luma, out_.input.bits)};
      }
      hopeless_ = made.error().problem == ReferenceProblem::kSiteDisagrees ||
                  made.error().problem == ReferenceProblem::kTooCoarse;
      return false;
    }
    out_.refusal.clear();
    reference_notes_ = std::move(notes);
    out_.reference = std::move(*made);
    out_.reference->tone = light_.tone();
    if (light_.maps()) out_.reference->light_per_grey = light_per_grey(*out_.reference, frame.luma, picture.luma);
    if (options_.method->prepare != nullptr) options_.method->prepare(picture, *out_.reference);
    out_.reference->seen.frame = frame.number;
    out_.reference->seen.time_s = frame.time_s;
    note_quantisers(frame.quantiser, out_.reference->site, out_.reference->lens, out_.reference->seen);
    out_.picture = KeptPicture{upper_bits(frame.luma, out_.input.bits)};
    follower_.emplace(*out_.reference);
    processing_.refer(*out_.reference, frame.luma);
    out_.observations.refer_to(*out_.reference);
    return true;
  }

  void measure_frame(const Frame& frame, const FrameSource& source) {
    const bool had_reference = out_.reference.has_value();
    Observation seen = observed(frame);
    if (!source.is_frame_whole()) {
      Frame torn = frame;
      torn.damaged = true;
      if (!had_reference && out_.reference) {
        out_.reference.reset();
        out_.refusal = "the file was cut short while its first frames were read";
      }
      seen = observed(torn);
    }
    out_.observations.push_back(seen);
    put(frame, seen);
    if (journal_ == nullptr) return;
    if (out_.reference && !std::exchange(is_journaled_, true)) journal_->refer(*out_.reference, reference_notes_);
    journal_->add(out_.observations.packed(out_.observations.size() - 1));
  }

  // Was the selection's next frame seen before this run went on?
  [[nodiscard]] bool is_kept() const { return out_.observations.size() < kept_.size(); }
  // False when it is not this frame.
  bool pass_over(const Frame& frame) {
    const std::size_t n = out_.observations.size();
    const Observation seen = kept_[n];
    if (seen.frame != frame.number) return false;
    keep_picture(frame);
    // As it was the first time: neither damaged frames nor those before the reference frame were followed.
    if (!seen.decode_error && (options_.reference_frame || seen.frame >= out_.reference->seen.frame))
      (void)follower_->follow(*out_.reference, seen);
    out_.observations.append(kept_, n, n + 1);
    put(frame, seen);
    return true;
  }
  void keep_picture(const Frame& frame) {
    if (frame.number != out_.reference->seen.frame) return;
    if (!processing_.is_referred()) processing_.refer(*out_.reference, frame.luma);
    out_.picture = KeptPicture{upper_bits(frame.luma, out_.input.bits)};
  }
  // A run that is stopped again while it passes over frames still holds them all.
  void stop() {
    out_.interrupted = true;
    out_.observations.append(kept_, out_.observations.size(), kept_.size());
  }
  [[nodiscard]] std::optional<std::string> note_on_repeats() const {
    const std::vector<long> repeated = processing_.result().repeated;
    if (repeated.empty()) return std::nullopt;
    return fmt::format(
        "{} of {} frames repeat{} the one before to the last bit (the first is frame {}): a dropped frame or "
        "an unchanging source; rows of repeated frames are not trusted where a target moves, for their time is an "
        "earlier one",
        repeated.size(), out_.observations.size(), repeated.size() == 1 ? "s" : "", repeated.front());
  }
  [[nodiscard]] CameraProcessing processing() const { return processing_.result(); }
  [[nodiscard]] bool hopeless() const { return hopeless_; }
  [[nodiscard]] bool can_go_on() const { return journal_ == nullptr || journal_->good(); }

 private:
  // A frame that was added to the observations, as they have it.
  void put(const Frame& frame, const Observation& seen) {
    if (out_.reference) rounding_ = std::max(rounding_, rounding_of(*out_.reference, seen));
    if (repeats_.repeats(frame.luma) && !frame.damaged)
      processing_.repeat(frame.number);
    else if (frame.damaged || !out_.reference)
      processing_.interrupt();
    else
      processing_.add(*out_.reference, seen, frame, out_.input.bits);
    if (frames_ == nullptr) return;
    const bool is_before = !out_.reference || (!options_.reference_frame && frame.number < out_.reference->seen.frame);
    frames_->add(frame, out_.input.bits, is_before ? nullptr : &*out_.reference, seen);
  }
  Observation observed(const Frame& frame) {
    const std::size_t markers = site_of(out_, options_).markers.size();
    if (frame.damaged) return unmeasured(frame, markers, "the decoder reported an error in this frame");
    if (!out_.reference && !refer_to(frame)) return unmeasured(frame, markers, out_.refusal);
    const Observation last = out_.observations.empty() ? out_.reference->seen : out_.observations.back();
    const Observation& where = last.references_seen ? last : out_.reference->seen;
    // Skipped blocks do not report what they were judged by: the coarsest so far counts.
    const double now = rounding_of(frame.quantiser, *out_.reference, where);
    const double rounding = std::max({now, rounding_, rounding_of(*out_.reference, out_.reference->seen)});
    Observation seen =
        options_.method->observe(light_.picture(frame.luma, rounding), *out_.reference, follower_->prediction(), work_);
    seen.frame = frame.number;
    seen.time_s = frame.time_s;
    note_quantisers(frame.quantiser, out_.reference->site, out_.reference->lens, seen);
    // Only values that are kept are followed and solved: a run that is resumed or solved again gives the same bits.
    seen = out_.observations.rounded(seen);
    (void)follower_->follow(*out_.reference, seen);
    return seen;
  }

  const MeasureOptions& options_;
  Measurement& out_;
  FrameSink* frames_;
  JournalSink* journal_;
  Observations kept_;                         // by a run before this one
  bool is_journaled_ = false;                 // the reference frame
  std::vector<std::string> reference_notes_;  // of its making
  std::optional<Follower> follower_;
  PatchWorkspace work_;
  LightMap light_;
  double rounding_ = 0.0;  // of the observations so far
  RepeatedFrames repeats_;
  ProcessingWatch processing_;
  bool hopeless_ = false;
};

void note_damage(Measurement& out, const InputError& error) {
  out.input_damaged = true;
  out.notes.push_back(error.message);
}

std::string as_typed(const FrameRange& range) {
  return fmt::format("{}:{}{}", range.first, range.end >= 0 ? std::to_string(range.end) : std::string{},
                     range.step != 1 ? fmt::format(":{}", range.step) : std::string{});
}

InputError no_pictures(const std::string& path) {
  return {InputErrorKind::kUnreadable, "no pictures: " + path + ": give a video or a folder of pictures"};
}

std::string no_such_frame(const std::string& option, const InputInfo& input, long frames) {
  return fmt::format("no such frame: {}: {} has {}, the first is 0", option, input.path,
                     frames == 1 ? "1 frame" : fmt::format("{} frames", frames));
}

// --reference-frame: read up to that frame through a source of its own; it may lie outside the selection.
tl::expected<void, InputError> refer_to_frame(const OpenInput& open, long number, Run& run, Measurement& out) {
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
    else if (!run.refer_to(**frame))
      out.refusal = fmt::format("reference frame {}: {}", number, out.refusal);
    return {};
  }
}

InputError not_the_same(const std::string& path) {
  return {InputErrorKind::kUnreadable,
          fmt::format("cannot resume: {}: its frames are not those that were measured: use --restart", path)};
}

long selected(const FrameRange& range, long frames) {
  if (frames < 0 && range.end < 0) return -1;
  const long end = frames < 0 ? range.end : range.end < 0 ? frames : std::min(range.end, frames);
  return std::max(0L, (end - range.first + range.step - 1) / range.step);
}

tl::expected<void, InputError> measure_all(FrameSource& source, const MeasureOptions& options, Run& run,
                                           Measurement& out, const OnProgress& on_progress) {
  const long expected = selected(options.frames, source.info().frames);
  long frames = 0;  // of the input, as far as it was read
  while (true) {
    auto frame = source.next();
    if (!frame) {
      if (frames == 0) return tl::unexpected(frame.error());
      note_damage(out, frame.error());
      break;
    }
    if (!*frame) break;
    const Frame& now = **frame;
    frames = now.number + 1;
    if (options.frames.end >= 0 && now.number >= options.frames.end) break;
    if (!options.frames.holds(now.number)) continue;
    if (!run.is_kept())
      run.measure_frame(now, source);
    else if (!run.pass_over(now))
      return tl::unexpected(not_the_same(source.info().path));
    if (run.hopeless() && !out.reference) break;
    if (!run.can_go_on() || (on_progress && !on_progress(static_cast<long>(out.observations.size()), expected))) {
      run.stop();
      break;
    }
  }
  if (run.is_kept()) return tl::unexpected(not_the_same(source.info().path));
  if (frames == 0) return tl::unexpected(no_pictures(source.info().path));
  if (out.observations.empty() && !out.interrupted)
    out.contradiction =
        no_such_frame(fmt::format("--frames {}:{}", options.frames.first,
                                  options.frames.end >= 0 ? fmt::format("{}", options.frames.end) : std::string{}),
                      source.info(), frames);
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

// Frames that went by before one could be the reference frame: their references may all be there.
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
      "frames {} to {} are not measured, because they come before the reference frame {}, the first that shows every "
      "marker (frame {}: {}); their rows say reference-lost: choose another with --reference-frame",
      first->frame, last, reference, first->frame, first->reference_problem);
}

std::string rest_contradiction(const Measurement& measured, const MeasureOptions& options, const MovedAtRest& moved) {
  return fmt::format("not at rest: target '{}' moves by {:.4f} mm (u {:.4f} mm) between frames {} and {} of --rest {}",
                     measured.reference->site.markers[moved.marker].name, moved.mm, moved.u_mm, moved.from, moved.to,
                     as_typed(*options.solve.rest));
}

}  // namespace

void evaluate(const MeasureOptions& options, Measurement& out) {
  out.warnings = out.notes;
  for (std::string& note : notes_on_frames(out.observations)) out.warnings.push_back(std::move(note));
  for (const Observation& seen : out.observations) out.input_damaged |= seen.decode_error;
  if (!out.reference) {
    out.exit = !out.contradiction.empty() ? Exit::kUsage : out.interrupted ? Exit::kInterrupted : Exit::kRefused;
    return;
  }
  out.refusal.clear();
  complete_markers(out);
  // Without a site file the picture's own directions count, and there is no layout to contradict them.
  if (!options.pitch_mm) {
    if (auto note = symmetry_note(options.site)) out.warnings.push_back(*std::move(note));
  }
  if (auto note = note_on_first_frames(out, options)) out.warnings.push_back(*std::move(note));
  SolveOptions how = options.solve;
  how.rotation_deg = out.input.rotation_deg;
  Solution solution = options.method->solve(*out.reference, out.observations, how);
  out.samples = std::move(solution.samples);
  out.chi2_dof = std::move(solution.chi2_dof);
  out.scene = std::move(solution.scene);
  out.references_verified = solution.references_verified;
  out.warnings.insert(out.warnings.end(), solution.notes.begin(), solution.notes.end());
  if (out.scene && !out.scene->solved) out.warnings.push_back(out.scene->problem + ": measured as by two-stage");
  if (solution.moved_at_rest) out.contradiction = rest_contradiction(out, options, *solution.moved_at_rest);
  if (auto fault = distrust_processed(out.processing, is_lossy(out.observations), out.samples)) {
    if (!fault->warning.empty()) out.warnings.push_back(std::move(fault->warning));
    out.remedy = std::move(fault->remedy);
  }
  out.targets = summarise(*out.reference, out.samples);
  out.spectra = spectra_of(out.samples, out.targets);
  if (auto note = codec_note(out)) out.warnings.push_back(*std::move(note));
  out.exit = out.interrupted ? Exit::kInterrupted : exit_of(out.samples, out.reference->seen.frame, out.input_damaged);
  if (out.exit != Exit::kRefused)
    out.warnings.insert(out.warnings.end(), solution.findings.begin(), solution.findings.end());
  if (!out.contradiction.empty()) out.exit = Exit::kUsage;
  if (out.exit != Exit::kRefused) return;
  if (!solution.remedy.empty()) out.remedy = std::move(solution.remedy);
  std::map<std::string, long> counts;
  for (const Sample& sample : out.samples) {
    if (sample.frame != out.reference->seen.frame) ++counts[word_for(sample.status)];
  }
  std::string list;
  for (const auto& [word, count] : counts) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, word);
  out.refusal =
      counts.empty() ? "only the reference frame was measured; two frames are needed" : "no row is ok (" + list + ")";
}

tl::expected<Measurement, InputError> observe_all(const OpenInput& open, const MeasureOptions& options,
                                                  const OnProgress& on_progress, RunHooks doors) {
  Measurement out;
  Run run(options, out, std::move(doors));
  if (options.reference_frame) {
    if (auto done = refer_to_frame(open, *options.reference_frame, run, out); !done)
      return tl::unexpected(done.error());
  }
  auto source = open();
  if (!source) return tl::unexpected(source.error());
  out.input = (*source)->info();
  if (out.reference || !options.reference_frame) {
    if (auto done = measure_all(**source, options, run, out, on_progress); !done) return tl::unexpected(done.error());
    out.input = (*source)->info();
  }
  if (out.reference) out.input.tone = out.reference->tone;
  out.processing = run.processing();
  if (auto note = run.note_on_repeats()) out.notes.push_back(*std::move(note));
  out.notes.insert(out.notes.begin(), out.input.warnings.begin(), out.input.warnings.end());
  if (std::isnan(out.input.fps)) out.notes.emplace_back("the pictures carry no time: time_s is NaN (give --fps)");
  return out;
}

tl::expected<Measurement, InputError> measure(const OpenInput& open, const MeasureOptions& options,
                                              const OnProgress& on_progress, FrameSink* frames) {
  auto out = observe_all(open, options, on_progress, {.frames = frames});
  if (out) evaluate(options, *out);
  return out;
}

}  // namespace moiregauge::internal
