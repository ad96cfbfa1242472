// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "moiregauge/calibration/scene/bundle_normal.h"
#include "moiregauge/calibration/scene/frame_steps.h"
#include "moiregauge/calibration/scene/free_parameters.h"

namespace moiregauge::internal {
namespace {

constexpr int kMaxSteps = 40;  // chosen
// Fraction of the cost below which a gain ends the iteration. For 10000 residuals 1e-7 is 1e-3, which moves a parameter
// by 0.03 u. The coarse limit is chosen.
constexpr double kLittle = 1e-7, kLittleOfChi2 = 1e-3;
// Largest chi2/dof at which kConvergedIfItFits uses the finer limit. Beyond it the model is wrong. Its valley can take
// hundreds of steps, and a larger model or the print error gives another scene. Chosen.
constexpr double kFits = 2.0;
// Marquardt damping, relative to the diagonal. It starts at almost zero because poses and shifts come from fits of
// their own. The limits are chosen.
constexpr double kFirstDamping = 1e-12, kMinDamping = 1e-18, kMaxDamping = 1e6;
// Lens, poses and distances form a curved valley. If a step gains less than this fraction of its prediction, every
// frame is first refitted to the new scene. Chosen.
constexpr double kAsPromised = 0.9;
// Factors on the damping after a step that does not lower the cost, and after one that does. Chosen.
constexpr double kMoreDamping = 10.0, kLessDamping = 0.1;

Camera camera_of(const CommonNumbers& b, const Camera& like) {
  Camera c = like;
  c.fx = c.fy = b[0];
  c.cx = b[1], c.cy = b[2], c.k1 = b[3], c.k2 = b[4], c.p1 = b[5], c.p2 = b[6], c.k3 = b[7];
  return c;
}

struct Minimum {
  BundleState state;
  double data = 0.0;   // chi2 with Huber's loss
  double prior = 0.0;  // chi2
  [[nodiscard]] double cost() const { return data + prior; }
};

}  // namespace

struct Bundle::Footage {
  Footage(const Site& s, std::span<const BundleFrame> f, const ScenePrior& p)
      : site(s), frames(f.begin(), f.end()), prior(p) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      for (std::size_t i = 0; i < site.markers.size(); ++i) {
        if (!frames[k].points[i] || !site.markers[i].grating) continue;
        const bool shifts = site.markers[i].role != Role::kReference && !frames[k].at_rest;
        patches.push_back({k, i, shifts, PatchResidual(*frames[k].points[i], site.markers[i])});
        if (frames[k].rows) {
          patches.back().rows = std::make_shared<const BundlePatch::Rows>(BundlePatch::Rows{
              patches.back().residual.root() * frames[k].rows->by_marker[i].leftCols<kMotionParameters>(),
              frames[k].rows->information});
        }
        rows += patches.back().residual.rank() - (shifts ? 2 : 0);
      }
      rows -= 6;
    }
  }

  // Only parameters with a prior, in the model, and of a marker that was read.
  [[nodiscard]] std::vector<SceneParameter> free_parameters(const SceneModel& model, FocalLength f) const {
    std::vector<SceneParameter> out;
    const auto mean = numbers_of(prior.camera, prior.stretch), u_common = uncertainties_of(prior);
    for (std::size_t k = f == FocalLength::kHeld ? 1 : 0; k < kCommonParameters; ++k) {
      if (free_common(model)[k] && u_common[k] > 0.0) out.push_back({static_cast<int>(k), mean[k], u_common[k]});
    }
    for (std::size_t i = 0; i < site.markers.size(); ++i) {
      if (std::none_of(patches.begin(), patches.end(), [i](const BundlePatch& p) { return p.marker == i; })) continue;
      const auto is_free = free_shape(model, site.markers[i].role);
      for (std::size_t k = 0; k < MarkerShape::kParameters; ++k) {
        const double u = prior.u_markers[i].value[k];
        if (is_free[k] && u > 0.0) out.push_back({shape_row(i, static_cast<int>(k)), prior.markers[i].value[k], u});
      }
    }
    return out;
  }

  [[nodiscard]] Minimum valued(BundleState state, std::span<const SceneParameter> free) const {
    Minimum m{std::move(state)};
    std::optional<TurnedPose> pose;
    for (std::size_t p = 0; p < patches.size(); ++p) {
      if (p == 0 || patches[p].frame != patches[p - 1].frame) pose.emplace(m.state.poses[patches[p].frame]);
      m.data += robust(patches[p].chi2(m.state, *pose));
    }
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (frames[k].rows) m.prior += m.state.motions[k].dot(frames[k].rows->information * m.state.motions[k]);
    }
    for (const SceneParameter& p : free) m.prior += std::pow((parameter(m.state, p.index) - p.mean) / p.u, 2);
    return m;
  }

  // Refits every frame to the scene and keeps the result if it is better.
  [[nodiscard]] Minimum settled(Minimum m, std::span<const SceneParameter> free) const {
    auto state = step_of_frames(patches, m.state);
    if (!state) return m;
    Minimum after = valued(*std::move(state), free);
    return after.cost() < m.cost() ? after : m;
  }

  Site site;
  std::vector<BundleFrame> frames;
  ScenePrior prior;
  std::vector<BundlePatch> patches;
  long rows = 0;  // residuals minus the unknowns of the frames
};

