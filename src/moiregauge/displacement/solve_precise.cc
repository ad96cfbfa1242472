// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "moiregauge/calibration/pose.h"
#include "moiregauge/calibration/print_error.h"
#include "moiregauge/calibration/shutter.h"
#include "moiregauge/displacement/bundle_frames.h"
#include "moiregauge/displacement/codec_error.h"
#include "moiregauge/displacement/continuity.h"
#include "moiregauge/displacement/layout_advice.h"
#include "moiregauge/displacement/precise_budget.h"
#include "moiregauge/displacement/reference_fault.h"
#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/displacement/shutter_lines.h"
#include "moiregauge/observation/fine_pitch.h"
#include "moiregauge/observation/patch_of_points.h"

namespace moiregauge {
namespace {

// A frame whose patches lie this many times further from the scene than their noise explains is no longer an
// uncertainty one can state: something moved, or the shutter rolls.
constexpr double kUntrustedChi2 = 25.0;
constexpr std::size_t kMostKeyFrames = 120;
// A rolling shutter: chi2 is far above its degrees of freedom, and most of it goes when the camera may turn while rows
// are read.
constexpr double kRollingChi2 = 4.0;  // per degree of freedom
constexpr double kRollingShare = 0.6;
// An axis that the print does not show has no uncertainty to speak of.
constexpr double kShownWithin = 0.25;  // pitches
constexpr double kRestPlace = 100.0;   // mm: where a target rests is not known beforehand

// A print of which pixels miss its template by more than this part of its contrast, rms, is not all there: a sixteenth
// of it is hidden. Blur by half a pitch, contrast taken out, comes to 0.17.
constexpr double kHiddenContrast = 0.25;

// Is the print whole, sharp and within the sensor's range?
Status quality_of(const Reference& reference, const MarkerObservation& seen, std::size_t i) {
  const PatchReading& then = reference.seen.markers[i].patch;
  const Status sharp = sharpness(then, seen.patch);
  if (sharp != Status::kOk || !seen.points || !reference.seen.markers[i].points) return sharp;
  if (seen.cover != Cover::kNone) return Status::kPartlyCovered;
  const double missing = missing_contrast(*seen.points, *reference.seen.markers[i].points, *reference.prints[i],
                                          rounding_of_step(step_or_usual(seen.quantiser.step)));
  return missing > kHiddenContrast ? Status::kPartlyCovered : Status::kOk;
}

Status status_of(const Reference& reference, const Observation& seen, std::size_t i, const FrameFit& fit,
                 double untrusted_chi2) {
  if (seen.decode_error) return Status::kDecodeError;
  if (!seen.references_seen || !fit.ok)
    return seen.references_seen && order_in_doubt(reference, seen) ? Status::kOrderUnproven : Status::kReferenceLost;
  if (seen.markers[i].loss != Loss::kNone) return status_of_loss(seen.markers[i].loss);
  if (seen.markers[i].order == Order::kContradicted) return Status::kOrderUnproven;
  if (fit.shift_row[i] < 0) return Status::kLost;
  if (fit.chi2_sum > untrusted_chi2 * static_cast<double>(fit.dof)) return Status::kUntrusted;
  return quality_of(reference, seen.markers[i], i);
}

Solution fallback(const Reference& reference, const std::vector<Observation>& observations, const SolveOptions& options,
                  std::string why) {
  Solution solution = solve_two_stage(reference, observations, options);
  solution.scene.emplace();
  solution.scene->problem = std::move(why);
  return solution;
}

// The reference frame leads.
std::vector<std::size_t> key_of(const std::vector<BundleFrame>& frames) {
  std::vector<std::size_t> key{0};
  for (const std::size_t k : key_frames(frames, kMostKeyFrames)) {
    if (k > 0) key.push_back(k);
  }
  return key;
}

std::vector<BundleFrame> key_frames_of(const std::vector<BundleFrame>& frames) {
  std::vector<BundleFrame> key;
  for (const std::size_t k : key_of(frames)) key.push_back(frames[k]);
  return key;
}

// Rows read one after the other, and taken for rows read at once: an error that u knows nothing of.
Solution untrusted(Solution solution, const Reference& reference) {
  for (Sample& sample : solution.samples) {
    if (sample.status == Status::kOk && sample.frame != reference.seen.frame) sample.status = Status::kUntrusted;
  }
  return solution;
}

bool shutter_rolls(const ShutterTest& shutter) {
  return shutter.chi2_dof > kRollingChi2 && shutter.share > kRollingShare;
}

// chi2 beyond its own scatter.
bool fits_worse(const ShutterTest& rolling, const ShutterTest& at_once) {
  return rolling.chi2_dof > at_once.chi2_dof + 3.0 * std::sqrt(2.0 / static_cast<double>(std::max(1L, at_once.dof)));
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

// A template learned from one picture reads the scale of its print no better than this at the print's edge: what it
// cannot hold, harmonics beyond the pixels', is odd about every printed edge and passes for a little scale. Noise-free
// pictures show 0.0004 px at pitches of 29 px, 0.0025 px at 14 px; it is the same in all frames, so the bundle cannot
// see it.
constexpr double kTemplateEdgePx = 0.003;
// It is learned through the lens as it is known then. Of one that is not, a print's own bend leaks into its scale, for
// its window is not of whole pitches (-2 % at the small rig's corner: 0.004 px; -3 % at the rig's: 0.002 px). Only
// references are so far outside; a target's scale also multiplies its displacement, which knows nothing of how its
// template was learned.
constexpr double kUnknownLensEdgePx = 0.005;

// One run's way from observations to samples.
class Precise {
 public:
  Precise(const Reference& reference, const std::vector<Observation>& observations, const SolveOptions& options)
      : reference_(reference), observations_(observations), options_(options), codec_(reference, observations) {
    lens_given_ = reference.knows_camera();
    prior_ = scene_prior(reference.site, reference.width, reference.height,
                         lens_given_ ? std::optional(reference.lens) : std::nullopt);
    for (std::size_t k = 0; lens_given_ && options.u_camera && k < prior_.u_camera.size(); ++k) {
      if (std::isfinite((*options.u_camera)[k])) prior_.u_camera[k] = (*options.u_camera)[k];
    }
    widen_scales();
    prior_.rows_run = rows_run(options.rotation_deg);
    if (options.rest) {
      for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
        if (is_target(reference, i))
          prior_.u_markers[i].value[MarkerShape::kX] = prior_.u_markers[i].value[MarkerShape::kY] = kRestPlace;
      }
    }
  }

  Solution solve() {
    BundleFrames seen = bundle_frames(reference_, observations_, prior_.camera, options_,
                                      lens_given_ ? kLeastForPose : kLeastForHomography);
    std::vector<BundleFrame> frames = with_codec_error(seen, codec_);
    const std::vector<std::size_t>& place = seen.place;
    if (codec_.is_lossy()) by_noise_ = std::move(seen.frames);
    if (references_in(reference_.site, frames.front()) < kLeastForHomography)
      return fallback(reference_, observations_, options_,
                      "the prints of four references could not be learned from the reference frame");
    const std::vector<BundleFrame> read = frames;
    Calibration calibration = solve_scene(frames);
    if (calibration.bundle.scene.solved && !judged_) leave_out_what_moves(read, frames, calibration);
    if (!calibration.bundle.scene.solved)
      return fallback(reference_, observations_, options_, calibration.bundle.scene.problem);
    if (shutter_rolls(calibration.shutter))
      return untrusted(fallback(reference_, observations_, options_,
                                "the camera turns while the rows of a frame are read (a rolling shutter), no path of "
                                "the camera explains it, and no row is trusted"),
                       reference_);
    solution_.scene = calibration.bundle.scene;
    print_error_ = calibration.print_error;
    take_noise_for_what_it_is(calibration);
    if (shutter_) count_taken_out(read);
    measure(frames, place, calibration);
    if (shutter_) tell_shutter();
    return std::move(solution_);
  }

 private:
  // With a rolling shutter where one is given, or where the footage asks for it and it pays; then the frames are set
  // back.
  Calibration solve_scene(std::vector<BundleFrame>& frames) {
    const auto key = key_of(frames);
    Calibration at_once = calibrate(reference_.site, key_frames_of(frames), prior_);
    const auto given = options_.readout_s;
    if (given == 0.0 || (!given && at_once.bundle.scene.solved && !at_once.shutter.asks)) return at_once;
    if (!given && at_once.bundle.scene.solved) {
      if (auto rest = explained_by_a_reference(frames, at_once)) return *std::move(rest);
    }
    if (given && !timed()) solution_.notes.emplace_back("--readout is not used: the frames have no times: give --fps");
    Shutter shutter = solve_shutter(reference_.site, frames, key, prior_, timed() ? given : std::nullopt);
    if (given && !shutter.problem.empty()) solution_.notes.push_back("--readout is not used: " + shutter.problem);
    if (!shutter.problem.empty() || (!given && !pays(shutter, at_once))) return at_once;
    if (given && at_once.bundle.scene.solved && fits_worse(shutter.calibration.shutter, at_once.shutter))
      solution_.notes.push_back(
          fmt::format("with rows read over {:.2f} ms the frames fit worse than with all rows at once: check --readout, "
                      "or leave it out",
                      1e3 * *given));
    frames = shutter.frames;
    Calibration calibration = std::move(shutter.calibration);
    shutter_ = std::move(shutter);
    return calibration;
  }

  // What asks for a rolling shutter may be a reference that slipped, and is if nothing asks any more once it is left out.
  // That is looked for first: it costs a part of what the shutter's rounds do, and a path can be bent to a slip.
  std::optional<Calibration> explained_by_a_reference(std::vector<BundleFrame>& frames, const Calibration& at_once) {
    if (judged_) return std::nullopt;
    const Site& site = reference_.site;
    const auto verdict = test_references(site, frames, prior_, at_once.bundle.scene.model, lens_given_);
    if (!verdict.moved) return std::nullopt;
    auto rest = without(frames, *verdict.moved);
    Calibration calibration = calibrate(site, key_frames_of(rest), prior_);
    if (!calibration.bundle.scene.solved || calibration.shutter.asks) return std::nullopt;
    tell_movement(calibration.bundle.scene, frames, *verdict.moved);
    judged_ = solution_.references_verified = true;
    frames = std::move(rest);
    return calibration;
  }

  // Where noise is all there is: a codec's error, the camera's motion between rows and rough prints are told apart from
  // it by what scatters beyond it.
  void take_noise_for_what_it_is(Calibration& calibration) {
    if (codec_.is_lossy() || shutter_ || print_error_.points_mm > 0.0 || print_error_.wander_mm > 0.0) return;
    const Site& site = reference_.site;
    print_error_.noise_share = noise_share(site, calibration.bundle.scene.model, calibration.fits, calibration.prior);
    if (!(print_error_.noise_share < 1.0)) return;
    const auto frames = with_print_error(site, calibration.bundle.frames, print_error_);
    for (std::size_t k = 0; k < frames.size(); ++k)
      calibration.fits[k] = fit_frame(site, calibration.bundle.scene, frames[k]);
  }

  void tell_shutter() {
    solution_.scene->readout_s = timed() ? shutter_->readout_s : kNotTimed;
    solution_.scene->u_readout_s = timed() ? shutter_->u_readout_s : kNotTimed;
    solution_.notes.push_back(shutter_note(*solution_.scene, options_.readout_s.has_value(),
                                           shutter_->readout_s / shutter_->interval_s, taken_out_mm_,
                                           solution_.samples));
  }
  [[nodiscard]] bool timed() const { return std::isfinite(reference_.seen.time_s); }

  // What templates add to the u of their prints' scales.
  void widen_scales() {
    for (std::size_t i = 0; i < reference_.site.markers.size(); ++i) {
      const auto& grating = reference_.site.markers[i].grating;
      if (!grating) continue;
      const double edge_px = lens_given_ || is_target(reference_, i) ? kTemplateEdgePx : kUnknownLensEdgePx;
      const double half_px =
          0.5 * std::min(grating->width_mm, grating->height_mm) / reference_.view.mm_per_px(grating->centre);
      double& u = prior_.u_markers[i].value[MarkerShape::kScale];
      if (u > 0.0) u = std::hypot(u, edge_px / half_px);
    }
  }

  // The test takes the model that all references together chose: to find a fault it need not be the last word.
  // What of a reference's movement passed for a rolling shutter goes with it: the frames are taken as they were read.
  void leave_out_what_moves(const std::vector<BundleFrame>& read, std::vector<BundleFrame>& frames,
                            Calibration& calibration) {
    const auto verdict = test_references(reference_.site, frames, prior_, calibration.bundle.scene.model, lens_given_);
    judged_ = true;
    solution_.references_verified = verdict.verified && !verdict.doubtful;
    if (verdict.doubtful) {
      doubtful_ = true;
      solution_.notes.push_back(fmt::format(
          "one of the references moves against the others{}, and the layout does not show which: no row is trusted: "
          "{}six references name it",
          verdict.since ? fmt::format(" (from frame {} on)", *verdict.since) : "",
          verdict.since && *verdict.since > reference_.seen.frame ? "measure the frames before by themselves; " : ""));
    }
    if (!verdict.moved) return;
    frames = without(read, *verdict.moved);
    shutter_.reset();
    calibration = solve_scene(frames);
    if (calibration.bundle.scene.solved) tell_movement(calibration.bundle.scene, read, *verdict.moved);
  }

  void tell_movement(const Scene& scene, const std::vector<BundleFrame>& read, std::size_t marker) {
    const Movement went = movement_of(reference_.site, scene, read, marker);
    solution_.notes.push_back(
        fmt::format("reference '{}' moves by up to {:.3f} mm (u {:.4f} mm) against the others and is left out",
                    reference_.site.markers[marker].name, went.mm, went.u_mm));
  }

  void measure(const std::vector<BundleFrame>& frames, const std::vector<std::size_t>& place,
               const Calibration& calibration) {
    const Site& site = reference_.site;
    // u is stated as if everything were free within its prior, whatever model was chosen: a model that the footage does
    // not demand may yet be true.
    solution_.scene->full_covariance = scene_covariance(site, calibration.fits, calibration.prior, kEverything);
    if (!lens_given_) note(still_camera_note(*solution_.scene, calibration.bundle.frames));
    note(weak_axis_note(reference_));
    note(stretched_prints_note(site, calibration));
    const PreciseBudget budget(site, solution_.scene->full_covariance,
                               calibration.fits.front(),  // the reference frame leads the key frames
                               shutter_ ? shutter_->u_readout_s : 0.0);
    ByNoise by_noise;
    if (codec_.is_lossy()) by_noise.then = fit_by_noise(0, calibration.bundle.frames.front());
    const std::vector<bool> outruns = outruns_continuity(site, frames);
    for (std::size_t n = 0; n < observations_.size(); ++n) {
      const Observation& seen = observations_[n];
      FrameFit now;
      if (place[n] > 0) {
        BundleFrame frame = with_print_error(site, std::span(&frames[place[n]], 1), print_error_).front();
        // As the solved camera has it: with another focal length the pose starts elsewhere. And a target's rest is
        // measured like any other place.
        frame.pose = pose_of(site, *solution_.scene, frame).value_or(frame.pose);
        frame.at_rest = false;
        now = fit_frame(site, *solution_.scene, frame);
        if (codec_.is_lossy()) by_noise.now = fit_by_noise(place[n], frame);
      }
      solution_.chi2_dof.push_back(now.ok && now.dof > 0 ? now.chi2_sum / static_cast<double>(now.dof) : kNotMeasured);
      for (std::size_t i = 0; i < site.markers.size(); ++i) {
        if (!is_target(reference_, i)) continue;
        Sample sample = begun_sample(reference_, seen, i);
        if (seen.frame != reference_.seen.frame) {
          sample.status = status_of(reference_, seen, i, now, shutter_ ? kRollingChi2 : kUntrustedChi2);
          const bool unproven = outruns[i] && seen.markers[i].order == Order::kUnproven;
          if (unproven && has_numbers(sample.status)) sample.status = Status::kOrderUnproven;
          if (has_numbers(sample.status)) fill(sample, *site.markers[i].grating, budget, now, by_noise);
          if (shutter_ && has_numbers(sample.status)) widen_by_target(sample, place[n]);
          if (doubtful_ && sample.status == Status::kOk) sample.status = Status::kUntrusted;
        }
        solution_.samples.push_back(sample);
      }
    }
  }

  // A frame from where another fit of it ended.
  FrameFit fit_by_noise(std::size_t place, const BundleFrame& from) const {
    BundleFrame frame = with_print_error(reference_.site, std::span(&by_noise_[place], 1), print_error_).front();
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (!from.points[i]) frame.points[i].reset();
      if (frame.points[i]) frame.points[i]->image = from.points[i]->image;  // set back, if the shutter rolls
    }
    frame.pose = from.pose;
    frame.shift = from.shift;
    frame.rows = from.rows;
    frame.motion = from.motion;
    frame.at_rest = from.at_rest;
    return fit_frame(reference_.site, *solution_.scene, frame);
  }

