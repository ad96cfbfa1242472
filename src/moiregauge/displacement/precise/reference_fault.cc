// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/reference_fault.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "moiregauge/calibration/scene/frame_pose.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxFaultFrames = 24;  // key frames of the test; chosen
// Fall of chi2 that shows a step, in units of the variance of unit weight. A step has two unknowns, so noise alone
// exceeds 40 once in 10^8 (exp(-20)) for each position of the step.
constexpr double kSlips = 40.0;
// Lead in chi2 over any other reference that names it: it is then e^10 times as likely.
constexpr double kClearly = 20.0;
// Movement to and fro: mean square of the path relative to noise that shows it. Chosen.
constexpr double kMoves = 20.0;
// Factor over any other reference that names it. Chosen.
constexpr double kClearlyMoves = 3.0;

struct Suspect {
  std::size_t marker = 0;
  double fall = 0.0;  // fall of chi2, in units of the variance of unit weight
  std::optional<StepPlace> step;
};

// Returns the reference with the largest `fall` of chi2 and the fall of the next one. Nothing if the largest is below
// `least`.
std::optional<std::pair<Suspect, double>> suspect(const std::vector<std::pair<std::size_t, ReferenceSlip>>& slips,
                                                  double (*fall)(const ReferenceSlip&), double least) {
  const ReferenceSlip* best = nullptr;
  Suspect first;
  for (const auto& [marker, slip] : slips) {
    if (best != nullptr && !(fall(slip) > fall(*best))) continue;
    best = &slip;
    first.marker = marker;
  }
  if (best == nullptr || !(fall(*best) > least * best->unit())) return std::nullopt;
  double second = 0.0;
  for (const auto& [marker, slip] : slips) {
    if (marker != first.marker) second = std::max(second, fall(slip) / best->unit());
  }
  first.fall = fall(*best) / best->unit();
  return std::pair(first, second);
}

// Returns, among references that step or move otherwise, the one that leaves the least chi2. The number is its lead over
// any other, in units of its own variance. A large movement bends the scene of every other suspect, whose own step may
// then look larger still.
std::optional<std::pair<Suspect, double>> slipped(const std::vector<std::pair<std::size_t, ReferenceSlip>>& slips) {
  const std::pair<std::size_t, ReferenceSlip>* best = nullptr;
  for (const auto& one : slips) {
    const ReferenceSlip& slip = one.second;
    if (!(slip.fall() > kSlips * slip.unit())) continue;
    if (best == nullptr || slip.left() < best->second.left()) best = &one;
  }
  if (best == nullptr) return std::nullopt;
  double second = std::numeric_limits<double>::infinity();
  for (const auto& [marker, slip] : slips) {
    if (marker != best->first) second = std::min(second, slip.left());
  }
  const ReferenceSlip& slip = best->second;
  const auto step = slip.is_step() ? std::optional(slip.step) : std::nullopt;
  return std::pair(Suspect{best->first, slip.fall() / slip.unit(), step}, (second - slip.left()) / slip.unit());
}

BundleSolution solved_with_all(const Site& site, std::vector<BundleFrame> frames, const ScenePrior& prior,
                               const Scene& start) {
  BundleSolution from_prior = solve_bundle(site, frames, prior, start.model);
  for (BundleFrame& frame : frames) frame.pose = pose_of(site, start, frame).value_or(frame.pose);
  BundleSolution from_start = solve_bundle(site, frames, prior, start.model, &start);
  const bool is_better = from_start.scene.solved && (!from_prior.scene.solved ||
                                                     from_start.scene.penalised_cost < from_prior.scene.penalised_cost);
  return is_better ? from_start : from_prior;
}

}  // namespace

ReferenceVerdict test_references(const Site& site, const FrameSeries& frames, const ScenePrior& prior,
                                 const Scene& start, bool camera_known) {
  ReferenceVerdict verdict;
  std::vector<std::size_t> references;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const auto seen =
        std::ranges::count_if(frames.starts(), [i](const FrameStart& one) { return bool{one.has_points[i]}; });
    if (site.markers[i].role == Role::kReference && 2 * seen > static_cast<long>(frames.size()))
      references.push_back(i);
  }
  if (references.size() < 4) return verdict;
  verdict.verified = can_name_reference(references.size(), camera_known);
  // With flawed targets, too: out of focus, all markers are, and references alone then seem to move more often.
  const BundleSolution all =
      solved_with_all(site, frames.at(key_frames(frames.starts(), kMaxFaultFrames)), prior, start);
  std::vector<std::pair<std::size_t, ReferenceSlip>> slips;
  for (const std::size_t r : references) {
    if (const auto slip = fit_reference_step(site, all.frames, prior, all.scene, r)) slips.emplace_back(r, *slip);
  }
  const auto judge = [&](std::size_t marker, bool clear) {
    if (verdict.verified && clear)
      verdict.moved = marker;
    else
      verdict.doubtful = true;
  };
  const auto way = [](const ReferenceSlip& s) { return s.free_fall / static_cast<double>(std::max(1L, s.free_rows)); };
  if (const auto step = slipped(slips)) {
    judge(step->first.marker, step->second > kClearly);
    verdict.step = step->first.step;
  } else if (const auto moved = suspect(slips, way, kMoves))
    judge(moved->first.marker, moved->first.fall > kClearlyMoves * moved->second);
  return verdict;
}

Movement movement_of(Site site, const Scene& scene, const FrameSeries& frames, std::size_t marker) {
  site.markers[marker].role = Role::kTarget;
  std::optional<FrameFit> first;
  Movement most;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    BundleFrame frame = frames[k];
    // The pose from the prior's camera is too far from the solved camera's for the few steps of the fit.
    frame.pose = pose_of(site, scene, frame).value_or(frame.pose);
    FrameFit fit = fit_frame(site, scene, frame, FrameDetail::kSamples);
    if (!fit.ok || fit.shift_row[marker] < 0) continue;
    if (!first) {
      first = std::move(fit);
      continue;
    }
    const auto went = fit.shift[marker] - first->shift[marker];
    const double mm = length(went);
    if (!(mm > most.mm)) continue;
    const Eigen::Vector2d along = Eigen::Vector2d(went.x, went.y) / mm;
    most = {mm, std::sqrt(along.dot((shift_covariance(fit, marker) + shift_covariance(*first, marker)) * along))};
  }
  return most;
}

}  // namespace moiregauge::internal
