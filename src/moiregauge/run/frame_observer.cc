// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/run/frame_observer.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/image/upper_bits.h"
#include "moiregauge/observation/frame/patch_of_points.h"
#include "moiregauge/observation/reference/reference_by_gratings.h"
#include "moiregauge/run/codec.h"

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

// Builds the reference from an image. `notes` receives the remarks on a site detected in it.
tl::expected<Reference, ReferenceFailure> reference_of(const GreyPicture& picture, const MeasureOptions& options,
                                                       std::vector<std::string>& notes) {
  const Camera lens = options.camera.value_or(Camera{});
  if (!options.pitch_mm && !options.method->needs_circles && lacks_circles(options.site))
    return make_reference_by_gratings(picture, options.site, lens, options.observe);
  if (!options.pitch_mm) return make_reference(picture, options.site, lens, options.observe);
  const bool needs_circles = options.method->needs_circles;
  auto found =
      detect_site(picture, lens, {*options.pitch_mm, options.axes, options.observe, options.choice, needs_circles});
  if (!found) return tl::unexpected(std::move(found.error()));
  found->site = with_prints_scaled(std::move(found->site), {1.0, options.print_scale.u, options.print_scale.spread});
  auto made = needs_circles ? make_reference(picture, found->site, lens, options.observe)
                            : make_reference_in_view(picture, found->site, {found->view, lens},
                                                     std::move(found->search), options.observe);
  if (made) notes = std::move(found->notes);
  return made;
}

// Largest number of rounds. A template learned with a wrong tone curve shows the right one only roughly, but each round
// leaves at most a third of the error.
constexpr int kMaxToneRounds = 5;
// Largest share of the deviation that a round leaves. A template of grey levels shows at least 0.4 of a tone curve, so
// that 0.6 are left, and some noise. With edges sharper than the pixels, 0.86 to 1 are left.
constexpr double kMaxLeft = 0.75;
// Share of clipped pixels from which clipping itself makes edges asymmetric. The rounds then need not get better. Chosen.
constexpr double kMaxClipped = 0.01;

// Skipped frames that are observed at most. Chosen.
constexpr long kMostSkipped = 400;

// Returns true if white or black is clipped in a grating of the reference frame.
bool is_clipped(const Reference& reference, const Frame& frame, int bits) {
  return std::ranges::any_of(reference.seen.markers, [&](const MarkerObservation& marker) {
    return marker.points && clipped_share({frame.luma, bits}, *marker.points) > kMaxClipped;
  });
}

}  // namespace

void FrameObserver::resume(Reference reference, int bits) {
  light_ = LightMap(reference.tone, bits);
  out_.reference = std::move(reference);
  out_.observations.refer_to(*out_.reference);
  follower_.emplace(*out_.reference);
}

// Tries to make `frame` the reference frame. The first failure is kept as the refusal.
bool FrameObserver::refer_to(const Frame& frame) {
  if (!refer_as_light(frame)) {
    out_.reference.reset();
    light_ = LightMap(stated_tone(), out_.input.bits);
    if (!(refer_in_light(frame) && follow_shown_tone(frame)) && !refer_against_assumed_tone(frame)) {
      out_.reference.reset();
      return false;
    }
  }
  out_.notes.insert(out_.notes.end(), reference_notes_.begin(), reference_notes_.end());
  learn_templates(frame);
  return true;
}

// Tries a linear tone curve. An input that does not state its curve may well be linear (industrial cameras). Returns
// false if a curve is stated, or if the grating edges do not show linear light.
bool FrameObserver::refer_as_light(const Frame& frame) {
  const Tone stated = stated_tone();
  if (options_.tone || stated.source != ToneSource::kAssumed || stated.curve.is_linear()) return false;
  light_ = LightMap({{.is_full_range = stated.curve.is_full_range}, ToneSource::kFootage}, out_.input.bits);
  return refer_in_light(frame) && shows_light(*out_.reference, out_.input.bits);
}

// Tries a linear tone curve after the assumed one contradicted the site. Returns false if a curve is stated, or if the
// grating edges show another one. The refusal then stays that of the assumed curve.
bool FrameObserver::refer_against_assumed_tone(const Frame& frame) {
  const Tone stated = stated_tone();
  if (options_.tone || stated.source != ToneSource::kAssumed || stated.curve.is_linear()) return false;
  const std::string refusal = out_.refusal;
  light_ = LightMap({{.is_full_range = stated.curve.is_full_range}, ToneSource::kFootage}, out_.input.bits);
  if (!refer_in_light(frame) || contradicting_tone(*out_.reference, light_.tone(), out_.input.bits)) {
    out_.refusal = refusal;
    return false;
  }
  reference_notes_.push_back(fmt::format(
      "note: the tone curve linear is used, because the site contradicts {}, which is typical of this input. "
      "Give --tone to use another",
      name_of(stated.curve)));
  return true;
}

