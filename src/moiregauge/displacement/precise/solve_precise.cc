// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/bundle_frames.h"
#include "moiregauge/displacement/continuity.h"
#include "moiregauge/displacement/layout_advice.h"
#include "moiregauge/displacement/precise/apparent_size.h"
#include "moiregauge/displacement/precise/precise_budget.h"
#include "moiregauge/displacement/precise/precise_prior.h"
#include "moiregauge/displacement/precise/precise_scene.h"
#include "moiregauge/displacement/precise/precise_status.h"
#include "moiregauge/displacement/precise/rest_claim.h"
#include "moiregauge/displacement/precise/rolling_shutter_text.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/observation/print/fine_pitch.h"
#include "moiregauge/planning/codec_error.h"

namespace moiregauge::internal {
namespace {

// An axis that the print does not show has no uncertainty to speak of.
constexpr double kShownWithin = 0.25;  // pitches

Solution fallback(const Reference& reference, const Observations& observations, const SolveOptions& options,
                  std::string why) {
  Solution solution = solve_two_stage(reference, observations, options);
  solution.scene.emplace();
  solution.scene->problem = std::move(why);
  return solution;
}

// Rows read one after the other, and taken for rows read at once: an error that u knows nothing of.
Solution untrusted(Solution solution, const Reference& reference) {
  for (Sample& sample : solution.samples) {
    if (sample.status == Status::kOk && sample.frame != reference.seen.frame) sample.status = Status::kUntrusted;
  }
  return solution;
}

// Fits of a compressed recording's frames as if noise were all that is wrong with them; not ok of any other.
struct ByNoise {
  FrameFit now, then;
};

void fill(Sample& sample, const Grating& grating, const PreciseBudget& budget, const FrameFit& now,
          const ByNoise& by_noise) {
  const std::size_t i = sample.marker;
  const FrameFit& then = budget.then();
  if (!then.ok || std::isnan(then.shift[i].x)) {
    sample.status = Status::kLost;
    return;
  }
  sample.displacement = now.shift[i] - then.shift[i];
  sample.budget = by_noise.now.ok ? budget.budget(now, by_noise.now, by_noise.then, i, sample.displacement)
                                  : budget.budget(now, i, sample.displacement);
  sample.u = total(sample.budget);
  // Judged by noise alone: far away u is the scale's and the axis' too.
  const auto& b = sample.budget;
  const auto by_noise_alone = hypot3(b.noise, b.references, b.reference_frame);
  for (const auto axis : {&BoardExtent::x, &BoardExtent::y}) {
    if (!(by_noise_alone.*axis < kShownWithin * grating.pitch_mm))
      sample.displacement.*axis = sample.u.*axis = kNotMeasured;
  }
}

// By what a target's own motion leaves open between its rows' time and its frame's.
void widen_by_target(Sample& sample, const Shutter& shutter, std::size_t place) {
  const auto now = shutter.u_target[place][sample.marker], then = shutter.u_target.front()[sample.marker];
  sample.budget.shutter = hypot3(sample.budget.shutter, now, then);
  const auto all = total(sample.budget);
  for (const auto axis : {&BoardExtent::x, &BoardExtent::y}) {
    if (!std::isnan(sample.u.*axis)) sample.u.*axis = all.*axis;
  }
}

// By what targets would have been wrong at most, mm: the frames as read, taken for rows read at once, in the same scene.
double max_correction_mm(const Reference& reference, const Scene& scene, const FrameSeries& read,
                         const Shutter& shutter) {
  const auto shifts = [&](BundleFrame frame) {
    frame.pose = pose_of(reference.site, scene, frame).value_or(frame.pose);
    return fit_frame(reference.site, scene, frame).shift;
  };
  double most = 0.0;
  std::vector<BoardExtent> first, first_rolling;
  for (std::size_t k = 0; k < read.size(); ++k) {
    const auto at_once = shifts(read[k]), rolling = shifts(shutter.frames[k]);
    if (first.empty()) first = at_once, first_rolling = rolling;
    for (std::size_t i = 0; i < at_once.size(); ++i) {
      if (!is_target(reference, i)) continue;
      const auto by = (at_once[i] - first[i]) - (rolling[i] - first_rolling[i]);
      for (const double d : {by.x, by.y}) most = std::fmax(most, std::abs(d));
    }
  }
  return most;
}

// One run's frames, measured in its scene.
class FramesInScene {
 public:
  // by_noise: of compressed footage, its frames without the codec's error
  FramesInScene(const Reference& reference, const PreciseScene& scene, std::optional<FrameSeries> by_noise)
      : reference_(reference),
        site_(reference.site),
        solved_(scene),
        scene_(scene.calibration.bundle.scene),
        by_noise_(std::move(by_noise)) {}

