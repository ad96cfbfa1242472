// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/rest_claim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/precise/precise_status.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge::internal {
namespace {

// Rest frames that are tested, evenly spread: at most twice the number of key frames of the bundle adjustment.
constexpr std::size_t kMaxRestFrames = 240;
// Factor by which the variance of the frames may exceed the stated noise, because u is verified to 12 %
// (docs/accuracy.md).
constexpr double kNoiseSlack = 1.25;
// Passes of the scene towards one in which the target rests. A depth that is wrong by 10 mm bends the parallax of 50
// mm of travel at 1200 mm by 5 um. Two passes remove that.
constexpr int kScenePasses = 3;
// Largest noise of an axis that the grating shows.
constexpr double kShownAxis = 0.25;  // pitches

// Positions of a target in the rest frames, with their noise and sensitivities.
struct RestPlaces {
  std::vector<long> frame;
  Eigen::VectorXd place;               // x and y of each frame in turn, mm
  std::vector<Eigen::Matrix2d> noise;  // covariance of each frame's noise, mm^2
  Eigen::MatrixXd sensitivity;         // to the scene parameters and, last, to the readout time
  long rows = 0;                       // coordinates that the grating shows
  double chi2 = 0.0;                   // fit of the frames to the scene
  long dof = 0;
  [[nodiscard]] double unit() const { return dof > 0 ? std::max(1.0, chi2 / static_cast<double>(dof)) : 1.0; }
};

RestPlaces places_of(const Site& site, const Scene& scene, std::span<const BundleFrame> frames, std::size_t target) {
  std::vector<FrameFit> fits;
  RestPlaces out;
  for (BundleFrame frame : frames) {
    if (!frame.points[target]) continue;
    frame.pose = pose_of(site, scene, frame).value_or(frame.pose);
    FrameFit fit = fit_frame(site, scene, frame);
    if (!fit.ok || fit.shift_row[target] < 0) continue;
    out.frame.push_back(frame.frame);
    fits.push_back(std::move(fit));
  }
  const auto size = 2 * static_cast<Eigen::Index>(fits.size());
  const int parameters = scene_parameters(site.markers.size());
  const double shown_mm = kShownAxis * site.markers[target].grating->pitch_mm;
  out.place.resize(size);
  out.sensitivity = Eigen::MatrixXd::Zero(size, parameters + 1);
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const FrameFit& fit = fits[k];
    const int at = fit.shift_row[target];
    const auto row = 2 * static_cast<Eigen::Index>(k);
    out.place.segment<2>(row) << fit.shift[target].x, fit.shift[target].y;
    out.noise.emplace_back(shift_covariance(fit, target));
    out.sensitivity.block(row, 0, 2, parameters) = shift_sensitivity(fit, target);
    if (fit.by_readout.size() > at + 1) out.sensitivity.block<2, 1>(row, parameters) = fit.by_readout.segment<2>(at);
    for (const int axis : {0, 1}) out.rows += out.noise.back()(axis, axis) < shown_mm * shown_mm;
    out.chi2 += fit.chi2_sum;
    out.dof += fit.dof;
  }
  return out;
}

// Returns the scene with its parameters changed by `by`.
Scene with_parameters_moved(Scene scene, const Eigen::VectorXd& by) {
  Camera& c = scene.camera;
  const std::array<double*, kCameraParameters> camera{&c.fx, &c.cx, &c.cy, &c.k1, &c.k2, &c.p1, &c.p2, &c.k3};
  for (int k = 0; k < kCameraParameters; ++k) *camera[static_cast<std::size_t>(k)] += by(k);
  c.fy = c.fx;
  scene.stretch += by(kStretchParameter);
  for (std::size_t i = 0; i < scene.markers.size(); ++i) {
    for (int k = 0; k < kShapeParameters; ++k)
      scene.markers[i].value[static_cast<std::size_t>(k)] += by(shape_row(i, k));
  }
  return scene;
}

// Fit of the rest frames to one position, with the scene adapted within its uncertainty.
struct AtOnePlace {
  double chi2 = 0.0;
  Eigen::VectorXd misses;  // residuals that neither position nor scene explains, mm
  Eigen::VectorXd scene;   // change of the scene parameters, from where they were solved
};