  // By what its own motion leaves open between its rows' time and its frame's.
  void widen_by_target(Sample& sample, std::size_t place) const {
    const auto now = shutter_->u_target[place][sample.marker], then = shutter_->u_target.front()[sample.marker];
    sample.budget.shutter = hypot3(sample.budget.shutter, now, then);
    const auto all = total(sample.budget);
    for (const auto axis : {&BoardExtent::x, &BoardExtent::y}) {
      if (!std::isnan(sample.u.*axis)) sample.u.*axis = all.*axis;
    }
  }

  // The same frames taken for rows read at once, in the same scene.
  void count_taken_out(const std::vector<BundleFrame>& read) {
    const auto shifts = [&](BundleFrame frame) {
      frame.pose = pose_of(reference_.site, *solution_.scene, frame).value_or(frame.pose);
      return fit_frame(reference_.site, *solution_.scene, frame).shift;
    };
    std::vector<BoardExtent> first, first_rolling;
    for (std::size_t k = 0; k < read.size(); ++k) {
      const auto at_once = shifts(read[k]), rolling = shifts(shutter_->frames[k]);
      if (first.empty()) first = at_once, first_rolling = rolling;
      for (std::size_t i = 0; i < at_once.size(); ++i) {
        if (!is_target(reference_, i)) continue;
        const auto by = (at_once[i] - first[i]) - (rolling[i] - first_rolling[i]);
        for (const double d : {by.x, by.y}) taken_out_mm_ = std::fmax(taken_out_mm_, std::abs(d));
      }
    }
  }

  void note(std::optional<std::string> line) {
    if (line) solution_.notes.push_back(*std::move(line));
  }

  const Reference& reference_;
  const std::vector<Observation>& observations_;
  const SolveOptions& options_;
  ScenePrior prior_;
  bool lens_given_ = false;
  bool judged_ = false;  // the references have been tested against each other
  bool doubtful_ = false;
  PrintError print_error_;
  CodecHistory codec_;
  std::vector<BundleFrame> by_noise_;  // of compressed footage: its frames without the codec's error
  std::optional<Shutter> shutter_;     // that rolls
  double taken_out_mm_ = 0.0;
  Solution solution_;
};

}  // namespace

Solution solve_precise(const Reference& reference, const std::vector<Observation>& observations,
                       const SolveOptions& options) {
  Solution solution = Precise(reference, observations, options).solve();
  if (auto note = fine_pitch_note(reference.site, reference.view)) solution.notes.push_back(*std::move(note));
  return solution;
}

}  // namespace moiregauge
