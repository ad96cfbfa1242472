// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/scene_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/calibration/scene/free_parameters.h"

namespace moiregauge::internal {
namespace {

constexpr std::array kModels{SceneModel{}, SceneModel{.radial = true}, SceneModel{.radial = true, .tangential = true}};

template <std::size_t kSize>
int count(const std::array<bool, kSize>& is_free) {
  return static_cast<int>(std::count(is_free.begin(), is_free.end(), true));
}

int parameters(const Site& site, const SceneModel& model) {
  int sum = count(free_common(model));
  for (const Marker& m : site.markers) sum += count(free_shape(model, m.role));
  return sum;
}

// Returns false for a focal length that no camera with a view of a board has. The limits 0.15 L and 50 L are chosen.
bool is_sane(const Scene& scene, int side) {
  return scene.solved && scene.camera.fx > 0.15 * side && scene.camera.fx < 50.0 * side;
}

// Residuals beyond noise can move f anywhere, because its prior of 100 % is weak. Then f is held until the print error
// is known. Chosen.
constexpr double kBeyondNoise = 2.0;  // chi2 per degree of freedom

long rows_of(std::span<const BundleFrame> frames) {
  long patches = 0;
  for (const BundleFrame& f : frames)
    patches += std::count_if(f.points.begin(), f.points.end(), [](const auto& p) { return p.has_value(); });
  return 2 * kPatchPoints * patches;
}

// Scales beyond this number of u of their prior are converted to heights. Chosen.
constexpr double kOddScale = 5.0;

// Returns a second start, in which heights replace the scales beyond kOddScale u. Nothing if there are none.
// A nearer grating looks larger, so a first step can confuse height and scale and end in a false minimum. Example: a
// reference 30 mm nearer than stated gave a scale of 48 u and an f wrong by 35 %.
std::optional<Scene> with_heights_for_scales(const ScenePrior& prior, const BundleSolution& best) {
  Scene scene = best.scene;
  bool odd = false;
  const double distance_mm = best.frames.front().pose.shift[2];
  for (std::size_t i = 0; i < scene.markers.size(); ++i) {
    auto& value = scene.markers[i].value;
    const double off = value[MarkerShape::kScale] - prior.markers[i].value[MarkerShape::kScale];
    if (!(std::abs(off) > kOddScale * prior.u_markers[i].value[MarkerShape::kScale])) continue;
    odd = true;
    value[MarkerShape::kScale] -= off;
    value[MarkerShape::kHeight] += off * distance_mm;
  }
  return odd ? std::optional(std::move(scene)) : std::nullopt;
}

// A rotation by a degree hardly separates f, distance and distortion. The steps start at a long f and may end in a
// false minimum, for example at 11 200 px instead of 3478 px. Its cost is higher by 25 to 130, and its displacements
// were wrong by 27 um.
// Focal lengths relative to the image's larger side: above the first, the second is tried as another start. Chosen.
constexpr double kLongFocal = 1.5;
constexpr double kShortFocal = 0.85;  // phones, drones, and 28 mm lenses on a full frame

// Returns the solution with the focal length times `factor`: directions of view are the same, distances in proportion.
BundleSolution at_focal_length(BundleSolution solution, double factor) {
  Camera& camera = solution.scene.camera;
  camera.fx *= factor, camera.fy *= factor;
  camera.k1 *= factor * factor, camera.k2 *= std::pow(factor, 4);
  camera.p1 *= factor, camera.p2 *= factor;
  for (BundleFrame& frame : solution.frames) frame.pose.shift[2] *= factor;
  return solution;
}

bool is_given(const ScenePrior& prior) { return prior.u_camera[0] < kUnknownFocal * prior.camera.fx; }

// Settings of a choice between models. `penalty`: of BIC, per parameter.
struct Choice {
  double penalty;
  Selection selection;
};

// Frees heights and depths, which cost nothing beyond their priors. Excluded where they are true they bend the lens,
// and u would describe another scene.
// A start with all parameters free also leaves a false minimum into which too small a model has led. With rough
// gratings every parameter must satisfy BIC.
BundleSolution with_shapes(const Bundle& bundle, const Site& site, const ScenePrior& prior, BundleSolution best,
                           const Choice& choice) {
  const int side = std::max(prior.camera.width, prior.camera.height);
  const auto due = [&](const SceneModel& m) {
    return choice.penalty * (choice.selection.prints == Prints::kRough
                                 ? parameters(site, m) - parameters(site, best.scene.model)
                                 : count(free_common(m)) - count(free_common(best.scene.model)));
  };
  const auto take_if_better = [&](BundleSolution larger) {
    const double gain = best.scene.penalised_cost - larger.scene.penalised_cost;
    if (is_sane(larger.scene, side) && gain > due(larger.scene.model)) best = std::move(larger);
  };
  const auto solve = [&](const SceneModel& model, const Scene& scene, std::span<const BundleFrame> frames) {
    return bundle.solve(model, scene, frames, FocalLength::kAsModel, choice.selection.until);
  };
  // Outside the model, a given lens stays as given. An unknown one stays as `from` has it: that is nearer to the true lens
  // than the prior, and u is linear there.
  const auto solve_heights = [&](BundleSolution from) {
    SceneModel model = best.scene.model;
    model.heights = model.depth = true;
    if (is_given(prior) && !model.radial) from.scene.camera = best.scene.camera, from.frames = best.frames;
    return solve(model, from.scene, from.frames);
  };
  const SceneModel everything = everything_with(best.scene.model);
  BundleSolution all = solve(everything, best.scene, best.frames);
  take_if_better(solve_heights(all));
  take_if_better(std::move(all));
  if (auto start = with_heights_for_scales(prior, best))
    take_if_better(solve_heights({*std::move(start), best.frames}));
  if (prior.u_camera[0] > 0.0 && best.scene.camera.fx > kLongFocal * side) {
    const BundleSolution start = at_focal_length(best, kShortFocal * side / best.scene.camera.fx);
    // With a full lens model both solutions would be the same.
    if (!(best.scene.model.radial && best.scene.model.tangential)) take_if_better(solve_heights(start));
    take_if_better(solve(everything, start.scene, start.frames));
  }
  return best;
}

// Least share of the excess of chi2 over its degrees of freedom that tilts must explain. Their many parameters otherwise
// follow a rolling shutter or a reference that creeps, and explain a little of it. Chosen.
constexpr double kTiltsExplain = 0.25;

// Returns true if prints are mounted like that: the sum of squares of all tilts, in u of their prior, is one of chance.
// Tilts of 0.1 rad are another fault. A folded target gave its references such tilts towards the middle.
bool are_plausible_tilts(const Site& site, const ScenePrior& prior, const Scene& scene) {
  double squares = 0.0, tilts = 0.0;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    for (const int k : {MarkerShape::kTiltX, MarkerShape::kTiltY}) {
      const auto at = static_cast<std::size_t>(k);
      const double u = prior.u_markers[i].value[at];
      if (!site.markers[i].grating || !(u > 0.0)) continue;
      squares += std::pow((scene.markers[i].value[at] - prior.markers[i].value[at]) / u, 2);
      tilts += 1.0;
    }
  }
  return squares < chi2_upper_quantile(tilts);
}

// A model is not solved if its first step predicts less than this fraction of its BIC penalty. Chosen.
constexpr double kMinPrediction = 0.25;

}  // namespace

