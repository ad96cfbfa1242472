// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/measure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/image/upper_bits.h"
#include "moiregauge/run/codec.h"
#include "moiregauge/run/frame_notes.h"
#include "moiregauge/run/repeated_frames.h"

namespace moiregauge {
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
  if (!options.pitch_mm) return make_reference(picture, options.site, lens, options.observe);
  const bool needs_circles = options.method->needs_circles;
  auto found = look_for_site(picture, lens, {*options.pitch_mm, options.axes, options.observe.circles, needs_circles});
  if (!found) return tl::unexpected(std::move(found.error()));
  found->site = with_prints_scaled(std::move(found->site), {1.0, options.print_scale.u, options.print_scale.spread});
  auto made = needs_circles ? make_reference(picture, found->site, lens, options.observe)
                            : make_reference_in_view(picture, found->site, {found->view, lens},
                                                     std::move(found->search), options.observe);
  if (made) notes = std::move(found->notes);
  return made;
}

// The run's state while frames go by.
class Run {
 public:
  // Of a run that goes on without a reference frame nothing is kept: it tries every frame again.
  Run(const MeasureOptions& options, Measurement& out, WatchDoors doors)
      : options_(options), out_(out), frames_(doors.frames), journal_(doors.journal) {
    if (!doors.so_far.reference) return;
    out_.reference = std::move(doors.so_far.reference);
    out_.notes = std::move(doors.so_far.notes);
    kept_ = std::move(doors.so_far.observations);
    is_journaled_ = true;
    follower_.emplace(*out_.reference);
  }

  // Tries to make `frame` the reference frame; the failure is kept in words (the first one is the one to report).
  bool refer_to(const Frame& frame) {
    std::vector<std::string> notes;
    auto made = reference_of({frame.luma, out_.input.bits}, options_, notes);
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
    out_.notes.insert(out_.notes.end(), notes.begin(), notes.end());
    reference_notes_ = std::move(notes);
    out_.reference = std::move(*made);
    if (options_.method->prepare != nullptr) options_.method->prepare({frame.luma, out_.input.bits}, *out_.reference);
    out_.reference->seen.frame = frame.number;
    out_.reference->seen.time_s = frame.time_s;
    note_quantisers(frame.quantiser, out_.reference->site, out_.reference->lens, out_.reference->seen);
    out_.picture = KeptPicture{upper_bits(frame.luma, out_.input.bits)};
    follower_.emplace(*out_.reference);
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
    put(frame, std::move(seen));
    if (journal_ == nullptr) return;
    if (out_.reference && !std::exchange(is_journaled_, true)) journal_->refer(*out_.reference, reference_notes_);
    journal_->add(out_.observations.back());
  }

  // Was the selection's next frame seen before this run went on?
  [[nodiscard]] bool is_kept() const { return out_.observations.size() < kept_.size(); }
  // False when it is not this frame.
  bool pass_over(const Frame& frame) {
    Observation seen = std::move(kept_[out_.observations.size()]);
    if (seen.frame != frame.number) return false;
    keep_picture(frame);
    // As it was the first time: neither damaged frames nor those before the reference frame were followed.
    if (!seen.decode_error && (options_.reference_frame || seen.frame >= out_.reference->seen.frame))
      (void)follower_->follow(*out_.reference, seen);
    put(frame, std::move(seen));
    return true;
  }
  void keep_picture(const Frame& frame) {
    if (frame.number == out_.reference->seen.frame) out_.picture = KeptPicture{upper_bits(frame.luma, out_.input.bits)};
  }
  // A run that is stopped again while it passes over frames still holds them all.
  void stop() {
    out_.interrupted = true;
    out_.observations.insert(out_.observations.end(), kept_.begin() + std::min(kept_.size(), out_.observations.size()),
                             kept_.end());
  }
  [[nodiscard]] std::optional<std::string> note_on_repeats() const {
    if (repeated_ == 0) return std::nullopt;
    return fmt::format(
        "{} of {} frames repeat{} the one before to the last bit (the first is frame {}): a dropped frame or "
        "an unchanging source; the time of a repeated frame is not that of what it shows",
        repeated_, out_.observations.size(), repeated_ == 1 ? "s" : "", first_repeated_);
  }
  [[nodiscard]] bool hopeless() const { return hopeless_; }
  [[nodiscard]] bool can_go_on() const { return journal_ == nullptr || journal_->good(); }

 private:
  void put(const Frame& frame, Observation seen) {
    rounding_ = std::max(rounding_, rounding_of(seen));
    out_.observations.push_back(std::move(seen));
    if (repeats_.repeats(frame.luma) && !frame.damaged && ++repeated_ == 1) first_repeated_ = frame.number;
    if (frames_ == nullptr) return;
    const bool is_before = !out_.reference || (!options_.reference_frame && frame.number < out_.reference->seen.frame);
    frames_->add(frame, out_.input.bits, is_before ? nullptr : &*out_.reference, out_.observations.back());
  }
  Observation observed(const Frame& frame) {
    const std::size_t markers = site_of(out_, options_).markers.size();
    if (frame.damaged) return unmeasured(frame, markers, "the decoder reported an error in this frame");
    if (!out_.reference && !refer_to(frame)) return unmeasured(frame, markers, out_.refusal);
    const Observation& last = out_.observations.empty() ? out_.reference->seen : out_.observations.back();
    const Observation& where = last.references_seen ? last : out_.reference->seen;
    // Skipped blocks do not report what they were judged by: the coarsest so far counts.
    const double now = rounding_of(frame.quantiser, out_.reference->site, out_.reference->lens, where);
    const double rounding = std::max({now, rounding_, rounding_of(out_.reference->seen)});
    Observation seen = options_.method->observe({frame.luma, out_.input.bits, rounding}, *out_.reference,
                                                follower_->prediction(), work_);
    seen.frame = frame.number;
    seen.time_s = frame.time_s;
    note_quantisers(frame.quantiser, out_.reference->site, out_.reference->lens, seen);
    (void)follower_->follow(*out_.reference, seen);
    return seen;
  }

