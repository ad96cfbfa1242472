// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/camera_claim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/displacement/precise/precise_budget.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxTestFrames = 40;  // frames of this test; chosen
constexpr double kMatters = 1.0;            // least change of a displacement that matters, in its u
// Factor on the chi-squared quantile. Template errors at edges are the same in all frames, so chi2 falls beyond chance
// for right cameras, too. It fell by up to 34 in 16 runs of a still camera (quantile 26). For wrong cameras that change
// displacements by more than u it fell by 8500 and more.
constexpr double kBeyondTemplates = 10.0;

// One side of the likelihood ratio: all parameters free, with one prior.
struct Side {
  BundleSolution bundle;
  std::vector<FrameFit> fits;
  Eigen::MatrixXd covariance;
};

Side solved_side(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                 std::initializer_list<const Scene*> starts) {
  Side side;
  for (const Scene* start : starts) {
    BundleSolution solution = solve_bundle(site, frames, prior, everything_with(start->model), start);
    if (!solution.scene.solved) continue;
    if (side.bundle.scene.solved && !(solution.scene.penalised_cost < side.bundle.scene.penalised_cost)) continue;
    side.bundle = std::move(solution);
  }
  for (const BundleFrame& frame : side.bundle.frames) side.fits.push_back(fit_frame(site, side.bundle.scene, frame));
  side.covariance = scene_covariance(site, side.fits, prior, side.bundle.scene.model);
  return side;
}

// Returns the largest difference of a target's displacement between both sides, in u of the stated side.
double most_error_u(const Site& site, const Side& stated, const Side& open) {
  if (!stated.fits.front().ok || !open.fits.front().ok) return 0.0;
  const PreciseBudget budget(site, stated.covariance, stated.fits.front());
  double most = 0.0;
  for (std::size_t k = 1; k < stated.fits.size(); ++k) {
    const FrameFit &a = stated.fits[k], &b = open.fits[k];
    if (!a.ok || !b.ok) continue;
    const FrameBudget budgets = budget.of_frame(a);
    for (std::size_t i = 0; i < site.markers.size(); ++i) {
      if (a.shift_row[i] < 0 || stated.fits.front().shift_row[i] < 0) continue;
      const auto moved = a.shift[i] - stated.fits.front().shift[i];
      const auto other = b.shift[i] - open.fits.front().shift[i];
      const auto u = total(budgets.budget(i, moved));
      // An axis that the grating does not show has a very large u, so it never counts here.
      most = std::max({most, std::abs(moved.x - other.x) / u.x, std::abs(moved.y - other.y) / u.y});
    }
  }
  return most;
}

}  // namespace

std::optional<PriorRatio> compare_priors(const Site& site, std::span<const BundleFrame> all, const ScenePrior& stated,
                                         const ScenePrior& wider, const Calibration& solved) {
  std::vector<BundleFrame> frames;
  Side as_solved;
  for (const std::size_t k : key_frames(all, kMaxTestFrames)) {
    frames.push_back(all[k]);
    as_solved.fits.push_back(solved.fits[k]);
  }
  as_solved.covariance = scene_covariance(site, solved.fits, stated, everything_with(solved.bundle.scene.model));
  const Calibration free = calibrate(site, frames, wider);
  if (!free.bundle.scene.solved) return std::nullopt;
  const auto weighed = with_print_error(site, frames, free.print_error);
  Side open = solved_side(site, weighed, wider, {&free.bundle.scene, &solved.bundle.scene});
  const Side closed = solved_side(site, weighed, stated, {&solved.bundle.scene, &free.bundle.scene});
  if (!open.bundle.scene.solved || !closed.bundle.scene.solved) return std::nullopt;
  PriorRatio out;
  out.fall = closed.bundle.scene.penalised_cost - open.bundle.scene.penalised_cost;
  out.unit = std::max(1.0, open.bundle.scene.chi2_dof);
  out.error_u = most_error_u(site, closed, open);
  out.solved_error_u = most_error_u(site, as_solved, open);
  out.open = std::move(open.bundle);
  out.covariance = std::move(open.covariance);
  return out;
}

std::optional<CameraContradiction> camera_contradiction(const Site& site, std::span<const BundleFrame> all,
                                                        const ScenePrior& given, const Calibration& solved) {
  const auto found = compare_priors(site, all, given, with_unknown_lens(given), solved);
  if (!found || !(found->fall > kBeyondTemplates * found->unit * chi2_upper_quantile(kCameraParameters)) ||
      !(found->error_u > kMatters))
    return std::nullopt;
  const auto numbers = [](const Camera& c) {
    return std::array<double, kCameraParameters>{c.fx, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
  };
  const auto shown = numbers(found->open.scene.camera), said = numbers(given.camera);
  CameraContradiction worst;
  double most = 0.0;
  for (int k = 0; k < kCameraParameters; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double u_shown = std::sqrt(found->covariance(k, k));
    const double off = std::abs(shown[at] - said[at]) / std::hypot(given.u_camera[at], u_shown);
    if (!(off > most)) continue;
    most = off;
    worst = {at, said[at], given.u_camera[at], shown[at], u_shown, found->error_u};
  }
  return worst;
}

std::string camera_contradiction_note(const CameraContradiction& found) {
  constexpr std::array kNames{"f", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};
  return fmt::format(
      "no row is trusted: with --camera, displacements would be wrong by up to {5:.1f} u. Its {0} is {1:.4g} (u "
      "{2:.2g}), but the references show {3:.4g} (u {4:.2g})",
      kNames[found.parameter], found.given, found.u_given, found.shown, found.u_shown, found.error_u);
}

}  // namespace moiregauge::internal
