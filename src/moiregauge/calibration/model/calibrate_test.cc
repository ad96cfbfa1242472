// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/model/calibrate.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/calibration/scene/rig_for_tests.h"
#include "moiregauge/geometry/view.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using test::kNoise, test::kPitch, test::rig;

constexpr std::uint64_t kCalibrateSeed = 7;  // printed with every failure

Camera lens(double k1) { return {4104, 1012, 3478.26, 3478.26, 2059.3, 494.3, k1, 0, 0, 0, 0}; }

// Returns the homography of the ideal image, by Eigen's own rotations. The camera is rotated by the angles (deg, about
// x, y, z) about a point 100 mm behind its lens.
IdealFromBoard seen_from(const Camera& camera, double ax, double ay, double az) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const double deg = kPi / 180.0;
  const Eigen::Matrix3d r = (AngleAxisd(ax * deg, Vector3d::UnitX()) * AngleAxisd(ay * deg, Vector3d::UnitY()) *
                             AngleAxisd(az * deg, Vector3d::UnitZ()))
                                .toRotationMatrix();
  const Vector3d pivot(0, 0, -100);
  const Vector3d t = r * (Vector3d(0, 0, 1200) - pivot) + pivot;
  Eigen::Matrix3d k, h;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  h << r.col(0), -r.col(1), t;
  return IdealFromBoard(k * h);
}

// Nine points of every grating, each with independent noise. The target has moved by `shift`.
BundleFrame frame_of(const Site& site, const Camera& camera, const IdealFromBoard& view, Extent<frame::Board> shift,
                     long number, std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0.0, kNoise);
  BundleFrame frame;
  frame.frame = number;
  frame.pose = pose_of(view, scene_prior(site, camera.width, camera.height, std::nullopt).camera);
  for (const Marker& m : site.markers) {
    PatchFit fit;
    const Extent<frame::Board> moved = m.role == Role::kTarget ? shift : Extent<frame::Board>{};
    for (int n = 0; n < kPatchPoints; ++n) {
      const double x = (n % 3 - 1) * m.grating->width_mm / 3.0, y = (n / 3 - 1) * m.grating->height_mm / 3.0;
      const auto i = static_cast<std::size_t>(n);
      fit.image[i] = View{view, camera}(m.grating->centre + moved + Extent<frame::Board>{x, y});
      fit.print[i] = {x / kPitch + noise(rng), y / kPitch + noise(rng)};
    }
    fit.information = PatchInformation::Identity() / (kNoise * kNoise);
    frame.points.emplace_back(fit);
    frame.shift.push_back({});
  }
  return frame;
}

struct Footage {
  std::vector<BundleFrame> frames;
  std::vector<Extent<frame::Board>> shift;
};

// A camera that swings by `swing` deg about three axes while the target moves by 2 mm.
Footage footage_of(const Site& site, const Camera& camera, double swing, int frames) {
  std::mt19937_64 rng(kCalibrateSeed);
  Footage run;
  for (int i = 0; i < frames; ++i) {
    const double s = double(i) / (frames - 1);
    run.shift.push_back({0.3 * std::sin(7.0 * s), 2.0 * s});
    run.frames.push_back(frame_of(site, camera,
                                  seen_from(camera, swing * (s - 0.5), swing * std::sin(5.0 * s), -swing * s),
                                  run.shift.back(), i, rng));
  }
  return run;
}

TEST(Pose, FollowsFromTheCamerasOwnView) {
  const auto view = seen_from(lens(0.0), 1.0, -2.0, 3.0);
  const Pose pose = pose_of(view, lens(0.0));
  const auto camera = lens(0.0);
  for (const BoardPoint p : {BoardPoint{0, 0}, {300, 20}, {-100, 40}}) {
    using Eigen::Vector3d;
    const Vector3d turn(pose.turn[0], pose.turn[1], pose.turn[2]);
    const Vector3d at = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * Vector3d(p.x, -p.y, 0) +
                        Vector3d(pose.shift[0], pose.shift[1], pose.shift[2]);
    EXPECT_NEAR(camera.fx * at.x() / at.z() + camera.cx, view(p).x, 1e-6);
    EXPECT_NEAR(camera.fy * at.y() / at.z() + camera.cy, view(p).y, 1e-6);
  }
}

