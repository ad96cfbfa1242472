// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/displacement/continuity.h"
#include "moiregauge/displacement/precise/tracked_scene.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/library/convert.h"
#include "moiregauge/live/key_frames.h"
#include "moiregauge/run/frame_observer.h"

namespace moiregauge {
namespace {

using Travel = std::vector<internal::Extent<internal::frame::Board>>;

}  // namespace

struct Tracker::State {
  explicit State(internal::MeasureOptions wanted) : options(std::move(wanted)), observer(options, run) {}

  Expected<TrackedFrame> update(const ImageView& image, double time_s);
  void begin(const ImageView& image);
  void become_reference(TrackedFrame& out);
  void mark_leaps(const Travel& travel);
  void solve_if_due();
  [[nodiscard]] internal::Samples samples_of(const internal::Observation& seen, const Travel& travel) const;

  internal::MeasureOptions options;
  internal::Measurement run;  // input, reference frame, notes
  internal::FrameObserver observer;
  std::optional<internal::Follower> follower;
  internal::KeyFrames keys{{.max_frames = kMaxKeyFrames}};
  std::unique_ptr<internal::TrackedScene> scene;
  std::vector<std::string> names;
  std::vector<bool> is_far;  // targets that moved further between frames than continuity allows, one per site marker
  Travel last_travel;
  long frames = 0;
  long measured = 0;    // frames since the reference frame, it included
  long next_solve = 2;  // in measured frames
};

void Tracker::State::begin(const ImageView& image) {
  run.input.path = "camera";
  run.input.width = image.width;
  run.input.height = image.height;
  run.input.bits = image.bits;
}

void Tracker::State::become_reference(TrackedFrame& out) {
  const internal::Reference& reference = *run.reference;
  out.is_reference = true;
  follower.emplace(reference);
  keys.refer_to(reference);
  is_far.assign(reference.site.markers.size(), false);
  last_travel.assign(reference.site.markers.size(), {internal::kNotMeasured, internal::kNotMeasured});
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i)
    if (internal::is_target(reference, i)) names.push_back(reference.site.markers[i].name);
}

void Tracker::State::mark_leaps(const Travel& travel) {
  for (std::size_t i = 0; i < travel.size(); ++i) {
    const auto& grating = run.reference->site.markers[i].grating;
    if (!grating) continue;
    const auto step = travel[i] - last_travel[i];
    const double limit = internal::kSureOfOrder * grating->pitch_mm;
    if (std::abs(step.x) > limit || std::abs(step.y) > limit) is_far[i] = true;
    if (!std::isnan(travel[i].x)) last_travel[i].x = travel[i].x;
    if (!std::isnan(travel[i].y)) last_travel[i].y = travel[i].y;
  }
}

// Solves after 2, 4, 8, ... frames. When the key frames are thinned, the next power of two has come as well.
void Tracker::State::solve_if_due() {
  if (measured < next_solve) return;
  next_solve *= 2;
  scene = std::make_unique<internal::TrackedScene>(
      *run.reference, std::make_shared<const internal::Observations>(keys.frames()), options.solve);
}

internal::Samples Tracker::State::samples_of(const internal::Observation& seen, const Travel& travel) const {
  if (scene && scene->problem().empty()) return scene->measure(seen, travel, is_far);
  // Without a scene, `two-stage` gives the displacement, which is not trusted.
  internal::Observations one(*run.reference);
  one.push_back(seen);
  internal::Samples samples = internal::solve_two_stage(*run.reference, one, options.solve).samples;
  for (internal::Sample& sample : samples) {
    const bool is_reference = seen.frame == run.reference->seen.frame;
    if (!is_reference && sample.status == internal::Status::kOk) sample.status = internal::Status::kUntrusted;
  }
  return samples;
}

Expected<TrackedFrame> Tracker::State::update(const ImageView& image, double time_s) {
  if (frames == 0) begin(image);
  if (image.width != run.input.width || image.height != run.input.height || image.bits != run.input.bits)
    return internal::public_error(
        internal::Exit::kInputUnreadable,
        fmt::format("the frame has another size or depth: frame {}: give {} x {} px of {} bits, as the first", frames,
                    run.input.width, run.input.height, run.input.bits));
  TrackedFrame out;
  internal::Frame frame;
  frame.number = frames++;
  frame.time_s = time_s;
  frame.luma = internal::to_luma(image);
  const bool had_reference = run.reference.has_value();
  const internal::Observation seen = observer.observe(frame);
  observer.add(frame, seen);
  if (!run.reference) {
    out.problem = run.refusal;
    return out;
  }
  if (!had_reference) become_reference(out);
  const Travel travel = follower->follow(*run.reference, seen);
  mark_leaps(travel);
  keys.add(seen);
  ++measured;
  solve_if_due();
  for (const internal::Sample& sample : samples_of(seen, travel)) out.samples.push_back(internal::to_public(sample));
  if (!seen.references_seen) out.problem = "too few references were found in this frame";
  return out;
}

Expected<Tracker> Tracker::create(const MeasureOptions& options) {
  auto wanted = internal::to_internal(options);
  if (!wanted) return tl::unexpected(wanted.error());
  if (options.method != "precise")
    return internal::public_error(internal::Exit::kUsage,
                                  "the method cannot track: Tracker: set MeasureOptions::method to precise");
  return Tracker(std::make_unique<State>(*std::move(wanted)));
}

Expected<TrackedFrame> Tracker::update(const ImageView& image, double time_s) { return state_->update(image, time_s); }

const std::vector<std::string>& Tracker::target_names() const { return state_->names; }

long Tracker::frames() const { return state_->frames; }

std::vector<std::string> Tracker::warnings() const {
  std::vector<std::string> out = state_->run.notes;
  if (!state_->scene) return out;
  const internal::PreciseScene& scene = state_->scene->scene();
  if (!scene.problem.empty()) out.push_back(scene.problem);
  out.insert(out.end(), scene.notes.begin(), scene.notes.end());
  return out;
}

Tracker::Tracker(std::unique_ptr<State> state) : state_(std::move(state)) {}
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;
Tracker::~Tracker() = default;

}  // namespace moiregauge
