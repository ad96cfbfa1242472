// SPDX-License-Identifier: Apache-2.0
// Tests the camera poses of simulated runs against the true ones: their errors are those that their u states.
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "common/simulated_run.h"
#include "moiregauge/displacement/camera_pose.h"
#include "moiregauge/units/units.h"
#include "studies/in_parallel.h"

namespace moiregauge::internal {
namespace {

Eigen::Matrix3d rotation_xyz(double x, double y, double z) {
  return (Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

struct TruePose {
  std::array<double, 3> angle_rad, shift_mm;
};

// Returns the pose by the mount's definition: X_cam = Rx Ry Rz (X - pivot) + pivot + shift, with the board at
// X = (x, -y, distance - z).
TruePose true_pose(const simulator::Scenario& scenario, long frame) {
  const auto& m = scenario.mount;
  const double t = simulator::time_of(scenario, frame);
  TruePose out{{radians_from_degrees(m.rotation_x.at(t)), radians_from_degrees(m.rotation_y.at(t)),
                radians_from_degrees(m.rotation_z.at(t))},
               {}};
  const Eigen::Vector3d pivot(m.pivot_x_mm, m.pivot_y_mm, m.pivot_z_mm);
  const Eigen::Vector3d shift = rotation_xyz(out.angle_rad[0], out.angle_rad[1], out.angle_rad[2]) *
                                    (Eigen::Vector3d(0, 0, m.distance_mm) - pivot) +
                                pivot + Eigen::Vector3d(m.shift_x.at(t), m.shift_y.at(t), m.shift_z.at(t));
  out.shift_mm = {shift.x(), shift.y(), shift.z()};
  return out;
}

// Errors of the poses of one run in their u: three angles, then three shifts, of each frame.
using Pulls = std::array<std::vector<double>, 6>;

void add_pulls(const simulator::Scenario& scenario, const test::MeasuredRun& run, Pulls& pulls) {
  for (std::size_t n = 0; n < run.observations.size(); ++n) {
    const TruePose truth = true_pose(scenario, run.observations[n].frame);
    const CameraPose& pose = run.solution.poses.at(n);
    for (std::size_t k = 0; k < 3; ++k) {
      pulls[k].push_back((pose.angle_rad[k] - truth.angle_rad[k]) / pose.u_angle_rad[k]);
      pulls[k + 3].push_back((pose.shift_mm[k] - truth.shift_mm[k]) / pose.u_shift_mm[k]);
    }
  }
}

// Returns the pulls of a run with drawn errors of site and given camera.
Pulls pulls_of(std::uint64_t seed) {
  auto scenario = *simulator::built_in("small-spread-1");
  scenario.seed = seed;
  scenario.known_to = {.position_mm = 0.1, .rotation_rad = 0.0005, .height_mm = 0.5, .print_scale = 0.0005};
  scenario.draw = {.position = true, .rotation = true, .height = true, .print_scale = true};
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal;
  test::RunPlan plan{.method = "precise", .step = 12};
  constexpr double kU_px = 2.0;
  plan.solve.u_camera = std::array<double, kCameraParameters>{kU_px, kU_px, kU_px};
  plan.lens = {scenario.camera.width, scenario.camera.height, scenario.camera.fx,
               scenario.camera.fy,    scenario.camera.cx,     scenario.camera.cy};
  plan.lens.fx += kU_px * normal(rng);
  plan.lens.fy = plan.lens.fx;
  plan.lens.cx += kU_px * normal(rng);
  plan.lens.cy += kU_px * normal(rng);
  const auto run = test::measured(scenario, plan);
  Pulls pulls;
  if (run.problem.empty()) add_pulls(scenario, run, pulls);
  return pulls;
}

TEST(CameraPose, AnglesComposeToTheRotation) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> angle(-1.5, 1.5);
  for (int trial = 0; trial < 100; ++trial) {
    const std::array<double, 3> wanted{angle(rng), angle(rng), angle(rng)};
    const Eigen::AngleAxisd turn(rotation_xyz(wanted[0], wanted[1], wanted[2]));
    const Eigen::Vector3d axis = turn.angle() * turn.axis();
    const auto found = angles_of({axis.x(), axis.y(), axis.z()});
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], 1e-12);
  }
}

TEST(CameraPose, ItsErrorsScatterByItsUncertainty) {
  constexpr int kRuns = 12;
  const auto runs =
      study::in_parallel("camera pose", kRuns, [](int n) { return pulls_of(static_cast<std::uint64_t>(n) + 301); });
  for (std::size_t k = 0; k < 6; ++k) {
    std::vector<double> all;
    for (const Pulls& pulls : runs) all.insert(all.end(), pulls[k].begin(), pulls[k].end());
    ASSERT_EQ(all.size(), 14U * kRuns);
    // The frames of a run share the errors of site and camera, so 12 runs have at least 12 degrees of freedom. The
    // relative standard error is at most 1 / sqrt(24) = 20 %. Three of them are allowed.
    EXPECT_NEAR(test::rms(all), 1.0, 0.61) << k;
    // By chance, four or more of 12 runs are outside of 2 u once in 500 times.
    const auto inside = std::count_if(all.begin(), all.end(), [](double pull) { return std::abs(pull) < 2.0; });
    EXPECT_GT(static_cast<double>(inside) / static_cast<double>(all.size()), 8.0 / kRuns)
        << k << " rms " << test::rms(all);
  }
}

}  // namespace
}  // namespace moiregauge::internal
