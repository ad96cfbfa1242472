// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "moiregauge/calibration/calibrate.h"
#include "moiregauge/calibration/pose.h"
#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge {
namespace {

// A frame whose patches lie this many times further from the scene than their noise explains is no longer an
// uncertainty one can state: something moved, or the shutter rolls.
constexpr double kUntrustedChi2 = 25.0;
constexpr std::size_t kMostKeyFrames = 120;
constexpr int kLeastReferences = 4;

BundleFrame bundle_frame(const Reference& reference, const Observation& seen, const Camera& camera,
                         const std::vector<BoardExtent>& travel) {
  BundleFrame frame;
  frame.frame = seen.frame;
  frame.pose = pose_of(seen.stage2, camera);
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    const bool usable = seen.markers[i].loss == Loss::kNone && seen.markers[i].points.has_value();
    frame.points.push_back(usable ? seen.markers[i].points : std::nullopt);
    const bool moved = is_target(reference, i) && !std::isnan(travel[i].x) && !std::isnan(travel[i].y);
    frame.shift.push_back(moved ? travel[i] : BoardExtent{});
  }
  return frame;
}

int references_in(const Reference& reference, const BundleFrame& frame) {
  int count = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i)
    count += frame.points[i].has_value() && reference.site.markers[i].role == Role::kReference;
  return count;
}

// What the displacement of one target owes to what: rows of the frame's fit and of the reference frame's.
class Uncertainty {
 public:
  Uncertainty(const Eigen::MatrixXd& scene, const FrameFit& then) : scene_(scene), then_(then) {}

  [[nodiscard]] Budget budget(const FrameFit& now, std::size_t marker) const {
    Budget b;
    for (const int axis : {0, 1}) {
      const auto member = [axis](BoardExtent& e) -> double& { return axis == 0 ? e.x : e.y; };
      const int row = now.shift_row[marker] + axis, before = then_.shift_row[marker] + axis;
      const double inflated = std::max(1.0, now.chi2_sum / static_cast<double>(now.dof));
      const double inflated_then = std::max(1.0, then_.chi2_sum / static_cast<double>(then_.dof));
      const double all = inflated * now.covariance(row, row);
      const double own = std::min(all, inflated * now.own_information[marker].inverse()(axis, axis));
      member(b.noise) = std::sqrt(own);
      member(b.references) = std::sqrt(all - own);
      member(b.reference_frame) = std::sqrt(inflated_then * then_.covariance(before, before));
      share_scene(now.sensitivity.row(row) - then_.sensitivity.row(before), member(b.lens), member(b.geometry),
                  member(b.print_scale));
    }
    return b;
  }

 private:
  // The scene's share, told apart by lens, markers and print scales. These depend on one another; what each would give
  // alone is scaled so that together they are the whole.
  void share_scene(const Eigen::RowVectorXd& k, double& lens, double& geometry, double& scale) const {
    const double whole = std::max(0.0, (k * scene_ * k.transpose())(0));
    Eigen::RowVectorXd of_lens = Eigen::RowVectorXd::Zero(k.size()), of_scale = of_lens, of_place = of_lens;
    for (Eigen::Index i = 0; i < k.size(); ++i) {
      const bool is_lens = i < kCameraParameters;
      const bool is_scale = !is_lens && (i - kCameraParameters) % MarkerShape::kParameters == MarkerShape::kScale;
      (is_lens ? of_lens : is_scale ? of_scale : of_place)(i) = k(i);
    }
    const auto alone = [&](const Eigen::RowVectorXd& part) {
      return std::max(0.0, (part * scene_ * part.transpose())(0));
    };
    const double a = alone(of_lens), b = alone(of_place), c = alone(of_scale), sum = a + b + c;
    const double f = sum > 0.0 ? whole / sum : 0.0;
    lens = std::sqrt(f * a);
    geometry = std::sqrt(f * b);
    scale = std::sqrt(f * c);
  }

  const Eigen::MatrixXd& scene_;
  const FrameFit& then_;
};

BoardExtent total(const Budget& budget) {
  double x = 0.0, y = 0.0;
  for (const BudgetPart& part : kBudgetParts) {
    x += (budget.*part.value).x * (budget.*part.value).x;
    y += (budget.*part.value).y * (budget.*part.value).y;
  }
  return {std::sqrt(x), std::sqrt(y)};
}

// u is stated as if everything were free within its prior, whatever model was chosen: a model that the footage does not
// demand may yet be true.
constexpr SceneModel kEverything{.radial = true, .tangential = true, .heights = true, .depth = true};