  const MeasureOptions& options_;
  Measurement& out_;
  FrameSink* frames_;
  JournalSink* journal_;
  std::vector<Observation> kept_;             // by a run before this one
  bool is_journaled_ = false;                 // the reference frame
  std::vector<std::string> reference_notes_;  // of its making
  std::optional<Follower> follower_;
  PatchWorkspace work_;
  double rounding_ = 0.0;  // of the observations so far
  RepeatedFrames repeats_;
  long repeated_ = 0, first_repeated_ = -1;
  bool hopeless_ = false;
};

void note_damage(Measurement& out, const InputError& error) {
  out.input_damaged = true;
  out.notes.push_back(error.message);
}

// --reference-frame: read up to that frame through a source of its own; it may lie outside the selection.
tl::expected<void, InputError> refer_to_frame(const OpenInput& open, long number, Run& run, Measurement& out) {
  auto source = open();
  if (!source) return tl::unexpected(source.error());
  out.input = (*source)->info();
  while (true) {
    auto frame = (*source)->next();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) {
      out.refusal = fmt::format("reference frame {} is not in the input", number);
      return {};
    }
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
  bool any = false;
  while (true) {
    auto frame = source.next();
    if (!frame) {
      if (!any) return tl::unexpected(frame.error());
      note_damage(out, frame.error());
      break;
    }
    if (!*frame) break;
    any = true;
    const Frame& now = **frame;
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
  if (!any)
    return tl::unexpected(InputError{InputErrorKind::kUnreadable,
                                     "no pictures: " + source.info().path + ": give a video or a folder of pictures"});
  return {};
}

}  // namespace

const Site& site_of(const Measurement& measurement, const MeasureOptions& options) {
  return measurement.reference ? measurement.reference->site : options.site;
}

void complete_markers(Seen& seen) {
  if (!seen.reference) return;
  MarkerObservation not_seen;
  not_seen.loss = Loss::kNotSeen;
  for (Observation& frame : seen.observations) frame.markers.resize(seen.reference->site.markers.size(), not_seen);
}

void conclude(const MeasureOptions& options, Measurement& out) {
  out.warnings = out.notes;
  for (std::string& note : notes_on_frames(out.observations)) out.warnings.push_back(std::move(note));
  for (const Observation& seen : out.observations) out.input_damaged |= seen.decode_error;
  if (out.observations.empty() && out.refusal.empty()) out.refusal = "no frame of the input is selected by --frames";
  if (!out.reference) {
    out.exit = out.interrupted ? Exit::kInterrupted : Exit::kRefused;
    return;
  }
  out.refusal.clear();
  complete_markers(out);
  SolveOptions how = options.solve;
  how.rotation_deg = out.input.rotation_deg;
  Solution solution = options.method->solve(*out.reference, out.observations, how);
  out.samples = std::move(solution.samples);
  out.chi2_dof = std::move(solution.chi2_dof);
  out.scene = std::move(solution.scene);
  out.references_verified = solution.references_verified;
  out.warnings.insert(out.warnings.end(), solution.notes.begin(), solution.notes.end());
  if (out.scene && !out.scene->solved) out.warnings.push_back(out.scene->problem + ": measured as by two-stage");
  out.targets = summarise(*out.reference, out.samples);
  out.spectra = spectra_of(out.samples, out.targets);
  if (auto note = codec_note(out)) out.warnings.push_back(*std::move(note));
  out.exit = out.interrupted ? Exit::kInterrupted : exit_of(out.samples, out.reference->seen.frame, out.input_damaged);
  if (out.exit != Exit::kRefused) return;
  std::map<std::string, long> counts;
  for (const Sample& sample : out.samples) {
    if (sample.frame != out.reference->seen.frame) ++counts[word_for(sample.status)];
  }
  std::string list;
  for (const auto& [word, count] : counts) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, word);
  out.refusal =
      counts.empty() ? "only the reference frame was measured; two frames are needed" : "no row is ok (" + list + ")";
}

tl::expected<Measurement, InputError> watch(const OpenInput& open, const MeasureOptions& options,
                                            const OnProgress& on_progress, WatchDoors doors) {
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
  if (auto note = run.note_on_repeats()) out.notes.push_back(*std::move(note));
  out.notes.insert(out.notes.begin(), out.input.warnings.begin(), out.input.warnings.end());
  if (std::isnan(out.input.fps)) out.notes.emplace_back("the pictures carry no time: time_s is NaN (give --fps)");
  return out;
}

tl::expected<Measurement, InputError> measure(const OpenInput& open, const MeasureOptions& options,
                                              const OnProgress& on_progress, FrameSink* frames) {
  auto out = watch(open, options, on_progress, {.frames = frames});
  if (out) conclude(options, *out);
  return out;
}

}  // namespace moiregauge
