// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/calibrate.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "moiregauge/calibration/chance.h"
#include "moiregauge/calibration/free_parameters.h"
#include "moiregauge/calibration/print_error.h"
#include "moiregauge/calibration/wander.h"

namespace moiregauge {
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

// Focal lengths beyond these are no camera's that sees a board: the bundle has run away.
bool is_sane(const Scene& scene, int side) {
  return scene.solved && scene.camera.fx > 0.15 * side && scene.camera.fx < 50.0 * side;
}

// What noise does not explain can pull f anywhere, for a prior of 60 % weighs nothing against it. Then f is better held
// until the print's error is known.
constexpr double kBeyondNoise = 2.0;  // chi2 per degree of freedom

long rows_of(std::span<const BundleFrame> frames) {
  long patches = 0;
  for (const BundleFrame& f : frames)
    patches += std::count_if(f.points.begin(), f.points.end(), [](const auto& p) { return p.has_value(); });
  return 2 * kPatchPoints * patches;
}

// Whether prints are rough beyond noise. Their errors are the same in every view and alike in neighbours, so chi2 is no
// likelihood any more: heights then bend to them (nine patches of a photographed board scattered by 10 um instead of
// 2.6), and are solved only where they pay.
enum class Prints { kPerfect, kRough };

// From so many u on a print's scale is no print's: the steps took for it what is a height.
constexpr double kOddScale = 5.0;

// A print that hangs nearer looks larger. From far off the steps may take the one for the other, and end in a valley in
// which scales are many u from what is known of them (a reference 30 mm nearer than the site has it: 48 u, f 35 % off).
// The scene from which another valley is looked for: heights say what such scales did. Nothing where there are none.
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

// Heights and depths cost nothing beyond what their priors ask, which is in the cost: left out where they are true they
// bend the lens, and u, which is stated with them, would be about another scene. Solved from all there is, a scene
// also leaves a valley into which too small a model has led it; of rough prints too, where every parameter has its
// price.
BundleSolution with_shapes(const Bundle& bundle, const Site& site, const ScenePrior& prior, BundleSolution best,
                           double price, Prints prints) {
  const int side = std::max(prior.camera.width, prior.camera.height);
  const auto due = [&](const SceneModel& m) {
    return price * (prints == Prints::kRough ? parameters(site, m) - parameters(site, best.scene.model)
                                             : count(free_common(m)) - count(free_common(best.scene.model)));
  };
  const auto take_if_better = [&](BundleSolution larger) {
    const double gain = best.scene.penalised_cost - larger.scene.penalised_cost;
    if (is_sane(larger.scene, side) && gain > due(larger.scene.model)) best = std::move(larger);
  };
  const auto with_heights = [](SceneModel model) {
    model.heights = model.depth = true;
    return model;
  };
  BundleSolution all = bundle.solve(kEverything, best.scene, best.frames);
  take_if_better(bundle.solve(with_heights(best.scene.model), all.scene, all.frames));
  take_if_better(std::move(all));
  if (const auto start = with_heights_for_scales(prior, best))
    take_if_better(bundle.solve(with_heights(best.scene.model), *start, best.frames));
  return best;
}

// A model whose first step should gain no more than this part of its price is not solved.
constexpr double kLeastPrediction = 0.25;

// The models in ascending order; empty when none can be solved.
std::optional<BundleSolution> ascended(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                                       Prints prints) {
  const Bundle bundle(site, frames, prior);
  BundleSolution best;
  const int side = std::max(prior.camera.width, prior.camera.height);
  const double price = std::log(std::max(3.0, static_cast<double>(rows_of(frames))));
  bool have = false;
  const auto attempt = [&](const SceneModel& model, const BundleSolution* from) {
    const double due = have ? price * (parameters(site, model) - parameters(site, best.scene.model)) : 0.0;
    if (from != nullptr && bundle.predicted_reduction(model, *from) < kLeastPrediction * due) return false;
    BundleSolution solution = from == nullptr ? bundle.solve(model) : bundle.solve(model, from->scene, from->frames);
    if (from != nullptr && !is_sane(solution.scene, side) && solution.scene.chi2_dof > kBeyondNoise)
      solution = bundle.solve(model, from->scene, from->frames, FocalLength::kHeld);
    if (!is_sane(solution.scene, side)) return false;
    if (have && best.scene.penalised_cost - solution.scene.penalised_cost < due) return false;
    best = std::move(solution);
    have = true;
    return true;
  };
  for (const SceneModel& model : kModels) attempt(model, have ? &best : nullptr);
  for (const bool heights : {true, false}) {
    SceneModel model = best.scene.model;
    (heights ? model.heights : model.depth) = true;
    if (have) attempt(model, &best);
  }
  if (!have) return std::nullopt;
  return with_shapes(bundle, site, prior, std::move(best), price, prints);
}

std::vector<FrameFit> fits_of(const Site& site, const BundleSolution& solution) {
  std::vector<FrameFit> fits;
  for (const BundleFrame& frame : solution.frames) fits.push_back(fit_frame(site, solution.scene, frame));
  return fits;
}

// Each estimate is made with weights of the last one; from the second on they hardly change.
constexpr int kErrorRounds = 3;
constexpr double kSameError = 0.01;  // of it: chi2 would change by 2 %, and what is solved by nothing

// What is left when everything is free is the print's, or its place's in that frame: a height or a depth left out must
// not pass for it.
PrintError print_error_of(const Site& site, const BundleSolution& solution, std::span<const BundleFrame> noise_alone,
                          const ScenePrior& prior, const PrintError& last) {
  const BundleSolution largest =
      solve_bundle(site, solution.frames, prior, kEverything, &solution.scene, Until::kChi2Stands);
  if (!largest.scene.solved) return {};
  const auto fits = fits_of(site, largest);
  PrintError error;
  error.wander_mm = wander_mm(site, largest.scene, largest.frames, fits, prior, last.wander_mm);
  const auto wandering = with_print_error(site, noise_alone, {.wander_mm = error.wander_mm});
  error.points_mm = print_error_mm(site, largest.scene, wandering, fits, prior);
  return error;
}

bool is_the_same(const PrintError& a, const PrintError& b) {
  return std::abs(a.points_mm - b.points_mm) <= kSameError * a.points_mm &&
         std::abs(a.wander_mm - b.wander_mm) <= kSameError * a.wander_mm;
}

// Of chi2 beyond its degrees of freedom: six parameters of some eighty take a twelfth of anything.
constexpr double kWorthAsking = 0.25;

// How much of what noise alone does not explain goes when the camera may turn while rows are read. Asked before a print
// error is allowed for: that would take it all. Nothing is asked where noise explains everything.
ShutterTest shutter_test(const Site& site, const BundleSolution& solution, const std::vector<FrameFit>& fits,
                         RowsRun run) {
  ShutterTest out;
  double chi2 = 0.0, gone = 0.0;
  long dof = 0, frames = 0;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (!fits[k].ok) continue;
    chi2 += fits[k].chi2_sum, dof += fits[k].dof;
    ++frames;
  }
  if (dof <= 0 || !(chi2 > 0.0)) return out;
  out.chi2_dof = chi2 / static_cast<double>(dof);
  out.dof = dof;
  const auto excess = chi2 - static_cast<double>(dof);
  if (!(chi2 > most_by_chance(static_cast<double>(dof))) || solution.frames.front().rows) return out;
  for (std::size_t k = 0; k < fits.size(); ++k)
    gone += chi2_of_turning(site, solution.scene, solution.frames[k], fits[k], run);
  out.share = gone / chi2;
  const double turned = gone - static_cast<double>(kTurning * frames);
  out.asks = turned > std::log(std::max(3.0, static_cast<double>(dof))) && turned > kWorthAsking * excess;
  return out;
}