// Repeats the reference frame with the tone curve of the grating edges, if they contradict the stated one. Edges that
// stay as asymmetric as before show no tone curve, and the curve before is used again.
bool FrameObserver::follow_shown_tone(const Frame& frame) {
  const Tone stated = light_.tone();
  Tone before = stated;
  double deviation = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMaxToneRounds && !options_.tone; ++round) {
    const auto shown = contradicting_tone(*out_.reference, light_.tone(), out_.input.bits);
    if (!shown) break;
    const bool helps = shown->deviation < kMaxLeft * deviation || is_clipped(*out_.reference, frame, out_.input.bits);
    const Tone next = helps ? shown->tone : before;
    before = light_.tone();
    deviation = shown->deviation;
    light_ = LightMap(next, out_.input.bits);
    if (!refer_in_light(frame)) {
      light_ = LightMap(stated, out_.input.bits);
      return refer_in_light(frame);
    }
    if (!helps) break;
  }
  if (light_.tone().source != ToneSource::kFootage) return true;
  reference_notes_.push_back(
      fmt::format("note: the tone curve {} is used, because the edges of the gratings show it (the input states {}{}). "
                  "Give --tone to use another",
                  name_of(light_.tone().curve), stated.source == ToneSource::kTag ? "" : "none, typical is ",
                  name_of(stated.curve)));
  return true;
}

// Returns the tone curve stated by the user, or else by the input.
Tone FrameObserver::stated_tone() const {
  Tone tone = out_.input.tone;
  if (!options_.tone) return tone;
  const bool is_full_range = tone.curve.is_full_range;  // a property of the stream
  tone = {*options_.tone, ToneSource::kOption};
  tone.curve.is_full_range = is_full_range;
  return tone;
}

bool FrameObserver::refer_in_light(const Frame& frame) {
  std::vector<std::string> notes;
  const GreyPicture picture = light_.picture(frame.luma);
  auto made = reference_of(picture, options_, notes);
  if (!made) {
    if (out_.refusal.empty()) {
      out_.refusal = made.error().message;
      out_.picture = KeptPicture{upper_bits(frame.luma, out_.input.bits)};
    }
    if (made.error().problem == ReferenceProblem::kNoSuchMarker) out_.contradiction = made.error().message;
    cannot_succeed_ = made.error().problem == ReferenceProblem::kSiteDisagrees ||
                      made.error().problem == ReferenceProblem::kTooCoarse || !out_.contradiction.empty();
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

void FrameObserver::keep_picture(const Frame& frame) {
  if (frame.number != out_.reference->seen.frame) return;
  if (!processing_.is_referred()) {  // a resumed run
    processing_.refer(*out_.reference, frame.luma);
    learn_templates(frame);
  }
  out_.picture = KeptPicture{upper_bits(frame.luma, out_.input.bits)};
}

Observation FrameObserver::observe(const Frame& frame) {
  const std::size_t markers = site_of(out_, options_).markers.size();
  if (frame.damaged) return unmeasured(frame, markers, "the decoder reported an error in this frame");
  if (!out_.reference && !refer_to(frame)) return unmeasured(frame, markers, out_.refusal);
  // Track and solve rounded values only, so that a resumed or repeated solution has the same bits.
  Observation seen = out_.observations.rounded(look_at(frame));
  (void)follower_->follow(*out_.reference, seen);
  return seen;
}

Observation FrameObserver::look_at(const Frame& frame) {
  const Observation& where = last_ && last_->references_seen ? *last_ : out_.reference->seen;
  // Skipped blocks may report a smaller step than the one that applied, so the coarsest step so far counts.
  const double now = rounding_of(frame.quantiser, *out_.reference, where);
  const double rounding = std::max({now, rounding_, rounding_of(*out_.reference, out_.reference->seen)});
  Observation seen =
      options_.method->observe(light_.picture(frame.luma, rounding), *out_.reference, follower_->prediction());
  seen.frame = frame.number;
  seen.time_s = frame.time_s;
  note_quantisers(frame.quantiser, out_.reference->site, out_.reference->lens, seen);
  return seen;
}

void FrameObserver::skip(const Observation& seen) {
  // As in the first run, damaged frames and frames before the reference frame are not tracked.
  if (!seen.decode_error && (options_.reference_frame || seen.frame >= out_.reference->seen.frame))
    (void)follower_->follow(*out_.reference, seen);
}

void FrameObserver::add(const Frame& frame, const Observation& seen) {
  last_ = seen;
  if (out_.reference) rounding_ = std::max(rounding_, rounding_of(*out_.reference, seen));
  if (repeats_.repeats(frame.luma) && !frame.damaged)
    processing_.repeat(frame.number);
  else if (frame.damaged || !out_.reference)
    processing_.interrupt();
  else
    watch(frame, seen);
  is_after_selected_ = true;
}

void FrameObserver::pass_skipped(const Frame& frame, const std::function<bool()>& is_whole) {
  const bool is_repeated = repeats_.repeats(frame.luma);
  if (std::exchange(is_after_selected_, false))
    observes_skipped_ = skipped_ < kMostSkipped && last_ && processing_.needs_skipped_frames(*last_);
  if (!observes_skipped_ || is_repeated || frame.damaged || !out_.reference) return processing_.interrupt();
  ++skipped_;
  const Observation seen = look_at(frame);
  if (!is_whole()) return processing_.interrupt();
  watch(frame, seen);
}

void FrameObserver::learn_templates(const Frame& frame) {
  if (options_.method->prepare == nullptr) templates_.refer(light_.picture(frame.luma), *out_.reference);
}

void FrameObserver::watch(const Frame& frame, const Observation& seen) {
  Observation with_templates;
  const Reference* reference = nullptr;
  if (templates_.is_ready() && processing_.needs_templates()) {
    with_templates = seen;
    reference = templates_.fit(light_.picture(frame.luma), with_templates);
  }
  if (reference != nullptr)
    processing_.add(*reference, with_templates, frame, out_.input.bits, light_);
  else
    processing_.add(*out_.reference, seen, frame, out_.input.bits, light_);
}

}  // namespace moiregauge::internal
