// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/calibrate.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/calibration/model/marker_jitter.h"
#include "moiregauge/calibration/model/print_error.h"
#include "moiregauge/calibration/model/scene_model.h"
#include "moiregauge/calibration/rolling_shutter/row_motion.h"

namespace moiregauge::internal {
namespace {

std::vector<FrameFit> fits_of(const Site& site, const BundleSolution& solution) {
  std::vector<FrameFit> fits;
  for (const BundleFrame& frame : solution.frames) fits.push_back(fit_frame(site, solution.scene, frame));
  return fits;
}

// Estimates of the print error. Each uses the weights of the previous one, and from the second on they hardly change.
constexpr int kErrorRounds = 3;
constexpr double kSameError = 0.01;  // relative change: chi2 would change by 2 %, the solution by nothing visible

// Estimates print error and marker jitter with all parameters free, so no height or depth counts as print error.
PrintError print_error_of(const Site& site, const BundleSolution& solution, std::span<const BundleFrame> noise_alone,
                          const ScenePrior& prior, const PrintError& last) {
  const BundleSolution largest = Bundle(site, solution.frames, prior)
                                     .solve(everything_with(solution.scene.model), solution.scene, solution.frames,
                                            FocalLength::kAsModel, Until::kChi2Converged);
  if (!largest.scene.solved) return {};
  const auto fits = fits_of(site, largest);
  const double jitter_mm = marker_jitter_mm(site, largest, fits, prior, last.marker_jitter_mm);
  const auto with_jitter = with_print_error(site, noise_alone, {.marker_jitter_mm = jitter_mm});
  PrintError error = print_error(site, largest.scene, with_jitter, fits, prior);
  error.marker_jitter_mm = jitter_mm;
  return error;
}

// Least fraction of the excess of chi2 over dof that the rotation must explain. Six of some eighty degrees of freedom
// explain a twelfth of any excess by chance. Three times that is chosen.
constexpr double kWorthAsking = 0.25;

constexpr double kStretchBeyond = 3.0;  // u of the prior, chosen

bool is_beyond(double stretch, const ScenePrior& prior) {
  return std::abs(stretch - prior.stretch) > kStretchBeyond * prior.u_stretch;
}

// Least mean square that the rotation explains, relative to what it leaves. All but one of 240 random recordings behind
// codecs had less than 4. Chosen.
constexpr double kTurnsClearly = 4.0;

// Sums over frames.
struct Turning {
  double chi2 = 0.0, explained = 0.0;  // explained: by the rotation
  double dof = 0.0, unknowns = 0.0;

