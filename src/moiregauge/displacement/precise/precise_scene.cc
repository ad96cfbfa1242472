// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_scene.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "moiregauge/displacement/precise/camera_claim.h"
#include "moiregauge/displacement/precise/reference_fault.h"
#include "moiregauge/observation/print/overshoot.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxKeyFrames = 120;
// px at the print's edge per e-fold of distance, standard uncertainty: what a change of distance makes of an edge's shape
// beyond what a fit allows for (blur, contrast, width of lines). A wall at 8 m, prints of 7 pitches of 21 px, without
// noise: 0.0001 to 0.005 px for point spreads of 0.5 to 1.4 px. Sharpened by 0.6 to 1.2, where the template exceeds its
// plateaus by 0.06 to 0.15 of their difference: up to 0.011 and 0.016 px (tools/light-study --noise 0).
constexpr double kEdgeOfLight = 0.0025, kEdgeOfGrey = 0.003;
constexpr double kEdgePerOvershoot = 0.07;
constexpr double kRollingShare = 0.6;  // of chi2, that goes when the camera may turn

// The reference frame leads.
std::vector<std::size_t> key_of(const FrameSeries& frames) {
  std::vector<std::size_t> key{0};
  for (const std::size_t k : key_frames(frames.starts(), kMaxKeyFrames)) {
    if (k > 0) key.push_back(k);
  }
  return key;
}

std::vector<BundleFrame> key_frames_of(const FrameSeries& frames) { return frames.at(key_of(frames)); }

// chi2 beyond its own scatter.
bool fits_worse(const ShutterTest& rolling, const ShutterTest& at_once) {
  return rolling.chi2_dof > at_once.chi2_dof + 3.0 * std::sqrt(2.0 / static_cast<double>(std::max(1L, at_once.dof)));
}

class SceneSolver {
 public:
  SceneSolver(const Reference& reference, const FrameSeries& read, const ScenePrior& prior, const SolveOptions& options)
      : reference_(reference), site_(reference.site), read_(read), prior_(prior), options_(options) {
    out_.frames = read;
  }