constexpr double kStretchBeyond = 3.0;  // u
constexpr int kWiderPriors = 2;         // the first stretch found was held back by the prior that it breaks

bool is_beyond(double stretch, const ScenePrior& prior) {
  return std::abs(stretch - prior.stretch) > kStretchBeyond * prior.u_stretch;
}

ScenePrior for_stretched(ScenePrior prior, double stretch) {
  const double beyond = std::abs(stretch - prior.stretch);
  prior.u_stretch = std::hypot(prior.u_stretch, beyond);
  for (MarkerShape& u : prior.u_markers) {
    double& scale = u.value[MarkerShape::kScale];
    if (scale > 0.0) scale = std::hypot(scale, 0.5 * beyond);
  }
  return prior;
}

}  // namespace

std::vector<std::size_t> key_frames(std::span<const BundleFrame> frames, std::size_t most) {
  std::set<std::size_t> chosen;
  if (frames.size() <= most) {
    for (std::size_t i = 0; i < frames.size(); ++i) chosen.insert(i);
  } else {
    for (int k = 0; k < 6; ++k) {
      const auto of = [k](const BundleFrame& f) {
        return k < 3 ? f.pose.turn[static_cast<std::size_t>(k)] : f.pose.shift[static_cast<std::size_t>(k - 3)];
      };
      const auto [low, high] = std::minmax_element(
          frames.begin(), frames.end(), [&](const BundleFrame& a, const BundleFrame& b) { return of(a) < of(b); });
      chosen.insert(static_cast<std::size_t>(low - frames.begin()));
      chosen.insert(static_cast<std::size_t>(high - frames.begin()));
    }
    for (std::size_t i = 0; i < most; ++i) chosen.insert(i * (frames.size() - 1) / (most - 1));
  }
  return {chosen.begin(), chosen.end()};
}

Calibration calibrate(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& given) {
  Calibration best;
  ScenePrior& prior = best.prior;
  prior = given;
  auto solution = ascended(site, frames, prior, Prints::kPerfect);
  for (int wider = 0; wider < kWiderPriors && solution && is_beyond(solution->scene.stretch, prior); ++wider) {
    prior = for_stretched(given, solution->scene.stretch);
    solution = ascended(site, frames, prior, Prints::kPerfect);
  }
  if (!solution) {
    best.bundle.scene.solved = false;
    best.bundle.scene.problem = "no lens could be solved from these frames";
    best.bundle.scene.camera = prior.camera;
    best.bundle.scene.markers = prior.markers;
    return best;
  }
  best.fits = fits_of(site, *solution);
  best.shutter = shutter_test(site, *solution, best.fits, prior.rows_run);
  for (int round = 0; round < kErrorRounds; ++round) {
    const PrintError error = print_error_of(site, *solution, frames, prior, best.print_error);
    if (is_the_same(error, best.print_error)) break;
    auto again = ascended(site, with_print_error(site, frames, error), prior,
                          error.points_mm > 0.0 ? Prints::kRough : Prints::kPerfect);
    if (!again) break;
    solution = std::move(again);
    best.print_error = error;
  }
  best.bundle = *std::move(solution);
  if (best.print_error.points_mm > 0.0 || best.print_error.wander_mm > 0.0) best.fits = fits_of(site, best.bundle);
  Scene& scene = best.bundle.scene;
  scene.covariance = scene_covariance(site, best.fits, prior, scene.model);
  const double u_stretch = std::sqrt(scene.covariance(kStretchParameter, kStretchParameter));
  best.stretched =
      is_beyond(scene.stretch, given) && std::abs(scene.stretch - given.stretch) > kStretchBeyond * u_stretch;
  return best;
}

}  // namespace moiregauge