  void measure(const Observations& observations, const std::vector<std::size_t>& place, Solution& solution) const {
    const PreciseBudget budget(site_, scene_.full_covariance,
                               solved_.calibration.fits.front(),  // the reference frame leads the key frames
                               solved_.shutter ? solved_.shutter->u_readout_s : 0.0);
    ByNoise by_noise;
    if (by_noise_) by_noise.then = fit_by_noise(0, solved_.calibration.bundle.frames.front());
    const std::vector<bool> outruns = outruns_continuity(site_, solved_.frames.starts());
    for (std::size_t n = 0; n < observations.size(); ++n) {
      const Observation& seen = observations[n];
      FrameFit now;
      if (place[n] > 0) {
        const BundleFrame frame = placed(solved_.frames[place[n]]);
        now = fit_frame(site_, scene_, frame);
        if (by_noise_) by_noise.now = fit_by_noise(place[n], frame);
      }
      solution.chi2_dof.push_back(now.ok && now.dof > 0 ? now.chi2_sum / static_cast<double>(now.dof) : kNotMeasured);
      for (std::size_t i = 0; i < site_.markers.size(); ++i) {
        if (!is_target(reference_, i)) continue;
        Sample sample = initial_sample(reference_, seen, i);
        if (seen.frame != reference_.seen.frame) {
          sample.status = precise_status(reference_, seen, i, now, solved_.shutter ? kRollingChi2 : kUntrustedChi2);
          const bool unproven = outruns[i] && seen.markers[i].order == Order::kUnproven;
          if (unproven && has_numbers(sample.status)) sample.status = Status::kOrderUnproven;
          if (has_numbers(sample.status)) fill(sample, *site_.markers[i].grating, budget, now, by_noise);
          if (solved_.shutter && has_numbers(sample.status)) widen_by_target(sample, *solved_.shutter, place[n]);
          if ((solved_.doubtful || solved_.camera_contradicted) && sample.status == Status::kOk)
            sample.status = Status::kUntrusted;
        }
        solution.samples.push_back(sample);
      }
    }
  }

 private:
  [[nodiscard]] BundleFrame weighed(const BundleFrame& frame) const {
    return with_print_error(site_, std::span(&frame, 1), solved_.print_error).front();
  }

  // As the solved camera has it: with another focal length the pose starts elsewhere. And a target's rest is measured
  // like any other place.
  [[nodiscard]] BundleFrame placed(const BundleFrame& seen) const {
    BundleFrame frame = weighed(seen);
    frame.pose = pose_of(site_, scene_, frame).value_or(frame.pose);
    frame.at_rest = false;
    return frame;
  }

  // A frame from where another fit of it ended.
  [[nodiscard]] FrameFit fit_by_noise(std::size_t place, const BundleFrame& from) const {
    BundleFrame frame = weighed((*by_noise_)[place]);
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (!from.points[i]) frame.points[i].reset();
      if (frame.points[i]) frame.points[i]->image = from.points[i]->image;  // set back, if the shutter rolls
    }
    frame.pose = from.pose;
    frame.shift = from.shift;
    frame.rows = from.rows;
    frame.motion = from.motion;
    frame.at_rest = from.at_rest;
    return fit_frame(site_, scene_, frame);
  }