namespace {

// Levenberg and Marquardt.
Minimum minimised(const Bundle::Footage& footage, std::span<const SceneParameter> free, BundleState start,
                  Until until) {
  Minimum best = footage.valued(std::move(start), free);
  double damping = kFirstDamping;
  for (int taken = 0; taken < kMaxSteps; ++taken) {
    const BundleNormal normal(footage.patches, free, best.state);
    const bool fits = best.data < kFits * static_cast<double>(footage.rows);
    const bool is_fine = until == Until::kConverged || (until == Until::kConvergedIfItFits && fits);
    const double cost = best.cost(), little = (is_fine ? kLittle : kLittleOfChi2) * cost;
    bool better = false;
    for (; !better && damping < kMaxDamping; damping *= better ? kLessDamping : kMoreDamping) {
      auto step = normal.step(damping);
      if (!step) continue;
      Minimum next = footage.valued(std::move(step->to), free);
      if (step->gain > little && !(cost - next.cost() > kAsPromised * step->gain))
        next = footage.settled(std::move(next), free);
      better = next.cost() < cost;
      if (better) best = std::move(next);
      if (!(step->gain > little)) return best;
    }
    if (!better) break;
    damping = std::max(damping, kMinDamping);
  }
  return best;
}

BundleState begun(const Scene& scene, std::span<const BundleFrame> frames) {
  BundleState start{numbers_of(scene), scene.markers, {}, {}, {}};
  for (const BundleFrame& frame : frames) {
    start.motions.push_back(frame.motion);
    start.poses.push_back(frame.pose);
    start.shifts.push_back(frame.shift);
  }
  return start;
}

}  // namespace

Bundle::Bundle(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior)
    : footage_(std::make_unique<const Footage>(site, frames, prior)) {}
Bundle::~Bundle() = default;

BundleSolution Bundle::solve(const SceneModel& model) const {
  Scene scene;
  scene.camera = footage_->prior.camera;
  scene.stretch = footage_->prior.stretch;
  scene.markers = footage_->prior.markers;
  return solve(model, scene, footage_->frames);
}

BundleSolution Bundle::solve(const SceneModel& model, const Scene& scene, std::span<const BundleFrame> frames,
                             FocalLength f, Until until) const {
  const Footage& footage = *footage_;
  const auto free = footage.free_parameters(model, f);
  const Minimum best = minimised(footage, free, begun(scene, frames), until);
  BundleSolution solution;
  solution.scene.camera = camera_of(best.state.common, footage.prior.camera);
  solution.scene.stretch = best.state.common[kStretchParameter];
  solution.scene.markers = best.state.markers;
  solution.scene.model = model;
  solution.scene.penalised_cost = best.cost();
  solution.scene.solved = std::isfinite(solution.scene.penalised_cost) && best.state.common[0] > 0.0;
  if (!solution.scene.solved) solution.scene.problem = "the bundle adjustment did not converge";
  solution.scene.chi2_dof = footage.rows > 0 ? best.data / static_cast<double>(footage.rows) : 0.0;
  solution.frames = footage.frames;
  for (std::size_t k = 0; k < solution.frames.size(); ++k) {
    solution.frames[k].pose = best.state.poses[k];
    solution.frames[k].shift = best.state.shifts[k];
    solution.frames[k].motion = best.state.motions[k];
    solution.scene.key_frames.push_back(solution.frames[k].frame);
  }
  return solution;
}

double Bundle::predicted_reduction(const SceneModel& model, const BundleSolution& from) const {
  const auto free = footage_->free_parameters(model, FocalLength::kAsModel);
  const auto step = BundleNormal(footage_->patches, free, begun(from.scene, from.frames)).step(kFirstDamping);
  return step ? step->gain : std::numeric_limits<double>::infinity();
}

BundleSolution solve_bundle(const Site& site, std::span<const BundleFrame> frames, const ScenePrior& prior,
                            const SceneModel& model, const Scene* start) {
  const Bundle bundle(site, frames, prior);
  return start != nullptr ? bundle.solve(model, *start, frames) : bundle.solve(model);
}

}  // namespace moiregauge::internal