  [[nodiscard]] bool is_clear() const {
    return explained * (dof - unknowns) > kTurnsClearly * (chi2 - explained) * unknowns;
  }
};

// Tests for a rolling shutter before the print error is allowed for, because that would absorb the effect. If noise
// explains chi2, nothing is tested, unless the gratings are stretched beyond `given` or a rotation is clear. The stated
// error of a lossy codec covers the shear of a rolling shutter. What is left is a common stretch or a rotation.
ShutterTest shutter_test(const Site& site, const BundleSolution& solution, const std::vector<FrameFit>& fits,
                         const ScenePrior& given) {
  ShutterTest out;
  Turning turning;
  long dof = 0;
  for (const FrameFit& fit : fits) {
    if (!fit.ok) continue;
    turning.chi2 += fit.chi2_sum, dof += fit.dof;
    turning.unknowns += static_cast<double>(kTurning);
  }
  if (dof <= 0 || !(turning.chi2 > 0.0)) return out;
  turning.dof = static_cast<double>(dof);
  out.chi2_dof = turning.chi2 / turning.dof;
  out.dof = dof;
  if (solution.frames.front().rows) return out;
  for (std::size_t k = 0; k < fits.size(); ++k)
    turning.explained += chi2_of_turning(site, solution.scene, solution.frames[k], fits[k], given.rows_run);
  const bool is_beyond_noise = turning.chi2 > chi2_upper_quantile(turning.dof);
  if (!is_beyond_noise && !is_beyond(solution.scene.stretch, given) && !turning.is_clear()) return out;
  const double excess = turning.chi2 - turning.dof, turned = turning.explained - turning.unknowns;
  out.share = turning.explained / turning.chi2;
  out.share_of_excess = turned / excess;
  out.suggests_rolling_shutter = turned > bic_penalty(dof) && turned > kWorthAsking * excess;
  return out;
}

constexpr int kWiderPriors = 2;  // the prior held back the first solved stretch, so solve twice

ScenePrior for_stretched(ScenePrior prior, double stretch) {
  const double beyond = std::abs(stretch - prior.stretch);
  prior.u_stretch = std::hypot(prior.u_stretch, beyond);
  for (MarkerShape& u : prior.u_markers) {
    double& scale = u.value[MarkerShape::kScale];
    if (scale > 0.0) scale = std::hypot(scale, 0.5 * beyond);
  }
  return prior;
}

// A solution, with the prior for which it holds.
struct Solved {
  BundleSolution solution;
  ScenePrior prior;
};

// Returns the solution whose priors contain its stretch. Fails: no model fits with the wider priors.
std::optional<Solved> stretched(const Site& site, std::span<const BundleFrame> frames, const Solved& unstretched,
                                const Selection& selection) {
  Solved solved = unstretched;
  for (int wider = 0; wider < kWiderPriors && is_beyond(solved.solution.scene.stretch, solved.prior); ++wider) {
    solved.prior = for_stretched(unstretched.prior, solved.solution.scene.stretch);
    auto found = select_scene_model(site, frames, solved.prior, selection);
    if (!found) return std::nullopt;
    solved.solution = *std::move(found);
  }
  return solved;
}

// Returns the solution with tilts. Tilted prints can look stretched. So the given prior, which `unstretched` has, comes
// before that of stretched prints.
std::optional<Solved> tilted(const Site& site, std::span<const BundleFrame> frames, const Solved& unstretched,
                             const Solved& solved) {
  if (is_beyond(unstretched.solution.scene.stretch, unstretched.prior)) {
    auto found = with_tilts(site, frames, unstretched.prior, {}, unstretched.solution);
    if (found && !is_beyond(found->scene.stretch, unstretched.prior))
      return Solved{*std::move(found), unstretched.prior};
  }
  auto found = with_tilts(site, frames, solved.prior, {}, solved.solution);
  return found ? std::optional(Solved{*std::move(found), solved.prior}) : std::nullopt;
}

// Solves again with tilts. They are kept if they explain more of the residuals than a suspected rolling shutter does.
void try_tilts(const Site& site, std::span<const BundleFrame> frames, const Solved& unstretched, Solved& solved,
               Calibration& out) {
  auto found = tilted(site, frames, unstretched, solved);
  if (!found) return;
  if (out.shutter.suggests_rolling_shutter &&
      out.shutter.share_of_excess > share_of_excess(solved.solution.scene, found->solution.scene))
    return;
  solved = *std::move(found);
  out.fits = fits_of(site, solved.solution);
  out.shutter = shutter_test(site, solved.solution, out.fits, unstretched.prior);
}

Calibration unsolved(const ScenePrior& prior) {
  Calibration out;
  out.prior = prior;
  out.bundle.scene.solved = false;
  out.bundle.scene.problem = "the footage does not determine a lens";
  out.bundle.scene.camera = prior.camera;
  out.bundle.scene.markers = prior.markers;
  return out;
}

template <typename Frame>
std::vector<std::size_t> chosen_of(std::span<const Frame> frames, std::size_t most) {
  std::set<std::size_t> chosen;
  if (frames.size() <= most) {
    for (std::size_t i = 0; i < frames.size(); ++i) chosen.insert(i);
  } else {
    for (int k = 0; k < 6; ++k) {
      const auto of = [k](const Frame& f) {
        return k < 3 ? f.pose.turn[static_cast<std::size_t>(k)] : f.pose.shift[static_cast<std::size_t>(k - 3)];
      };
      const auto [low, high] = std::minmax_element(frames.begin(), frames.end(),
                                                   [&](const Frame& a, const Frame& b) { return of(a) < of(b); });
      chosen.insert(static_cast<std::size_t>(low - frames.begin()));
      chosen.insert(static_cast<std::size_t>(high - frames.begin()));
    }
    for (std::size_t i = 0; i < most; ++i) chosen.insert(i * (frames.size() - 1) / (most - 1));
  }
  return {chosen.begin(), chosen.end()};
}

}  // namespace

std::vector<std::size_t> key_frames(std::span<const BundleFrame> frames, std::size_t most) {
  return chosen_of(frames, most);
}

std::vector<std::size_t> key_frames(std::span<const FrameStart> frames, std::size_t most) {
  return chosen_of(frames, most);
}

Calibration calibrate(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& given,
                      const CalibrateOptions& options) {
  Calibration out;
  const Selection perfect{Prints::kPerfect, options.until};
  auto found = select_scene_model(site, frames, given, perfect);
  if (!found) return unsolved(given);
  const Solved unstretched{*std::move(found), given};
  auto with_stretch = stretched(site, frames, unstretched, perfect);
  if (!with_stretch) return unsolved(given);
  Solved& solved = *with_stretch;
  out.fits = fits_of(site, solved.solution);
  out.shutter = shutter_test(site, solved.solution, out.fits, given);
  if (options.tilts) try_tilts(site, frames, unstretched, solved, out);
  out.prior = std::move(solved.prior);
  out.bundle = std::move(solved.solution);
  if (options.print_error) add_print_error(site, frames, given, options.until, out);
  return out;
}

void add_print_error(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& given, Until until,
                     Calibration& to) {
  BundleSolution& solution = to.bundle;
  for (int round = 0; round < kErrorRounds; ++round) {
    const PrintError error = print_error_of(site, solution, frames, to.prior, to.print_error);
    if (are_alike(to.print_error, error, kSameError)) break;
    const Selection selection{error.has_rough_prints() ? Prints::kRough : Prints::kPerfect, until};
    const auto weighed = with_print_error(site, frames, error);
    auto again = select_scene_model(site, weighed, to.prior, selection);
    if (!again) break;
    if (solution.scene.model.tilts) {
      if (auto tilted = with_tilts(site, weighed, to.prior, selection, *again)) again = std::move(tilted);
    }
    solution = *std::move(again);
    to.print_error = error;
  }
  if (to.print_error.exceeds_noise()) to.fits = fits_of(site, to.bundle);
  Scene& scene = to.bundle.scene;
  scene.covariance = scene_covariance(site, to.fits, to.prior, scene.model);
  const double u_stretch = std::sqrt(scene.covariance(kStretchParameter, kStretchParameter));
  to.stretched =
      is_beyond(scene.stretch, given) && std::abs(scene.stretch - given.stretch) > kStretchBeyond * u_stretch;
}

}  // namespace moiregauge::internal