  const Reference& reference_;
  const Site& site_;
  const PreciseScene& solved_;
  const Scene& scene_;
  std::optional<FrameSeries> by_noise_;
};

void add_to(std::vector<std::string>& notes, std::optional<std::string> line) {
  if (line) notes.push_back(*std::move(line));
}

void report_shutter(Solution& solution, const Reference& reference, const Shutter& shutter, const FrameSeries& read,
                    bool given) {
  const bool timed = std::isfinite(reference.seen.time_s);
  Scene& scene = *solution.scene;
  scene.readout_s = timed ? shutter.readout_s : kNotTimed;
  scene.u_readout_s = timed ? shutter.u_readout_s : kNotTimed;
  solution.findings.push_back(shutter_note(scene, given, shutter.readout_s / shutter.interval_s,
                                           max_correction_mm(reference, scene, read, shutter), solution.samples));
}

// A run's footage and the scene solved from it.
struct SolvedRun {
  BundleFrames seen;
  FrameSeries read;    // the same frames with the codec's error
  bool lossy = false;  // that there is one
  PreciseScene scene;
};

SolvedRun solved_run(const Reference& reference, const Observations& observations, const SolveOptions& options) {
  SolvedRun run;
  const ScenePrior prior = precise_prior(reference, options);
  const auto codec = std::make_shared<const CodecHistory>(reference, observations);
  run.lossy = codec->is_lossy();
  run.seen = bundle_frames(reference, observations, prior.camera, options,
                           reference.knows_camera() ? kMinForPose : kMinForHomography);
  run.read = with_codec_error(run.seen, codec);
  if (references_in(reference.site, run.read.front()) < kMinForHomography)
    run.scene.problem = "the prints of four references could not be learned from the reference frame";
  else
    run.scene = precise_scene(reference, run.read, prior, options, run.lossy);
  return run;
}

Solution measured_in_scene(const Reference& reference, const Observations& observations, const SolveOptions& options,
                           SolvedRun run) {
  const PreciseScene& scene = run.scene;
  if (!scene.problem.empty()) {
    Solution instead = fallback(reference, observations, options, scene.problem);
    return scene.rolls ? untrusted(std::move(instead), reference) : instead;
  }
  Solution solution;
  solution.scene = scene.calibration.bundle.scene;
  solution.references_verified = scene.references_verified;
  solution.notes = scene.notes;
  solution.remedy = scene.remedy;
  if (!reference.knows_camera())
    add_to(solution.findings, still_camera_note(*solution.scene, scene.calibration.bundle.frames));
  add_to(solution.notes, weak_axis_note(reference));
  add_to(solution.findings, stretched_prints_note(reference.site, scene.calibration));
  for (std::string& line : apparent_size_notes(reference.site, scene.calibration))
    solution.findings.push_back(std::move(line));
  FramesInScene(reference, scene, run.lossy ? std::optional(run.seen.frames) : std::nullopt)
      .measure(observations, run.seen.place, solution);
  if (scene.shutter) report_shutter(solution, reference, *scene.shutter, run.read, options.readout_s.has_value());
  return solution;
}

// Solved without the statement of rest first; with it only where that scene does not contradict it.
Solution measured_with_rest(const Reference& reference, const Observations& observations, const SolveOptions& options) {
  SolveOptions without_rest = options;
  without_rest.rest.reset();
  SolvedRun run = solved_run(reference, observations, without_rest);
  std::optional<MovedAtRest> moved;
  if (run.scene.problem.empty() && !run.scene.doubtful)
    moved = moved_at_rest(reference, observations, run.seen.place, run.scene, *options.rest);
  Solution solution =
      moved ? measured_in_scene(reference, observations, without_rest, std::move(run))
            : measured_in_scene(reference, observations, options, solved_run(reference, observations, options));
  solution.moved_at_rest = moved;
  return solution;
}

}  // namespace

Solution solve_precise(const Reference& reference, const Observations& observations, const SolveOptions& options) {
  Solution solution =
      options.rest ? measured_with_rest(reference, observations, options)
                   : measured_in_scene(reference, observations, options, solved_run(reference, observations, options));
  add_to(solution.notes, fine_pitch_note(reference.site, reference.view));
  return solution;
}

}  // namespace moiregauge::internal
