// SPDX-License-Identifier: Apache-2.0
// Footage of a rig as the bundle adjustment gets it: nine points of every grating with independent noise.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "moiregauge/calibration/scene/frame_series.h"
#include "moiregauge/calibration/scene/rig_for_tests.h"
#include "moiregauge/geometry/view.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::test {

inline constexpr std::uint64_t kFootageSeed = 7;  // printed with every failure

inline Camera lens(double k1) { return {4104, 1012, 3478.26, 3478.26, 2059.3, 494.3, k1, 0, 0, 0, 0}; }

struct Angles {
  double x = 0.0, y = 0.0, z = 0.0;  // deg
};

// Returns the homography of the ideal image for a plane at this height above the board, by Eigen's own rotations. The
// camera is rotated about x, y, z, about a point 100 mm behind its lens.
inline IdealFromBoard seen_from(const Camera& camera, const Angles& angles, double height_mm = 0.0) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const double deg = kPi / 180.0;
  const Eigen::Matrix3d r =
      (AngleAxisd(angles.x * deg, Vector3d::UnitX()) * AngleAxisd(angles.y * deg, Vector3d::UnitY()) *
       AngleAxisd(angles.z * deg, Vector3d::UnitZ()))
          .toRotationMatrix();
  const Vector3d pivot(0, 0, -100);
  const Vector3d t = r * (Vector3d(0, 0, 1200) - pivot) + pivot;
  Eigen::Matrix3d k, h;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  h << r.col(0), -r.col(1), t - height_mm * r.col(2);
  return IdealFromBoard(k * h);
}

// Truth of a recording.
struct Recording {
  Site site = rig();
  Camera camera = lens(0.0);
  std::function<Angles(double)> angles;  // camera angles by time in s
  double readout_s = 0.0;                // time to read all rows, from the first to the last
  std::vector<double> height_mm{};       // one per marker; empty: all are in the plane
  // Tilts about the board's x and y axes, rad, one per marker. Empty: all prints are parallel to the plane.
  std::vector<Extent<frame::Board>> tilt{};
  // Displacement of the last marker by time, mm, also while rows are read. Empty: that of the footage, the same in all
  // rows of a frame.
  std::function<Extent<frame::Board>(double)> target{};
  double noise = kNoise;  // pitches
};

// Returns the rotation of a tilted print.
inline Eigen::Matrix3d rotation_of(Extent<frame::Board> tilt_rad) {
  const Eigen::Vector3d turn(tilt_rad.x, tilt_rad.y, 0.0);
  return Eigen::AngleAxisd(turn.norm(), turn.norm() > 0.0 ? turn.normalized() : Eigen::Vector3d::UnitX())
      .toRotationMatrix();
}

// Returns the frame at a time at which the markers have moved by `moved` (mm, one per site marker).
inline BundleFrame frame_of(const Recording& truth, double time_s, const std::vector<Extent<frame::Board>>& moved,
                            std::mt19937_64& rng) {
  std::normal_distribution<double> noise(0.0, truth.noise);
  const Camera& camera = truth.camera;
  BundleFrame frame;
  frame.time_s = time_s;
  frame.pose = pose_of(seen_from(camera, truth.angles(time_s)),
                       scene_prior(truth.site, camera.width, camera.height, std::nullopt).camera);
  for (std::size_t k = 0; k < truth.site.markers.size(); ++k) {
    const Marker& m = truth.site.markers[k];
    const double height = truth.height_mm.empty() ? 0.0 : truth.height_mm[k];
    const Eigen::Matrix3d tilted = rotation_of(truth.tilt.empty() ? Extent<frame::Board>{} : truth.tilt[k]);
    PatchFit fit;
    for (int n = 0; n < kPatchPoints; ++n) {
      const double x = (n % 3 - 1) * m.grating->width_mm / 3.0, y = (n / 3 - 1) * m.grating->height_mm / 3.0;
      const auto i = static_cast<std::size_t>(n);
      const Eigen::Vector3d point = tilted * Eigen::Vector3d(x, y, 0.0);
      const bool is_last = k + 1 == truth.site.markers.size();
      const auto at = [&](double when) {
        const auto there = truth.target && is_last ? truth.target(when) : moved[k];
        return View{seen_from(camera, truth.angles(when), height + point.z()),
                    camera}(m.grating->centre + there + Extent<frame::Board>{point.x(), point.y()});
      };
      fit.image[i] = at(time_s);
      // A point is read when the readout reaches the row in which it is then seen. Each step reduces the error by the
      // ratio of image speed and readout speed, which is below 1/50.
      for (int step = 0; truth.readout_s > 0.0 && step < 4; ++step)
        fit.image[i] = at(time_s + truth.readout_s * ((fit.image[i].y + 0.5) / camera.height - 0.5));
      fit.print[i] = {x / m.grating->pitch_mm + noise(rng), y / m.grating->pitch_mm + noise(rng)};
    }
    fit.information = PatchInformation::Identity() / (kNoise * kNoise);
    frame.points.emplace_back(fit);
    frame.shift.push_back({});
  }
  return frame;
}

struct Footage {
  std::vector<BundleFrame> frames;
  std::vector<Extent<frame::Board>> shift;  // target displacement by frame, mm
};

// Returns a second of footage. The last marker is a target and moves by 2 mm, or as the truth says.
// `offset`: further displacement of each marker by frame, mm.
inline Footage footage_of(const Recording& truth, int frames,
                          const std::function<Extent<frame::Board>(std::size_t, int)>& offset = {}) {
  std::mt19937_64 rng(kFootageSeed);
  Footage run;
  for (int i = 0; i < frames; ++i) {
    const double s = double(i) / (frames - 1);
    run.shift.push_back(truth.target ? truth.target(s) : Extent<frame::Board>{0.3 * std::sin(7.0 * s), 2.0 * s});
    std::vector<Extent<frame::Board>> moved(truth.site.markers.size());
    moved.back() = run.shift.back();
    for (std::size_t k = 0; offset && k < moved.size(); ++k) moved[k] = moved[k] + offset(k, i);
    run.frames.push_back(frame_of(truth, s, moved, rng));
    run.frames.back().frame = i;
  }
  return run;
}

// Returns a path on which a camera swings by `swing` deg about three axes within a second.
inline std::function<Angles(double)> swinging(double swing) {
  return [swing](double s) { return Angles{swing * (s - 0.5), swing * std::sin(5.0 * s), -swing * s}; };
}

inline FrameSeries series_of(const std::vector<BundleFrame>& frames) {
  auto starts = std::make_shared<std::vector<FrameStart>>();
  for (const BundleFrame& frame : frames)
    starts->push_back({frame.frame, frame.time_s, frame.pose, frame.shift, std::vector(frame.points.size(), true)});
  return {std::move(starts), [frames](std::size_t k) { return frames[k]; }};
}

// Returns the rig with six references on a wall of its own: a marker's displacement is seen against five others.
inline Site rig_of_six() {
  Site site = rig();
  const Marker target = site.markers.back();
  site.markers.pop_back();
  for (const double side : {-1.0, 1.0}) {
    Marker m = site.markers.front();
    m.name = side < 0.0 ? "W" : "E";
    m.grating->centre = {side * 130.0, -side * 40.0};
    site.markers.push_back(m);
  }
  site.markers.push_back(target);
  return site;
}

}  // namespace moiregauge::internal::test