// `solved_by`: change of the scene parameters with which `places` were read.
std::optional<AtOnePlace> at_one_place(const RestPlaces& places, const Eigen::MatrixXd& scene,
                                       const Eigen::VectorXd& solved_by) {
  const Eigen::Index rows = places.place.size();
  const Eigen::MatrixXd to_scene = scene * places.sensitivity.transpose();
  Eigen::MatrixXd covariance = places.sensitivity * to_scene;
  Eigen::MatrixXd one_place(rows, 2);
  for (Eigen::Index k = 0; 2 * k < rows; ++k) {
    covariance.block<2, 2>(2 * k, 2 * k) += places.noise[static_cast<std::size_t>(k)];
    one_place.middleRows<2>(2 * k).setIdentity();
  }
  const Eigen::LLT<Eigen::MatrixXd> root(covariance);
  if (root.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd seen = places.place - places.sensitivity * solved_by;
  const Eigen::MatrixXd weighted = root.solve(one_place);
  const Eigen::Vector2d place = (one_place.transpose() * weighted).ldlt().solve(weighted.transpose() * seen);
  const Eigen::VectorXd residual = seen - one_place * place;
  const Eigen::VectorXd pull = root.solve(residual);
  AtOnePlace out{residual.dot(pull), Eigen::VectorXd(rows), -(to_scene * pull)};
  for (Eigen::Index k = 0; 2 * k < rows; ++k)
    out.misses.segment<2>(2 * k) = places.noise[static_cast<std::size_t>(k)] * pull.segment<2>(2 * k);
  return out;
}

// Returns the two frames with the largest distance, and its u.
MovedAtRest furthest_apart(const RestPlaces& places, const AtOnePlace& rest, std::size_t target) {
  MovedAtRest most{.marker = target};
  for (std::size_t a = 0; a < places.frame.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const Eigen::Vector2d apart = rest.misses.segment<2>(2 * static_cast<Eigen::Index>(a)) -
                                    rest.misses.segment<2>(2 * static_cast<Eigen::Index>(b));
      const double mm = apart.norm();
      if (!(mm > most.mm)) continue;
      const Eigen::Vector2d along = apart / mm;
      most = {target, places.frame[b], places.frame[a], mm,
              std::sqrt(places.unit() * along.dot((places.noise[a] + places.noise[b]) * along))};
    }
  }
  return most;
}

std::optional<MovedAtRest> movement_of_target(const Site& site, const PreciseScene& solved,
                                              std::span<const BundleFrame> frames, std::size_t target) {
  const Scene& scene = solved.calibration.bundle.scene;
  const auto parameters = scene.full_covariance.rows();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(parameters + 1, parameters + 1);
  covariance.topLeftCorner(parameters, parameters) = scene.full_covariance;
  if (solved.shutter) covariance(parameters, parameters) = std::pow(solved.shutter->u_readout_s, 2);
  std::optional<AtOnePlace> rest;
  RestPlaces places;
  for (int pass = 0; pass < kScenePasses; ++pass) {
    // The readout time stays fixed: a change would require correcting all frames again.
    Eigen::VectorXd by = rest ? rest->scene : Eigen::VectorXd::Zero(parameters + 1);
    by(parameters) = 0.0;
    const RestPlaces now = places_of(site, with_parameters_moved(scene, by), frames, target);
    if (now.frame.size() < 2 || (pass > 0 && now.frame.size() < places.frame.size())) break;
    auto fitted = at_one_place(now, covariance, by);
    if (!fitted) break;
    if (rest && !(fitted->chi2 < rest->chi2)) break;
    const double unit = pass == 0 ? now.unit() : places.unit();
    rest = std::move(fitted);
    places = now;
    places.chi2 = unit * static_cast<double>(places.dof);
  }
  if (!rest || places.rows <= 2) return std::nullopt;
  const double allowed = kNoiseSlack * places.unit() * chi2_upper_quantile(static_cast<double>(places.rows - 2));
  if (!(rest->chi2 > allowed)) return std::nullopt;
  return furthest_apart(places, *rest, target);
}

// Returns evenly spread rest frames, with the reference frame if it is one of them. Each contains only the targets
// whose row would be `ok`.
std::vector<BundleFrame> tested_frames(const Reference& reference, const Observations& observations,
                                       const std::vector<std::size_t>& place, const PreciseScene& solved,
                                       const FrameRange& rest) {
  const Site& site = reference.site;
  const auto weighed = [&](std::size_t k) {
    const BundleFrame frame = solved.frames[k];
    return with_print_error(site, std::span(&frame, 1), solved.print_error).front();
  };
  std::vector<std::size_t> all;
  for (std::size_t n = 0; n < observations.size(); ++n) {
    if (place[n] > 0 && rest.holds(observations[n].frame)) all.push_back(n);
  }
  std::vector<BundleFrame> out;
  if (rest.holds(reference.seen.frame)) out.push_back(weighed(0));
  const std::size_t count = std::min(all.size(), kMaxRestFrames);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t n = all[count < 2 ? k : k * (all.size() - 1) / (count - 1)];
    BundleFrame frame = weighed(place[n]);
    const Scene& scene = solved.calibration.bundle.scene;
    frame.pose = pose_of(site, scene, frame).value_or(frame.pose);
    const FrameFit fit = fit_frame(site, scene, frame, FrameDetail::kSamples);
    for (std::size_t i = 0; i < site.markers.size(); ++i) {
      if (!is_target(reference, i)) continue;
      const Status status =
          precise_status(reference, observations[n], i, fit, solved.shutter ? kRollingChi2 : kUntrustedChi2);
      if (status != Status::kOk) frame.points[i].reset();
    }
    out.push_back(std::move(frame));
  }
  for (BundleFrame& frame : out) frame.at_rest = false;
  return out;
}

}  // namespace

std::optional<MovedAtRest> moved_at_rest(const Reference& reference, const Observations& observations,
                                         const std::vector<std::size_t>& place, const PreciseScene& without_claim,
                                         const FrameRange& rest) {
  const auto frames = tested_frames(reference, observations, place, without_claim, rest);
  std::optional<MovedAtRest> most;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (!is_target(reference, i)) continue;
    const auto moved = movement_of_target(reference.site, without_claim, frames, i);
    if (moved && (!most || moved->mm > most->mm)) most = moved;
  }
  return most;
}

}  // namespace moiregauge::internal