std::optional<BundleSolution> select_scene_model(const Site& site, std::span<const BundleFrame> frames,
                                                 const ScenePrior& prior, const Selection& selection) {
  const Bundle bundle(site, frames, prior);
  BundleSolution best;
  const int side = std::max(prior.camera.width, prior.camera.height);
  const double penalty = bic_penalty(rows_of(frames));
  bool have = false;
  const auto attempt = [&](const SceneModel& model, const BundleSolution* from) {
    const double due = have ? penalty * (parameters(site, model) - parameters(site, best.scene.model)) : 0.0;
    if (from != nullptr && bundle.predicted_reduction(model, *from) < kMinPrediction * due) return false;
    const auto solved = [&](FocalLength f) {
      return bundle.solve(model, from->scene, from->frames, f, selection.until);
    };
    BundleSolution solution = from == nullptr ? bundle.solve(model) : solved(FocalLength::kAsModel);
    if (from != nullptr && !is_sane(solution.scene, side) && solution.scene.chi2_dof > kBeyondNoise)
      solution = solved(FocalLength::kHeld);
    if (!is_sane(solution.scene, side)) return false;
    if (have && best.scene.penalised_cost - solution.scene.penalised_cost < due) return false;
    best = std::move(solution);
    have = true;
    return true;
  };
  for (const SceneModel& model : kModels) attempt(model, have ? &best : nullptr);
  for (bool SceneModel::*const more : {&SceneModel::heights, &SceneModel::depth}) {
    SceneModel model = best.scene.model;
    model.*more = true;
    if (have) attempt(model, &best);
  }
  if (!have) return std::nullopt;
  return with_shapes(bundle, site, prior, std::move(best), {penalty, selection});
}

std::optional<BundleSolution> with_tilts(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                                         const Selection& selection, const BundleSolution& without) {
  const Bundle bundle(site, frames, prior);
  const double penalty = bic_penalty(rows_of(frames));
  SceneModel model = without.scene.model;
  model.tilts = true;
  const double due = penalty * (parameters(site, model) - parameters(site, without.scene.model));
  if (bundle.predicted_reduction(model, without) < kMinPrediction * due) return std::nullopt;
  BundleSolution tilted = bundle.solve(model, without.scene, without.frames, FocalLength::kAsModel, selection.until);
  const int side = std::max(prior.camera.width, prior.camera.height);
  const double gain = without.scene.penalised_cost - tilted.scene.penalised_cost;
  if (!is_sane(tilted.scene, side) || gain < due) return std::nullopt;
  if (!(share_of_excess(without.scene, tilted.scene) > kTiltsExplain)) return std::nullopt;
  if (!are_plausible_tilts(site, prior, tilted.scene)) return std::nullopt;
  return with_shapes(bundle, site, prior, std::move(tilted), {penalty, selection});
}

double share_of_excess(const Scene& without, const Scene& with) {
  return (without.chi2_dof - with.chi2_dof) / std::max(1e-12, without.chi2_dof - 1.0);
}

}  // namespace moiregauge::internal