// The lens bends the board by 0.1 mm. The expected noise of a displacement is 1.05 um. Its factors are 2 um / 3 for
// nine points, sqrt(1 + 1/4) for the references and sqrt(2) for the reference frame. The limit is four times that, for
// 23 frames.
TEST(Calibrate, SolvesTheLensToTheNoiseOfThePoints) {
  const Site site = rig();
  const Camera camera = lens(-0.0225);
  const Footage run = footage_of(site, camera, 6.0, 24);
  const Calibration solved = calibrate(site, run.frames, scene_prior(site, camera.width, camera.height, std::nullopt));
  const Scene& scene = solved.bundle.scene;
  ASSERT_TRUE(scene.solved) << scene.problem << ", seed " << kCalibrateSeed;
  EXPECT_TRUE(scene.model.radial);
  EXPECT_FALSE(scene.model.tangential) << "the lens has none";
  EXPECT_NEAR(scene.chi2_dof, 1.0, 0.15);
  const FrameFit then = fit_frame(site, scene, solved.bundle.frames.front());
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const FrameFit now = fit_frame(site, scene, solved.bundle.frames[k]);
    ASSERT_TRUE(now.ok);
    const auto moved = now.shift[4] - then.shift[4], truth = run.shift[k] - run.shift[0];
    EXPECT_NEAR(moved.y, truth.y, 4.2e-3) << "frame " << k << ", seed " << kCalibrateSeed;
  }
  // Compare the distortion where the references are: k1 r^2 f r of 6 px is determined to 1 %.
  const double r = 340.0 / 1200.0;
  const auto bend = [&](const Camera& c) { return c.fx * r * r * r * (c.k1 + c.k2 * r * r); };
  EXPECT_NEAR(bend(scene.camera) / bend(camera), 1.0, 0.1);
}

// The gratings are 0.5 % too long along x, and the site knows them to 0.05 %. Only their positions show their scale.
// The displacement is therefore wrong by half the stretch, and u includes it.
TEST(Calibrate, AStretchIsFoundAndEnlargesTheUncertaintyOfScale) {
  constexpr double kStretch = 0.005;
  const Site site = rig();
  const Camera camera = lens(-0.0225);
  Footage run = footage_of(site, camera, 6.0, 24);
  for (BundleFrame& frame : run.frames) {
    for (auto& fit : frame.points) {
      for (PrintPoint& p : fit->print) p.x /= 1.0 + kStretch;
    }
  }
  const Calibration solved = calibrate(site, run.frames, scene_prior(site, camera.width, camera.height, std::nullopt));
  const Scene& scene = solved.bundle.scene;
  ASSERT_TRUE(scene.solved) << scene.problem << ", seed " << kCalibrateSeed;
  EXPECT_TRUE(solved.stretched);
  const double u = std::sqrt(scene.covariance(kStretchParameter, kStretchParameter));
  EXPECT_LT(u, 0.1 * kStretch);
  EXPECT_NEAR(scene.stretch, kStretch, 4.0 * u) << "seed " << kCalibrateSeed;
  EXPECT_NEAR(scene.chi2_dof, 1.0, 0.15);
  const std::size_t target = 4;
  const double u_scale = solved.prior.u_markers[target].value[MarkerShape::kScale];
  EXPECT_NEAR(u_scale, 0.5 * kStretch, 0.1 * kStretch);
}

TEST(Calibrate, GratingsAsStatedKeepTheirScale) {
  const Site site = rig();
  const Camera camera = lens(-0.0225);
  const ScenePrior prior = scene_prior(site, camera.width, camera.height, std::nullopt);
  const Calibration solved = calibrate(site, footage_of(site, camera, 6.0, 24).frames, prior);
  EXPECT_FALSE(solved.stretched);
  EXPECT_LT(std::abs(solved.bundle.scene.stretch), 4.0 * prior.u_stretch);
}

TEST(Calibrate, AFixedCameraNeedsNoLens) {
  const Site site = rig();
  const Camera camera = lens(0.0);
  const Footage run = footage_of(site, camera, 0.0, 8);
  const Calibration solved = calibrate(site, run.frames, scene_prior(site, camera.width, camera.height, std::nullopt));
  ASSERT_TRUE(solved.bundle.scene.solved);
  const FrameFit then = fit_frame(site, solved.bundle.scene, solved.bundle.frames.front());
  for (std::size_t k = 1; k < run.frames.size(); ++k) {
    const FrameFit now = fit_frame(site, solved.bundle.scene, solved.bundle.frames[k]);
    EXPECT_NEAR((now.shift[4] - then.shift[4]).y, (run.shift[k] - run.shift[0]).y, 4.2e-3) << "seed " << kCalibrateSeed;
  }
}

}  // namespace
}  // namespace moiregauge::internal
