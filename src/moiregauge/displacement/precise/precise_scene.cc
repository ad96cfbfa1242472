// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_scene.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/calibration/model/persistent_error.h"
#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/bundle_frames.h"
#include "moiregauge/displacement/precise/camera_claim.h"
#include "moiregauge/displacement/precise/height_claim.h"
#include "moiregauge/displacement/precise/precise_prior.h"
#include "moiregauge/displacement/precise/reference_fault.h"
#include "moiregauge/observation/print/overshoot.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxKeyFrames = 120;  // chosen
// Error at the edge of a grating, px per e-fold of distance (standard uncertainty), in light and in grey levels. The
// shape of an edge changes with distance beyond what the fit allows for (blur, contrast, width). Source:
// tools/light-study --noise 0, a wall at 8 m, gratings of 7 pitches of 21 px, point spreads of 0.5 to 1.4 px. Without
// sharpening the error is 0.0001 to 0.005 px. With sharpening by 0.6 to 1.2 the overshoot is 0.06 to 0.15, and the
// error up to 0.011 and 0.016 px.
constexpr double kEdgeOfLight = 0.0025, kEdgeOfGrey = 0.003;
constexpr double kEdgePerOvershoot = 0.07;  // px per unit of overshoot
// Rounds of scene and removal of movements, at most, and the relative change of a scene that ends them. Chosen.
constexpr int kMovementRounds = 6;
constexpr double kSameScene = 2e-3;
// Share of the chi2/dof of a search without a result, below which another one is made. Chosen.
constexpr double kWorthASearch = 0.5;
// Excess of chi2/dof without a moving reference, relative to that with it, which still points to the reference. A rolling
// shutter shows in all references. Chosen.
constexpr double kRestOfExcess = 0.25;
// chi2/dof of the references' places behind a lossy codec, above which the camera vibrates within the readout. Without
// vibration 16 recordings of the second renderer had 0.25 to 0.93, and a phone clip had 1.2. Six of eight with rows
// beyond 5 u had 1.7 to 5.9. Chosen.
constexpr double kVibratesBehindCodec = 1.5;
constexpr double kRollingShare = 0.6;  // least share of chi2 that free rotation during readout removes; chosen

// Returns the indices of the key frames, the reference frame first.
std::vector<std::size_t> key_of(const FrameSeries& frames) {
  std::vector<std::size_t> key{0};
  for (const std::size_t k : key_frames(frames.starts(), kMaxKeyFrames)) {
    if (k > 0) key.push_back(k);
  }
  return key;
}

std::vector<BundleFrame> key_frames_of(const FrameSeries& frames) {
  return frames.without_flawed_targets(key_of(frames));
}

// Returns true if chi2/dof is higher by more than three standard deviations of chi-squared.
bool fits_worse(const ShutterTest& rolling, const ShutterTest& at_once) {
  return rolling.chi2_dof > at_once.chi2_dof + 3.0 * std::sqrt(2.0 / static_cast<double>(std::max(1L, at_once.dof)));
}

bool is_same_scene(const Calibration& a, const Calibration& b) {
  const auto is_same = [](double now, double then) { return std::abs(now - then) <= kSameScene * std::abs(then); };
  return is_same(a.bundle.scene.camera.fx, b.bundle.scene.camera.fx) &&
         is_same(a.bundle.scene.chi2_dof, b.bundle.scene.chi2_dof) &&
         are_alike(a.print_error, b.print_error, kSameScene);
}

class SceneSolver {
 public:
  SceneSolver(const Reference& reference, const FrameSeries& read, const ScenePrior& prior, const SolveOptions& options)
      : reference_(reference), site_(reference.site), read_(read), prior_(prior), options_(options) {
    use(read);
  }