  PreciseScene solved(bool lossy) {
    solve();
    if (is_solved() && !judged_) leave_out_what_moves();
    const ShutterTest& shutter = out_.calibration.shutter;
    out_.rolls = shutter.chi2_dof > kRollingChi2 && shutter.share > kRollingShare;
    if (!is_solved())
      out_.problem = out_.calibration.bundle.scene.problem;
    else if (out_.rolls)
      out_.problem =
          "the camera turns while the rows of a frame are read (a rolling shutter), no path of the camera explains it, "
          "and no row is trusted";
    out_.print_error = out_.calibration.print_error;
    if (!out_.problem.empty()) return std::move(out_);
    if (reference_.knows_camera() && !out_.doubtful) test_camera();
    if (!lossy && !out_.shutter) take_noise_for_what_it_is();
    // u is stated as if everything were free within its prior, whatever model was chosen: a model that the footage does
    // not demand may yet be true.
    Calibration& calibration = out_.calibration;
    calibration.bundle.scene.full_covariance =
        scene_covariance(site_, calibration.fits, calibration.prior, kEverything);
    if (!options_.rest) allow_for_apparent_size(lossy);
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool is_solved() const { return out_.calibration.bundle.scene.solved; }
  [[nodiscard]] bool timed() const { return std::isfinite(reference_.seen.time_s); }
  void note(std::string line) { out_.notes.push_back(std::move(line)); }

  // With a rolling shutter where one is given, or where the footage asks for it and it pays; then the frames are set
  // back.
  void solve() {
    const auto given = options_.readout_s;
    Calibration& at_once = out_.calibration = calibrate(site_, key_frames_of(out_.frames), prior_);
    if (given == 0.0 || (!given && is_solved() && !at_once.shutter.suggests_rolling_shutter)) return;
    if (!given && is_solved() && is_explained_by_a_reference()) return;
    if (given && !timed()) note("--readout is not used: the frames have no times: give --fps");
    Shutter shutter = solve_shutter(site_, out_.frames, key_of(out_.frames), prior_, timed() ? given : std::nullopt);
    if (given && !shutter.problem.empty()) note("--readout is not used: " + shutter.problem);
    if (!shutter.problem.empty() || (!given && !is_justified(shutter, at_once))) return;
    if (given && is_solved() && fits_worse(shutter.calibration.shutter, at_once.shutter))
      note(
          fmt::format("with rows read over {:.2f} ms the frames fit worse than with all rows at once: check --readout, "
                      "or leave it out",
                      1e3 * *given));
    out_.frames = shutter.frames;
    out_.calibration = std::move(shutter.calibration);
    out_.shutter = std::move(shutter);
  }

  // What asks for a rolling shutter may be a reference that slipped, and is if nothing asks any more once it is left out.
  // That is looked for first: it costs a part of what the shutter's rounds do, and a path can be bent to a slip.
  bool is_explained_by_a_reference() {
    if (judged_) return false;
    at_once_ = tested();
    if (!at_once_->moved) return false;
    auto rest = out_.frames.without_marker(*at_once_->moved);
    Calibration calibration = calibrate(site_, key_frames_of(rest), prior_);
    if (!calibration.bundle.scene.solved || calibration.shutter.suggests_rolling_shutter) return false;
    judged_ = out_.references_verified = true;
    out_.frames = std::move(rest);
    out_.calibration = std::move(calibration);
    report_movement(*at_once_->moved);
    return true;
  }

  // What of a reference's movement passed for a rolling shutter goes with it: the frames are taken as they were read.
  void leave_out_what_moves() {
    const ReferenceVerdict verdict = blaming_camera(at_once_ && !out_.shutter ? *at_once_ : tested());
    judged_ = true;
    out_.references_verified = verdict.verified && !verdict.doubtful;
    if (verdict.doubtful) report_doubt(verdict);
    if (!verdict.moved) return;
    out_.frames = read_.without_marker(*verdict.moved);
    out_.shutter.reset();
    solve();
    if (is_solved()) report_movement(*verdict.moved);
  }

  void report_doubt(const ReferenceVerdict& verdict) {
    out_.doubtful = true;
    const bool slips_later = verdict.since && *verdict.since > reference_.seen.frame;
    out_.remedy = slips_later ? fmt::format("measure the frames before it with --frames {}:{}, or use six references",
                                            reference_.seen.frame, *verdict.since)
                              : "use six references, which name the one that moves";
    note(fmt::format(
        "no row is trusted, because one of the references moves against the others{}, and the layout does not show "
        "which: {}",
        verdict.since ? fmt::format(" (from frame {} on)", *verdict.since) : "", out_.remedy));
  }

  // The test takes the model that all references together chose: to find a fault it need not be the last word.
  [[nodiscard]] ReferenceVerdict tested() const {
    return test_references(site_, out_.frames, prior_, out_.calibration.bundle.scene, reference_.knows_camera());
  }

  // Another lens than the one given looks like a reference that moves, until the lens may be any: then the camera is to
  // blame.
  ReferenceVerdict blaming_camera(const ReferenceVerdict& verdict) {
    if (!reference_.knows_camera() || !(verdict.moved || verdict.doubtful)) return verdict;
    Scene any_lens = out_.calibration.bundle.scene;
    any_lens.model = kEverything;
    const ReferenceVerdict of_any_lens =
        test_references(site_, out_.frames, with_unknown_lens(prior_), any_lens, false);
    if (of_any_lens.moved || of_any_lens.doubtful) return verdict;
    test_camera();
    return out_.camera_contradicted ? of_any_lens : verdict;
  }

  void report_movement(std::size_t marker) {
    const Movement went = movement_of(site_, out_.calibration.bundle.scene, read_, marker);
    note(fmt::format("reference '{}' moves by up to {:.3f} mm (u {:.4f} mm) against the others and is left out",
                     site_.markers[marker].name, went.mm, went.u_mm));
  }

  // A target's depth is read from how its print's size changes with distance. A camera's rendering of an edge changes with
  // distance too, the same way in all frames: no number of them lowers that share. At rest parallax shows the depth.
  void allow_for_apparent_size(bool lossy) {
    Scene& scene = out_.calibration.bundle.scene;
    const bool is_light = reference_.light_per_grey.empty() && !lossy;
    const double unsharpened_px = is_light ? kEdgeOfLight : kEdgeOfGrey;
    const double distance_mm = out_.calibration.bundle.frames.front().pose.shift[2];
    for (std::size_t i = 0; i < site_.markers.size(); ++i) {
      const Marker& marker = site_.markers[i];
      if (marker.role != Role::kTarget || !marker.grating) continue;
      const double half_px = 0.5 * std::min(marker.grating->width_mm, marker.grating->height_mm) /
                             reference_.view.mm_per_px(marker.grating->centre);
      const auto& print = reference_.prints[i];
      const double edge_px = std::hypot(unsharpened_px, print ? kEdgePerOvershoot * overshoot_of(*print) : 0.0);
      const double prior = out_.calibration.prior.u_markers[i].value[MarkerShape::kHeight];
      double& variance = scene.full_covariance(shape_row(i, MarkerShape::kHeight), shape_row(i, MarkerShape::kHeight));
      const double room = std::max(0.0, prior * prior - variance);
      variance += std::min(room, std::pow(distance_mm * edge_px / half_px, 2));
    }
  }

  void test_camera() {
    if (out_.camera_contradicted) return;
    const auto found = camera_contradiction(site_, key_frames_of(out_.frames), prior_, out_.calibration);
    if (!found) return;
    out_.camera_contradicted = true;
    out_.remedy = "measure without --camera, or calibrate it again";
    note(camera_contradiction_note(*found) + ": " + out_.remedy);
  }

  // Where noise is all there is: a codec's error, the camera's motion between rows and rough prints are told apart from
  // it by what scatters beyond it.
  void take_noise_for_what_it_is() {
    Calibration& calibration = out_.calibration;
    PrintError& error = out_.print_error;
    if (error.points_mm > 0.0 || error.marker_jitter_mm > 0.0) return;
    error.noise_share = noise_share(site_, calibration.bundle.scene.model, calibration.fits, calibration.prior);
    if (!(error.noise_share < 1.0)) return;
    const auto frames = with_print_error(site_, calibration.bundle.frames, error);
    for (std::size_t k = 0; k < frames.size(); ++k)
      calibration.fits[k] = fit_frame(site_, calibration.bundle.scene, frames[k]);
  }

  const Reference& reference_;
  const Site& site_;
  const FrameSeries& read_;
  const ScenePrior& prior_;
  const SolveOptions& options_;
  bool judged_ = false;  // the references have been tested against each other, and that is done with
  std::optional<ReferenceVerdict> at_once_;  // on the frames as read
  PreciseScene out_;
};

}  // namespace

PreciseScene precise_scene(const Reference& reference, const FrameSeries& read, const ScenePrior& prior,
                           const SolveOptions& options, bool lossy) {
  return SceneSolver(reference, read, prior, options).solved(lossy);
}

}  // namespace moiregauge::internal
