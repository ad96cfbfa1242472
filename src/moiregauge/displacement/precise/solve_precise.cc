// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/bundle_frames.h"
#include "moiregauge/displacement/layout_advice.h"
#include "moiregauge/displacement/locking_error.h"
#include "moiregauge/displacement/precise/apparent_size.h"
#include "moiregauge/displacement/precise/frames_in_scene.h"
#include "moiregauge/displacement/precise/precise_prior.h"
#include "moiregauge/displacement/precise/precise_scene.h"
#include "moiregauge/displacement/precise/rest_claim.h"
#include "moiregauge/displacement/precise/rolling_shutter_text.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/observation/print/fine_pitch.h"
#include "moiregauge/planning/codec_error.h"

namespace moiregauge::internal {
namespace {

Solution fallback(const Reference& reference, const Observations& observations, const SolveOptions& options,
                  std::string why) {
  Solution solution = solve_two_stage(reference, observations, options);
  solution.scene.emplace();
  solution.scene->problem = std::move(why);
  return solution;
}

// Marks all rows as untrusted: an unexplained rolling shutter is an error that u does not include.
Solution untrusted(Solution solution, const Reference& reference) {
  for (Sample& sample : solution.samples) {
    if (sample.status == Status::kOk && sample.frame != reference.seen.frame) sample.status = Status::kUntrusted;
  }
  return solution;
}

// Returns the largest displacement error that a global shutter model would cause in the same scene, mm.
double max_correction_mm(const Reference& reference, const Scene& scene, const FrameSeries& read,
                         const Shutter& shutter) {
  const auto shifts = [&](BundleFrame frame) {
    frame.pose = pose_of(reference.site, scene, frame).value_or(frame.pose);
    return fit_frame(reference.site, scene, frame, FrameDetail::kSamples).shift;
  };
  double most = 0.0;
  std::vector<BoardExtent> first, first_rolling;
  for (std::size_t k = 0; k < read.size(); ++k) {
    const auto at_once = shifts(read[k]), rolling = shifts(shutter.with_movements[k]);
    if (first.empty()) first = at_once, first_rolling = rolling;
    for (std::size_t i = 0; i < at_once.size(); ++i) {
      if (!is_target(reference, i)) continue;
      const auto by = (at_once[i] - first[i]) - (rolling[i] - first_rolling[i]);
      for (const double d : {by.x, by.y}) most = std::fmax(most, std::abs(d));
    }
  }
  return most;
}

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

// Footage of a run, and the scene solved from it.
struct SolvedRun {
  BundleFrames seen;
  FrameSeries read;    // the same frames with the codec's error
  bool lossy = false;  // the footage has such an error
  std::optional<std::string> locking_note;
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
  // The codec's error depends on the slopes of the grey levels, which follow from the noise. So it comes first.
  const auto locking = std::make_shared<const LockingError>(reference, run.seen.frames);
  run.locking_note = locking->note();
  run.seen.frames = with_locking_error(run.seen.frames, locking);
  run.read = with_locking_error(run.read, locking);
  if (references_in(reference.site, run.read.front()) < kMinForHomography)
    run.scene.problem = "the reference frame does not give templates of four references";
  else
    run.scene = precise_scene(reference, run.read, prior, options, run.lossy);
  run.scene.smear = smear_error(reference.site, run.scene.frames);
  return run;
}

Solution measured_in_scene(const Reference& reference, const Observations& observations, const SolveOptions& options,
                           SolvedRun solved) {
  const auto kept = std::make_shared<const SolvedRun>(std::move(solved));
  const SolvedRun& run = *kept;
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
  add_to(solution.notes, run.locking_note);
  add_to(solution.findings, stretched_prints_note(reference.site, scene.calibration));
  if (scene.movements) {
    for (std::string& line : movement_notes(reference.site, *scene.movements, scene.calibration.bundle))
      solution.findings.push_back(std::move(line));
  }
  for (std::string& line : apparent_size_notes(reference.site, scene.calibration, scene.size_deviations))
    solution.findings.push_back(std::move(line));
  const auto in_scene = [&reference](const SolvedRun& by) {
    return FramesInScene(reference, by.scene,
                         by.lossy ? std::optional(only_displaced(by.seen.frames, by.scene.movements)) : std::nullopt);
  };
  in_scene(run).measure(observations, run.seen.place, solution);
  solution.joint_errors = [kept, in_scene, &observations] {
    return in_scene(*kept).joint_errors(observations, kept->seen.place);
  };
  if (scene.shutter) report_shutter(solution, reference, *scene.shutter, run.read, options.readout_s.has_value());
  return solution;
}

// Solves first without the statement of rest. The statement is used only if that scene does not contradict it.
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