Status status_of(const Reference& reference, const Observation& seen, bool doubtful, std::size_t i,
                 const FrameFit& fit) {
  if (seen.decode_error) return Status::kDecodeError;
  if (!seen.references_seen || !fit.ok) return Status::kReferenceLost;
  if (seen.markers[i].loss != Loss::kNone) return status_of_loss(seen.markers[i].loss);
  if (doubtful || seen.markers[i].order == Order::kContradicted) return Status::kOrderUnproven;
  if (fit.shift_row[i] < 0) return Status::kLost;
  if (fit.chi2_sum > kUntrustedChi2 * static_cast<double>(fit.dof)) return Status::kUntrusted;
  return quality(reference.plans[i], reference.seen.markers[i].patch, seen.markers[i].patch);
}

Solution fallback(const Reference& reference, const std::vector<Observation>& observations, const SolveOptions& options,
                  const Scene& unsolved) {
  Solution solution = solve_two_stage(reference, observations, options);
  solution.scene = unsolved;
  return solution;
}

}  // namespace

Solution solve_precise(const Reference& reference, const std::vector<Observation>& observations,
                       const SolveOptions& options) {
  const bool lens_given = !(reference.lens.is_distortion_free() && reference.lens.fx == 1.0);
  ScenePrior prior = scene_prior(reference.site, reference.width, reference.height,
                                 lens_given ? std::optional(reference.lens) : std::nullopt);
  for (std::size_t k = 0; lens_given && options.u_camera && k < prior.u_camera.size(); ++k) {
    if (std::isfinite((*options.u_camera)[k])) prior.u_camera[k] = (*options.u_camera)[k];
  }
  // The reference frame first, then the others that show enough.
  const std::vector<BoardExtent> still(reference.site.markers.size());
  std::vector<BundleFrame> frames{bundle_frame(reference, reference.seen, prior.camera, still)};
  if (references_in(reference, frames.front()) < kLeastReferences) {
    Scene unsolved;
    unsolved.problem = "the prints of four references could not be learned from the reference frame";
    return fallback(reference, observations, options, unsolved);
  }
  std::vector<std::size_t> place(observations.size(), 0);
  Follower follower(reference);
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation& seen = observations[n];
    const auto travel = follower.follow(reference, seen);
    if (seen.decode_error || !seen.references_seen || seen.frame == reference.seen.frame) continue;
    BundleFrame frame = bundle_frame(reference, seen, prior.camera, travel);
    if (references_in(reference, frame) < kLeastReferences) continue;
    place[n] = frames.size();
    frames.push_back(std::move(frame));
  }
  std::vector<BundleFrame> key{frames.front()};
  for (const std::size_t k : key_frames(frames, kMostKeyFrames)) {
    if (k > 0) key.push_back(frames[k]);
  }
  const Calibration calibration = calibrate(reference.site, key, prior);
  if (!calibration.bundle.scene.solved) {
    return fallback(reference, observations, options, calibration.bundle.scene);
  }
  Solution solution;
  solution.scene = calibration.bundle.scene;
  const Eigen::MatrixXd covariance = scene_covariance(reference.site, calibration.fits, prior, kEverything);
  solution.scene->full_covariance = covariance;
  // Poses as the solved camera has them: with another focal length they start elsewhere.
  for (std::size_t n = 0; n < observations.size(); ++n) {
    if (place[n] > 0) frames[place[n]].pose = pose_of(observations[n].stage2, solution.scene->camera);
  }
  const FrameFit& then = calibration.fits.front();  // the reference frame leads the key frames
  const Uncertainty uncertainty(covariance, then);
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation& seen = observations[n];
    const FrameFit now = place[n] > 0 ? fit_frame(reference.site, *solution.scene, frames[place[n]]) : FrameFit{};
    const bool doubtful = seen.references_seen && order_in_doubt(reference, seen);
    for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
      if (!is_target(reference, i)) continue;
      Sample sample = begun_sample(reference, seen, i);
      if (seen.frame != reference.seen.frame) {
        sample.status = status_of(reference, seen, doubtful, i, now);
        if (has_numbers(sample.status) && then.ok && then.shift_row[i] >= 0) {
          sample.displacement = now.shift[i] - then.shift[i];
          sample.budget = uncertainty.budget(now, i);
          sample.u = total(sample.budget);
        } else if (has_numbers(sample.status)) {
          sample.status = Status::kLost;
        }
      }
      solution.samples.push_back(sample);
    }
  }
  return solution;
}

}  // namespace moiregauge
