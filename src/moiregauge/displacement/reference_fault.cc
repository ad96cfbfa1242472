// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/reference_fault.h"

#include <algorithm>
#include <cmath>

namespace moiregauge {
namespace {

constexpr std::size_t kMostFrames = 24;
// F, the fall of chi2 per row of the reference left out against what is left per degree of freedom, is 1 when nothing
// moves, whatever noise and print errors are; from here on something does.
constexpr double kMoves = 20.0;
// To name it the fall must be this many times that of any other: leaving a sound one out also helps a little.
constexpr double kClearly = 3.0;

struct Fit {
  double chi2 = 0.0;
  long dof = 0;
};

Fit fit_of(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior, const SceneModel& model,
           const Scene* start) {
  const BundleSolution solution = solve_bundle(site, frames, prior, model, start);
  Fit fit;
  for (const BundleFrame& frame : solution.frames) {
    const FrameFit f = fit_frame(site, solution.scene, frame);
    if (!f.ok) continue;
    fit.chi2 += f.chi2_sum;
    fit.dof += f.dof;
  }
  return fit;
}

}  // namespace

std::vector<BundleFrame> without(std::span<const BundleFrame> frames, std::size_t marker) {
  std::vector<BundleFrame> out(frames.begin(), frames.end());
  for (BundleFrame& frame : out) frame.points[marker].reset();
  return out;
}

ReferenceVerdict test_references(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                                 const SceneModel& model, bool camera_known) {
  ReferenceVerdict verdict;
  std::vector<std::size_t> references;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const auto seen =
        std::count_if(frames.begin(), frames.end(), [i](const BundleFrame& f) { return f.points[i].has_value(); });
    if (site.markers[i].role == Role::kReference && 2 * seen > static_cast<long>(frames.size()))
      references.push_back(i);
  }
  if (references.size() < 5) return verdict;
  verdict.verified = references.size() >= 6 || camera_known;
  std::vector<BundleFrame> few;
  for (const std::size_t k : key_frames(frames, kMostFrames)) few.push_back(frames[k]);
  const BundleSolution all = solve_bundle(site, few, prior, model);
  const Fit whole = fit_of(site, all.frames, prior, model, &all.scene);
  std::vector<std::pair<double, std::size_t>> falls;  // F, reference
  for (const std::size_t r : references) {
    const Fit rest = fit_of(site, without(all.frames, r), prior, model, &all.scene);
    const auto rows = static_cast<double>(whole.dof - rest.dof);
    if (rest.dof <= 0 || rows <= 0.0) continue;
    falls.emplace_back((whole.chi2 - rest.chi2) / rows / (rest.chi2 / static_cast<double>(rest.dof)), r);
  }
  std::sort(falls.rbegin(), falls.rend());
  if (falls.empty() || falls.front().first < kMoves) return verdict;
  if (verdict.verified && falls.front().first > kClearly * falls[1].first)
    verdict.moved = falls.front().second;
  else
    verdict.doubtful = true;
  return verdict;
}

Movement movement_of(Site site, const Scene& scene, std::span<const BundleFrame> frames, std::size_t marker) {
  site.markers[marker].role = Role::kTarget;
  std::optional<FrameFit> first;
  Movement most;
  const auto covariance = [marker](const FrameFit& fit) -> Eigen::Matrix2d {
    return fit.covariance.block<2, 2>(fit.shift_row[marker], fit.shift_row[marker]);
  };
  for (const BundleFrame& frame : frames) {
    FrameFit fit = fit_frame(site, scene, frame);
    if (!fit.ok || fit.shift_row[marker] < 0) continue;
    if (!first) {
      first = std::move(fit);
      continue;
    }
    const auto went = fit.shift[marker] - first->shift[marker];
    const double mm = length(went);
    if (!(mm > most.mm)) continue;
    const Eigen::Vector2d along = Eigen::Vector2d(went.x, went.y) / mm;
    most = {mm, std::sqrt(along.dot((covariance(fit) + covariance(*first)) * along))};
  }
  return most;
}

}  // namespace moiregauge