  PreciseScene solved(bool lossy) {
    solve();
    if (is_solved()) remove_movements();
    if (is_solved() && !judged_) leave_out_what_moves();
    if (is_solved() && out_.excluded) test_the_rest(*out_.excluded);
    const ShutterTest& shutter = out_.calibration.shutter;
    out_.rolls = shutter.chi2_dof > kRollingChi2 && shutter.share > kRollingShare;
    if (!is_solved())
      out_.problem = out_.calibration.bundle.scene.problem;
    else if (out_.rolls)
      out_.problem = "no camera path explains the rolling shutter, so no row is trusted";
    out_.print_error = out_.calibration.print_error;
    if (!out_.problem.empty()) return std::move(out_);
    if (out_.shutter && out_.shutter->vibration.is_too_large) report_vibration();
    if (out_.shutter && lossy && !out_.vibrates) test_for_vibration_behind_codec();
    if (reference_.knows_camera() && !out_.doubtful) test_camera();
    if (!out_.doubtful && !out_.camera_contradicted) test_heights(lossy);
    if (!lossy && !out_.shutter) take_noise_for_what_it_is();
    // The stated u has all parameters free within their priors. A parameter that the footage does not require may still
    // be there.
    out_.calibration.bundle.scene.full_covariance = covariance_of_all(out_.calibration);
    if (!options_.rest) allow_for_apparent_size(lossy);
    allow_for_wrong_pitches();
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool is_solved() const { return out_.calibration.bundle.scene.solved; }
  // Takes frames as read, and removes the movements of targets that are known so far.
  void use(const FrameSeries& frames) {
    out_.with_movements = frames;
    out_.frames = only_displaced(frames, out_.movements);
  }
  [[nodiscard]] bool timed() const { return std::isfinite(reference_.seen.time_s); }
  void note(std::string line) { out_.notes.push_back(std::move(line)); }

  // Solves the scene, with a rolling shutter if one is given or justified by the footage. The frames are then corrected
  // to frame time.
  void solve() {
    const auto given = options_.readout_s;
    // The print error takes most of the time, and a scene with a rolling shutter has one of its own. A test that can name
    // a moving reference needs both this print error and full convergence.
    const bool names = names_reference(out_.frames);
    const Until until = names ? Until::kConverged : Until::kConvergedIfItFits;
    Calibration& at_once = out_.calibration =
        calibrate(site_, key_frames_of(out_.frames), prior_, {.until = until, .print_error = false});
    is_complete_ = false;
    if (given == 0.0 || (!given && is_solved() && !at_once.shutter.suggests_rolling_shutter)) return complete();
    if (!given && is_solved()) {
      if (names) {
        complete();
        exclude_explaining_reference();
      }
      if (!at_once.shutter.suggests_rolling_shutter || !is_worth_a_search(at_once.shutter)) return complete();
    }
    if (given && !timed()) note("the rolling shutter is not corrected: the frames have no times. Give --fps");
    const FrameSeries read = out_.with_movements;
    const double at_once_chi2 = is_solved() ? at_once.shutter.chi2_dof : 0.0;
    Shutter shutter = solve_shutter(
        {site_, read, key_of(read), prior_, timed() ? given : std::nullopt, out_.movements, at_once_chi2});
    if (given && !shutter.problem.empty()) note("the rolling shutter is not corrected: " + shutter.problem);
    if (!shutter.problem.empty() || (!given && !is_justified(shutter, at_once))) {
      searched_chi2_dof_ = out_.calibration.shutter.chi2_dof;
      return complete();
    }
    if (given && is_solved() && fits_worse(shutter.calibration.shutter, at_once.shutter))
      note(
          fmt::format("displacements may be wrong: the frames fit worse with a readout time of {:.2f} ms than without. "
                      "Check --readout, or remove it",
                      1e3 * *given));
    out_.frames = shutter.frames;
    out_.with_movements = shutter.with_movements;
    out_.calibration = std::move(shutter.calibration);
    out_.shutter = std::move(shutter);
  }

  // Returns true if the references of these frames can name the one that moves.
  [[nodiscard]] bool names_reference(const FrameSeries& frames) const {
    return can_name_reference(references_in(site_, frames.front()), reference_.knows_camera());
  }

  // Completes the scene of a global shutter by the print error.
  void complete() {
    if (!is_complete_ && is_solved())
      add_print_error(site_, key_frames_of(out_.frames), prior_, Until::kConverged, out_.calibration);
    is_complete_ = true;
  }

  // Returns false if a search without a result must be expected to fail again, because the frames contradict the scene
  // as much as then. A search takes many times as long as a scene.
  [[nodiscard]] bool is_worth_a_search(const ShutterTest& now) const {
    return !searched_chi2_dof_ || now.chi2_dof < kWorthASearch * *searched_chi2_dof_;
  }

  // Solves again without the movements of targets beyond displacement, if any target rotates or leaves its plane.
  void remove_movements() {
    const Scene& scene = out_.calibration.bundle.scene;
    const auto frames = placed_in(scene);
    TargetMovements movements = find_movements(site_, scene, frames);
    exclude_undetermined_heights(movements);
    exclude_heights_by_wrong_statements(movements);
    if (std::ranges::none_of(movements, &TargetMovement::moves)) return;
    const auto centres = rotation_centres(reference_, fit_frame(site_, scene, frames.front()));
    // The first scene is bent by the movements, and so is their removal.
    bool is_same = false;
    for (int rounds = kMovementRounds; rounds > 0 && is_solved() && !is_same; --rounds) {
      const Calibration before = out_.calibration;
      solve_without(movements, centres);
      is_same = is_same_scene(before, out_.calibration);
      if (!is_solved() || !exclude_undetermined_heights(movements)) continue;
      rounds = kMovementRounds;
      is_same = false;
    }
  }

  // Solves from the frames as read, without these movements. There may be none.
  void solve_without(const TargetMovements& movements, const std::vector<RotationCentre>& centres) {
    PreciseScene again;
    if (std::ranges::any_of(movements, &TargetMovement::moves))
      again.movements =
          std::make_shared<const MovementRemoval>(site_, out_.calibration.bundle.scene, movements, centres);
    out_ = std::move(again);
    use(read_);
    judged_ = false;
    solve();
  }

  // Excludes heights if the focal length is unknown, and returns true then. A height appears as a displacement in
  // proportion to the target's distance from the camera's foot on the board, which follows from the focal length.
  bool exclude_undetermined_heights(TargetMovements& movements) const {
    if (std::ranges::none_of(movements, &TargetMovement::leaves_plane)) return false;
    if (knows_focal_length(out_.calibration.bundle.scene, covariance_of_all(out_.calibration))) return false;
    for (TargetMovement& movement : movements) movement.prior(MovementAxis::kHeight) = 0.0;
    return true;
  }

  // Returns the covariance of the scene with all parameters free within their priors.
  [[nodiscard]] Eigen::MatrixXd covariance_of_all(const Calibration& c) const {
    return covariance_with_persistent_errors(site_, c, everything_with(c.bundle.scene.model));
  }

  // Returns the key frames with their poses in this scene. The pose from the prior's camera is too far from the solved
  // camera's for the few steps of a fit.
  [[nodiscard]] std::vector<BundleFrame> placed_in(const Scene& scene) const {
    auto frames = key_frames_of(out_.frames);
    for (BundleFrame& frame : frames) frame.pose = pose_of(site_, scene, frame).value_or(frame.pose);
    return frames;
  }

  // A wrong z_mm or camera also moves targets out of their plane in the scene. Excludes heights that are not shown
  // without these statements.
  void exclude_heights_by_wrong_statements(TargetMovements& movements) const {
    const bool states_heights = std::ranges::any_of(
        site_.markers, [](const Marker& m) { return m.role != Role::kReference && m.z_mm.has_value(); });
    if (std::ranges::none_of(movements, &TargetMovement::leaves_plane)) return;
    if (!states_heights && !reference_.knows_camera()) return;
    ScenePrior open = with_unknown_heights(site_, prior_);
    if (reference_.knows_camera()) open = with_unknown_lens(std::move(open));
    const Scene scene = calibrate(site_, key_frames_of(out_.frames), open).bundle.scene;
    if (!scene.solved) return;
    const TargetMovements shown = find_movements(site_, scene, placed_in(scene));
    for (std::size_t i = 0; i < movements.size(); ++i) {
      if (shown.empty() || !shown[i].leaves_plane()) movements[i].prior(MovementAxis::kHeight) = 0.0;
    }
  }

  // Excludes a reference that moves if this explains what suggests a rolling shutter, or most of it. This test runs first
  // because the rounds of the rolling shutter cost several times as much, and a path can imitate a slip.
  void exclude_explaining_reference() {
    if (judged_) return;
    const ReferenceVerdict verdict = tested();
    if (!verdict.moved) return;
    const std::size_t moved = *verdict.moved;
    auto rest = out_.frames.without_marker(moved);
    Calibration calibration = calibrate(site_, key_frames_of(rest), prior_);
    const ShutterTest &with = out_.calibration.shutter, &without = calibration.shutter;
    if (!calibration.bundle.scene.solved) return;
    if (without.suggests_rolling_shutter && without.chi2_dof - 1.0 > kRestOfExcess * (with.chi2_dof - 1.0)) return;
    judged_ = out_.references_verified = true;
    out_.frames = std::move(rest);
    out_.with_movements = out_.with_movements.without_marker(moved);
    out_.excluded = moved;
    out_.calibration = std::move(calibration);
  }

  // Tests the references and excludes one that moves. The scene is then solved again from the frames as read, because
  // its movement may have suggested a rolling shutter.
  void leave_out_what_moves() {
    const ReferenceVerdict verdict = blaming_camera(tested());
    judged_ = true;
    out_.references_verified = verdict.verified && !verdict.doubtful;
    if (verdict.doubtful) report_doubt(verdict);
    if (!verdict.moved) return;
    use(read_.without_marker(*verdict.moved));
    out_.excluded = verdict.moved;
    out_.shutter.reset();
    solve();
  }

  // Reports the excluded reference. If another one still seems to move, the wrong one may have been excluded.
  void test_the_rest(std::size_t excluded) {
    const ReferenceVerdict verdict = tested();
    if (!verdict.moved && !verdict.doubtful) return report_movement(excluded);
    out_.references_verified = false;
    report_doubt(verdict, fmt::format("reference '{}' moves, and without it another one still seems to",
                                      site_.markers[excluded].name));
  }

  // Only some of the frames were tested, so the step lies between two of them.
  [[nodiscard]] static std::string when_of(const StepPlace& step) {
    return step.settled == step.before + 1 ? fmt::format(" from frame {} on", step.settled)
                                           : fmt::format(" between frames {} and {}", step.before, step.settled);
  }

  // Returns how to measure the parts before and after a step. A part of one frame has no displacement.
  [[nodiscard]] std::string parts_at_rest(const StepPlace& step) const {
    const auto [first, last] = std::ranges::minmax(read_.starts(), {}, &FrameStart::frame);
    std::string out;
    if (step.before > first.frame)
      out = fmt::format("measure the frames before the movement with --frames {}:{}", first.frame, step.before + 1);
    if (step.settled < last.frame)
      out += fmt::format("{} after {} with --frames {}:{}", out.empty() ? "measure the frames" : " and those",
                         out.empty() ? "the movement" : "it", step.settled, last.frame + 1);
    return out;
  }

  // `what`: for the note; nothing if the verdict says all.
  void report_doubt(const ReferenceVerdict& verdict, std::string what = {}) {
    out_.doubtful = true;
    // As read, because one may be excluded.
    const std::string parts = verdict.step ? parts_at_rest(*verdict.step) : "";
    out_.remedy = fmt::format(
        "{}{}{}", parts, parts.empty() ? "" : ", or ",
        names_reference(read_) ? "fasten the references" : "use six references, which show the one that moves");
    if (what.empty())
      what = fmt::format("one of the references moves{}, and the layout does not show which",
                         verdict.step ? when_of(*verdict.step) : "");
    note(fmt::format("no row is trusted: {}. Remedy: {}", what, out_.remedy));
  }

  // The test uses the model that all references together selected. It need not be the final model to find a fault.
  [[nodiscard]] ReferenceVerdict tested() const {
    return test_references(site_, out_.frames, prior_, out_.calibration.bundle.scene, reference_.knows_camera());
  }

  // A wrong camera looks like a moving reference. If no reference moves with an unknown lens, the camera is tested
  // instead.
  ReferenceVerdict blaming_camera(const ReferenceVerdict& verdict) {
    if (!reference_.knows_camera() || !(verdict.moved || verdict.doubtful)) return verdict;
    Scene any_lens = out_.calibration.bundle.scene;
    any_lens.model = everything_with(any_lens.model);
    const ReferenceVerdict of_any_lens =
        test_references(site_, out_.frames, with_unknown_lens(prior_), any_lens, false);
    if (of_any_lens.moved || of_any_lens.doubtful) return verdict;
    test_camera();
    return out_.camera_contradicted ? of_any_lens : verdict;
  }

  void report_movement(std::size_t marker) {
    const Movement went = movement_of(site_, out_.calibration.bundle.scene, read_, marker);
    note(
        fmt::format("reference '{}' is not used, because it moves by up to {:.3f} mm (u {:.4f} mm) against the others. "
                    "Fix it before the next recording",
                    site_.markers[marker].name, went.mm, went.u_mm));
  }

  // Returns the error of a target's depth that follows from the edges of its grating, mm. The depth follows from how the
  // size of the grating changes with distance. The rendering of edges also changes with distance, the same way in all
  // frames.
  [[nodiscard]] double apparent_size_error_mm(std::size_t marker, bool lossy) const {
    const auto& grating = site_.markers[marker].grating;
    if (!grating) return 0.0;
    const double unsharpened_px = reference_.light_per_grey.empty() && !lossy ? kEdgeOfLight : kEdgeOfGrey;
    const double half_px =
        0.5 * std::min(grating->width_mm, grating->height_mm) / reference_.view.mm_per_px(grating->centre);
    const auto& print = reference_.prints[marker];
    const double edge_px = std::hypot(unsharpened_px, print ? kEdgePerOvershoot * overshoot_of(*print) : 0.0);
    return out_.calibration.bundle.frames.front().pose.shift[2] * edge_px / half_px;
  }

  // Adds the error of apparent size to the variance of a target's depth. With rest frames parallax shows the depth, and
  // nothing is added.
  void allow_for_apparent_size(bool lossy) {
    Scene& scene = out_.calibration.bundle.scene;
    for (std::size_t i = 0; i < site_.markers.size(); ++i) {
      const Marker& marker = site_.markers[i];
      if (marker.role != Role::kTarget || !marker.grating) continue;
      const double prior = out_.calibration.prior.u_markers[i].value[MarkerShape::kHeight];
      double& variance = scene.full_covariance(shape_row(i, MarkerShape::kHeight), shape_row(i, MarkerShape::kHeight));
      const double room = std::max(0.0, prior * prior - variance);
      variance += std::min(room, std::pow(apparent_size_error_mm(i, lossy), 2));
    }
  }

  // The warning of a target's apparent size says that its depth or its pitch is wrong. Its u covers both.
  void allow_for_wrong_pitches() {
    out_.size_deviations = size_deviations(site_, out_.calibration);
    for (const SizeDeviation& found : out_.size_deviations) {
      if (site_.markers[found.marker].role != Role::kTarget) continue;
      const int row = shape_row(found.marker, MarkerShape::kHeight);
      out_.calibration.bundle.scene.full_covariance(row, row) += std::pow(depth_u_mm(found), 2);
    }
  }

  void report_vibration() {
    out_.vibrates = true;
    out_.remedy = "fasten or damp the camera, or use one with a shorter readout or a global shutter";
    note(fmt::format(
        "no row is trusted: the camera vibrates within the readout of its rolling shutter, by {:.2g} mm at the "
        "references. Their rows do not show it well enough. Remedy: {}",
        out_.shutter->vibration.displaced_mm, out_.remedy));
  }

  // Behind a codec the stated u covers a vibration within the readout as if it were noise of each grating. It is common to
  // all, so it can be larger at a target.
  void test_for_vibration_behind_codec() {
    // The frames of the solution without its print error, which would hide the vibration.
    BundleSolution as_read{out_.calibration.bundle.scene, {}};
    const auto starts = out_.frames.starts();
    for (const BundleFrame& frame : out_.calibration.bundle.frames) {
      const auto at = std::ranges::find(starts, frame.frame, &FrameStart::frame);
      if (at == starts.end()) return;
      as_read.frames.push_back(out_.frames.without_flawed_targets(static_cast<std::size_t>(at - starts.begin())));
    }
    if (!(chi2_dof_of_places(site_, as_read, out_.calibration.fits) > kVibratesBehindCodec)) return;
    out_.vibrates = true;
    out_.remedy = "fasten or damp the camera, use one with a shorter readout, or record at a higher bit rate";
    note(
        fmt::format("no row is trusted: the camera vibrates within the readout of its rolling shutter, and compression "
                    "hides how much. Remedy: {}",
                    out_.remedy));
  }

  void test_camera() {
    if (out_.camera_contradicted) return;
    const auto found = camera_contradiction(site_, key_frames_of(out_.frames), prior_, out_.calibration);
    if (!found) return;
    out_.camera_contradicted = true;
    out_.remedy = "measure without --camera, or calibrate it again";
    note(camera_contradiction_note(*found) + ". Remedy: " + out_.remedy);
  }

  void test_heights(bool lossy) {
    std::vector<double> u_size_mm;
    for (std::size_t i = 0; i < site_.markers.size(); ++i) u_size_mm.push_back(apparent_size_error_mm(i, lossy));
    const auto found = height_contradiction(site_, key_frames_of(out_.frames), prior_, out_.calibration, u_size_mm);
    if (!found) return;
    out_.height_contradicted = true;
    out_.remedy =
        fmt::format("measure z_mm and pitch_mm of '{}' again, or remove its z_mm", site_.markers[found->marker].name);
    note(height_contradiction_note(site_, *found) + ". Remedy: " + out_.remedy);
  }

  // Reduces the stated noise to the scatter between frames if nothing exceeds noise: no print error, jitter, lossy
  // codec or rolling shutter.
  void take_noise_for_what_it_is() {
    Calibration& calibration = out_.calibration;
    PrintError& error = out_.print_error;
    if (error.exceeds_noise()) return;
    error.noise_share = noise_share(site_, calibration.bundle.scene.model, calibration.fits, calibration.prior);
    if (!(error.noise_share < 1.0)) return;
    const auto frames = with_print_error(site_, calibration.bundle.frames, error);
    for (std::size_t k = 0; k < frames.size(); ++k)
      calibration.fits[k] = fit_frame(site_, calibration.bundle.scene, frames[k]);
  }

  const Reference& reference_;
  const Site& site_;
  const FrameSeries read_;
  const ScenePrior& prior_;
  const SolveOptions& options_;
  bool is_complete_ = false;                 // the scene of a global shutter has its print error
  bool judged_ = false;                      // the references have been tested against each other
  std::optional<double> searched_chi2_dof_;  // before the last search for a rolling shutter, if it had no result
  PreciseScene out_;
};

}  // namespace

PreciseScene precise_scene(const Reference& reference, const FrameSeries& read, const ScenePrior& prior,
                           const SolveOptions& options, bool lossy) {
  return SceneSolver(reference, read, prior, options).solved(lossy);
}

}  // namespace moiregauge::internal
