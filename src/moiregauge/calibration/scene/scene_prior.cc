// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {
namespace {

// Unknown lens: u of the distortion at the corner of the image, relative to the half diagonal. Chosen to include wide
// phone lenses.
constexpr double kRadial = 0.05, kRadial2 = 0.02, kTangential = 0.005;
// Unknown lens: prior of f, and u of the principal point, relative to the image's larger side. From a wide phone lens
// (0.7) to a long one (6) all f are within two u. The 2 % are chosen.
constexpr double kUsualFocal = 2.0;  // relative to the image's larger side
constexpr double kPrincipal = 0.02;  // relative to the image's larger side
// Given camera without u: focus and temperature may have changed since its calibration. Relative to f, L and each
// distortion term. Chosen.
constexpr double kCalibratedFocal = 0.005, kCalibratedPrincipal = 0.002, kCalibratedDistortion = 0.05;
constexpr double kMountedTilt = 0.05;   // u of a print's tilt, rad: mounted by eye; chosen
constexpr double kTargetDepth = 100.0;  // u of a target's height without `z_mm`, mm; chosen

void unknown_lens(ScenePrior& prior, double side, double rho) {
  const double rho2 = rho * rho;
  prior.u_camera = {kUnknownFocal * prior.camera.fx, kPrincipal * side, kPrincipal * side, kRadial / rho2,
                    kRadial2 / (rho2 * rho2),        kTangential / rho, kTangential / rho, 0.0};
}

void calibrated_lens(ScenePrior& prior, double side, double rho) {
  const double rho2 = rho * rho;
  // Least u of a distortion term at the corner of the image: 0.05 % (k1), 0.02 % (k2), 0.01 % (p1, p2) of the half
  // diagonal. Chosen.
  const auto share = [](double value, double least) {
    return std::max(kCalibratedDistortion * std::abs(value), least);
  };
  const Camera& c = prior.camera;
  prior.u_camera = {kCalibratedFocal * c.fx,
                    kCalibratedPrincipal * side,
                    kCalibratedPrincipal * side,
                    share(c.k1, 0.0005 / rho2),
                    share(c.k2, 0.0002 / (rho2 * rho2)),
                    share(c.p1, 0.0001 / rho),
                    share(c.p2, 0.0001 / rho),
                    0.0};
}

}  // namespace

std::array<double, kCommonParameters> uncertainties_of(const ScenePrior& prior) {
  std::array<double, kCommonParameters> u{};
  std::copy(prior.u_camera.begin(), prior.u_camera.end(), u.begin());
  u[kStretchParameter] = prior.u_stretch;
  return u;
}

ScenePrior with_unknown_lens(ScenePrior prior) {
  const Camera& camera = prior.camera;
  const auto given = prior.u_camera;
  unknown_lens(prior, std::max(camera.width, camera.height), 0.5 * std::hypot(camera.width, camera.height) / camera.fx);
  for (std::size_t k = 0; k < given.size(); ++k) prior.u_camera[k] = std::max(prior.u_camera[k], given[k]);
  return prior;
}

ScenePrior scene_prior(const Site& site, int width, int height, const std::optional<Camera>& camera) {
  ScenePrior prior;
  const double side = std::max(width, height);
  if (camera) {
    prior.camera = *camera;
    prior.camera.fx = prior.camera.fy = 0.5 * (camera->fx + camera->fy);
  } else {
    prior.camera = {
        width, height, kUsualFocal * side, kUsualFocal * side, 0.5 * (width - 1), 0.5 * (height - 1), 0, 0, 0, 0, 0};
  }
  const double rho = 0.5 * std::hypot(width, height) / prior.camera.fx;
  if (camera)
    calibrated_lens(prior, side, rho);
  else
    unknown_lens(prior, side, rho);
  const KnownTo& known = site.known_to;
  prior.u_stretch = std::numbers::sqrt2 * known.print_scale;  // the scales of both axes are independent
  for (const Marker& marker : site.markers) {
    MarkerShape value, u;
    const bool reference = marker.role == Role::kReference;
    value.value[MarkerShape::kHeight] = marker.z_mm.value_or(0.0);
    u.value = {reference ? known.position_mm : 0.0,
               reference ? known.position_mm : 0.0,
               known.rotation_rad,
               known.print_scale,
               reference || marker.z_mm ? known.height_mm : kTargetDepth,
               kMountedTilt,
               kMountedTilt};
    prior.markers.push_back(value);
    prior.u_markers.push_back(u);
  }
  return prior;
}

}  // namespace moiregauge::internal
