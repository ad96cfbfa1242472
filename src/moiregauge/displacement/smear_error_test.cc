// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/smear_error.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kSmearPitch = 10.0;  // mm
constexpr int kShakeFrames = 200, kExposureSteps = 64;
constexpr std::uint64_t kShakeSeed = 23;
constexpr double kSmearHarmonics = 3.7;  // F of the header

// A vibration within exposures as long as a frame, and a camera that moves at a constant speed in each.
struct Shake {
  double amplitude_mm = 0.0, periods = 0.0;  // per exposure
  double camera_mm = 0.0;                    // rms movement per exposure
};

struct Smeared {
  double u = 0.0, error = 0.0;  // rms over the frames, mm
};

// Returns the reading of a grating that is smeared by `variance` (mm^2) along y.
PatchFit smeared(double variance) {
  PatchFit fit;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const double x = static_cast<double>(n % 3) - 1.0, y = static_cast<double>(n / 3) - 1.0;
    fit.print[n] = {x, y}, fit.image[n] = {20.0 * x, -20.0 * y};
  }
  fit.light = {100.0, 0.0, 0.0}, fit.gain = {1.0, 0.0, 0.0};
  fit.fundamental = {1.0, std::exp(-2.0 * kPi * kPi * variance / (kSmearPitch * kSmearPitch))};
  return fit;
}

// The error is that of the first harmonics by the third moment of the path, as in the header.
Smeared film_of(const Shake& shake) {
  std::mt19937_64 rng(kShakeSeed);
  std::normal_distribution<double> normal;
  Site site;
  for (const Role role : {Role::kReference, Role::kReference, Role::kReference, Role::kTarget}) {
    Marker marker;
    marker.role = role;
    marker.grating = Grating{{}, 40.0, 40.0, kSmearPitch, 0.0, Pattern::kGrid};
    site.markers.push_back(marker);
  }
  auto starts = std::make_shared<std::vector<FrameStart>>();
  std::vector<BundleFrame> frames;
  std::vector<double> errors;
  double camera_px = 0.0;
  for (int frame = 0; frame < kShakeFrames; ++frame) {
    const double speed = shake.camera_mm * normal(rng);
    double m1 = 0.0, target2 = 0.0, target3 = 0.0;
    const auto path = [&](int k) {
      return shake.amplitude_mm * std::sin(kTwoPi * shake.periods * (1.037 * frame + (k + 0.5) / kExposureSteps));
    };
    for (int k = 0; k < kExposureSteps; ++k) m1 += path(k) / kExposureSteps;
    for (int k = 0; k < kExposureSteps; ++k) {
      const double x = path(k) - m1 + speed * ((k + 0.5) / kExposureSteps - 0.5);
      target2 += x * x / kExposureSteps, target3 += x * x * x / kExposureSteps;
    }
    errors.push_back(kSmearHarmonics * std::pow(kTwoPi / kSmearPitch, 2) / 6.0 * target3);
    BundleFrame one;
    camera_px += 2.0 * speed;
    for (const Marker& marker : site.markers) {
      PatchFit fit = smeared(marker.role == Role::kTarget ? target2 : speed * speed / 12.0);
      for (ImagePoint& point : fit.image) point.y += camera_px;
      one.points.emplace_back(fit);
      one.shift.push_back({0.0, marker.role == Role::kTarget ? m1 : 0.0});
    }
    starts->push_back({frame, frame * 0.1, {}, one.shift, std::vector<bool>(site.markers.size(), true)});
    frames.push_back(std::move(one));
  }
  const SmearError found = smear_error(site, {std::move(starts), [&](std::size_t k) { return frames[k]; }});
  Smeared out;
  for (std::size_t k = 1; k < errors.size(); ++k) {
    out.error += errors[k] * errors[k] / (kShakeFrames - 1);
    if (found.empty()) continue;
    out.u += found[k].back().y * found[k].back().y / (kShakeFrames - 1);
    EXPECT_EQ(found[k].back().x, 0.0);
  }
  return {std::sqrt(out.u), std::sqrt(out.error)};
}

// u must not be below the error. Its factors are for the worst phase of a path, so it may be many times as large.
TEST(SmearError, CoversTheThirdMomentOfAVibration) {
  for (const double periods : {0.2, 0.35, 0.5, 0.7, 0.9}) {
    for (const double camera_mm : {0.0, 0.5, 1.5}) {
      const Smeared film = film_of({0.15 * kSmearPitch, periods, camera_mm});
      EXPECT_GT(film.u, 0.7 * film.error) << periods << " periods, camera " << camera_mm << " mm, seed " << kShakeSeed;
      EXPECT_LT(film.u, 15.0 * film.error + 0.002) << periods << " periods, camera " << camera_mm << " mm";
    }
  }
}

// A camera's movement alone blurs all gratings alike, and a target at rest has no smear.
TEST(SmearError, IsZeroWithoutMovementOfTheTarget) {
  for (const double camera_mm : {0.0, 1.5}) EXPECT_EQ(film_of({0.0, 0.5, camera_mm}).u, 0.0);
}

// A slow vibration moves by little within an exposure.
TEST(SmearError, IsNegligibleForSlowMovement) {
  const Smeared film = film_of({0.15 * kSmearPitch, 0.02, 0.0});
  EXPECT_LT(film.u, 1e-3);
}

}  // namespace
}  // namespace moiregauge::internal
