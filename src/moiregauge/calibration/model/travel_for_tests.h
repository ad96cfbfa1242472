// SPDX-License-Identifier: Apache-2.0
// Footage of a travelling camera as the bundle adjustment gets it, with a target off the plane of the references.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "moiregauge/calibration/scene/bundle.h"
#include "moiregauge/calibration/scene/rig_for_tests.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::test {

inline constexpr std::uint64_t kTravelSeed = 11;  // printed with every failure
inline constexpr int kTravelFrames = 20;
inline constexpr std::size_t kMid = 4;                             // the target
inline constexpr double kDepthMm = -30.0;                          // height of the target
inline constexpr double kDistanceMm = 1200.0;                      // between camera and board
inline constexpr double kTravelMm = 50.0, kTurnRad = kPi / 180.0;  // largest movement of the camera on each axis
inline constexpr double kPointNoise = 5e-5;                        // pitches: 0.5 um
inline constexpr Camera kIdeal{1344, 832, 3478.26, 3478.26, 671.5, 415.5, 0, 0, 0, 0, 0};
inline constexpr KnownTo kSurveyed{
    .position_mm = 0.01, .rotation_rad = 0.001 * kPi / 180.0, .height_mm = 0.01, .print_scale = 0.0005};

// Returns four references in a plane and a target. The height of the target is stated if it is given.
inline Site small_rig(const KnownTo& known, std::optional<double> height_mm = std::nullopt) {
  Site site;
  site.known_to = known;
  const auto add = [&](Role role, double x, double y, double size) {
    Marker m;
    m.role = role;
    m.grating = Grating{{x, y}, size, size, kPitch, 0.0, Pattern::kGrid};
    site.markers.push_back(m);
  };
  for (const double y : {40.0, -40.0}) {
    for (const double x : {-100.0, 100.0}) add(Role::kReference, x, y, 30.0);
  }
  add(Role::kTarget, 0.0, 0.0, 40.0);
  site.markers[kMid].z_mm = height_mm;
  return site;
}

// Draws the true positions, angles, scales and heights from what a site states. The height of the target is 30 mm below
// the plane.
inline std::vector<MarkerShape> drawn_from(const KnownTo& known, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  std::vector<MarkerShape> out(kMid + 1);
  for (std::size_t i = 0; i <= kMid; ++i) {
    const double u_mm = i == kMid ? 0.0 : known.position_mm;
    out[i].value = {u_mm * normal(rng), u_mm * normal(rng), known.rotation_rad * normal(rng),
                    known.print_scale * normal(rng), known.height_mm * normal(rng)};
  }
  out[kMid].value[MarkerShape::kHeight] += kDepthMm;
  return out;
}

// Camera of one frame: rotation about its own centre, then travel.
struct Travel {
  double turn_x_rad, turn_y_rad, turn_z_rad;
  Eigen::Vector3d mm;
  [[nodiscard]] Eigen::Matrix3d rotation() const {
    return (Eigen::AngleAxisd(turn_x_rad, Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(turn_y_rad, Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(turn_z_rad, Eigen::Vector3d::UnitZ()))
        .toRotationMatrix();
  }
};

inline Travel drawn_travel(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  Travel out{kTurnRad * even(rng), kTurnRad * even(rng), kTurnRad * even(rng), {}};
  for (Eigen::Index k = 0; k < 3; ++k) out.mm(k) = kTravelMm * even(rng);
  return out;
}

// Returns the nine points of a grating through an ideal lens, with noise.
inline PatchFit points_of(const Grating& grating, const MarkerShape& shape, const Eigen::Matrix3d& rotation,
                          const Eigen::Vector3d& shift, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0.0, kPointNoise);
  const auto& s = shape.value;
  const double c = (1.0 + s[MarkerShape::kScale]) * std::cos(s[MarkerShape::kRotation]);
  const double d = (1.0 + s[MarkerShape::kScale]) * std::sin(s[MarkerShape::kRotation]);
  PatchFit fit;
  for (int n = 0; n < kPatchPoints; ++n) {
    const double x = (n % 3 - 1) * grating.width_mm / 3.0, y = (n / 3 - 1) * grating.height_mm / 3.0;
    const double board_x = grating.centre.x + s[MarkerShape::kX] + c * x - d * y;
    const double board_y = grating.centre.y + s[MarkerShape::kY] + d * x + c * y;
    const Eigen::Vector3d at = rotation * Eigen::Vector3d(board_x, -board_y, -s[MarkerShape::kHeight]) + shift;
    const auto p = static_cast<std::size_t>(n);
    fit.image[p] = {kIdeal.fx * at.x() / at.z() + kIdeal.cx, kIdeal.fy * at.y() / at.z() + kIdeal.cy};
    fit.print[p] = {x / grating.pitch_mm + noise(rng), y / grating.pitch_mm + noise(rng)};
  }
  fit.information = PatchInformation::Identity() / (kPointNoise * kPointNoise);
  return fit;
}

struct TravelFootage {
  std::vector<Travel> camera;
  std::vector<BundleFrame> frames;
};

// Returns footage of a travelling camera. The target rests, so every displacement is an error.
inline TravelFootage travelling(const std::vector<MarkerShape>& shapes, std::mt19937_64& rng) {
  const Site site = small_rig(kSurveyed);
  TravelFootage out;
  for (int k = 0; k < kTravelFrames; ++k) {
    out.camera.push_back(drawn_travel(rng));
    const Eigen::Matrix3d rotation = out.camera.back().rotation();
    const Eigen::Vector3d shift = rotation * Eigen::Vector3d(0, 0, kDistanceMm) + out.camera.back().mm;
    const Eigen::AngleAxisd turned(rotation);
    const Eigen::Vector3d turn = turned.angle() * turned.axis();
    BundleFrame frame;
    frame.frame = k;
    frame.pose = {{turn.x(), turn.y(), turn.z()}, {shift.x(), shift.y(), shift.z()}};
    frame.shift.resize(site.markers.size());
    for (std::size_t i = 0; i < site.markers.size(); ++i)
      frame.points.emplace_back(points_of(*site.markers[i].grating, shapes[i], rotation, shift, rng));
    out.frames.push_back(std::move(frame));
  }
  return out;
}

}  // namespace moiregauge::internal::test
