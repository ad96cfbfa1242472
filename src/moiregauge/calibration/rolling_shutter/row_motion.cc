// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/rolling_shutter/row_motion.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "moiregauge/calibration/scene/patch_residual.h"

namespace moiregauge::internal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Matrix3d rotation_by(const Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 1e-12 ? AngleAxisd(angle, turn / angle).toRotationMatrix() : Matrix3d(Matrix3d::Identity());
}

Vector3d turn_of(const Matrix3d& rotation) {
  const AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

// Returns the coordinates after the delay by the Taylor series of the motion.
PathPlace moved(const PathPlace& place, const FrameMotion& motion, double delay_s) {
  PathPlace out = place;
  for (int k = 0; k < kPathParameters; ++k) {
    const PathPoint& m = motion.camera[static_cast<std::size_t>(k)];
    out(k) += delay_s * (m.rate + 0.5 * delay_s * (m.acceleration + delay_s / 3.0 * m.jerk));
  }
  return out;
}

// Returns the derivative of `moved` by the delay.
PathPlace speed(const FrameMotion& motion, double delay_s) {
  PathPlace out;
  for (int k = 0; k < kPathParameters; ++k) {
    const PathPoint& m = motion.camera[static_cast<std::size_t>(k)];
    out(k) = m.rate + delay_s * (m.acceleration + 0.5 * delay_s * m.jerk);
  }
  return out;
}

using Numbers = std::array<double, 6>;
Numbers numbers(const Pose& p) { return {p.turn[0], p.turn[1], p.turn[2], p.shift[0], p.shift[1], p.shift[2]}; }

constexpr double kStep = 1e-5;  // rad, central difference: 0.03 px in the image, with a relative error of 1e-10

// Poses one step to either side of each coordinate, for derivatives of the image.
struct Sides {
  std::array<Numbers, kPathParameters> more, less;
  Sides(const PathPlace& place, const Pose& reference) {
    for (int k = 0; k < kPathParameters; ++k) {
      PathPlace at = place;
      at(k) += kStep;
      more[static_cast<std::size_t>(k)] = numbers(pose_at(at, reference));
      at(k) -= 2.0 * kStep;
      less[static_cast<std::size_t>(k)] = numbers(pose_at(at, reference));
    }
  }
};

// Least u of the motion: smaller values would spoil the normal equations. Over 10 ms 1e-6 rad/s is 3e-5 px at f = 3000
// px.
constexpr double kMinRate = 1e-6;          // rad / s
constexpr double kMinAcceleration = 1e-4;  // rad / s^2
// Limit for the same reason: at either end of the footage rate and acceleration are almost fully correlated.
constexpr double kMaxCorrelation = 0.99;

Eigen::Matrix<double, kMotionParameters, kMotionParameters> information_of(const FrameMotion& motion) {
  Eigen::Matrix<double, kMotionParameters, kMotionParameters> out;
  out.setZero();
  for (int k = 0; k < kPathParameters; ++k) {
    Eigen::Matrix2d c = motion.camera[static_cast<std::size_t>(k)].covariance;
    c(0, 0) = std::max(c(0, 0), 0.0) + kMinRate * kMinRate;
    c(1, 1) = std::max(c(1, 1), 0.0) + kMinAcceleration * kMinAcceleration;
    const double most = kMaxCorrelation * std::sqrt(c(0, 0) * c(1, 1));
    c(0, 1) = c(1, 0) = std::clamp(c(0, 1), -most, most);
    const Eigen::Matrix2d i = c.inverse();
    out(k, k) = i(0, 0);
    out(k, k + kPathParameters) = out(k + kPathParameters, k) = i(0, 1);
    out(k + kPathParameters, k + kPathParameters) = i(1, 1);
  }
  return out;
}

}  // namespace

ReadoutDirection rows_run(int rotation_deg) {
  switch (((rotation_deg % 360) + 360) % 360) {
    case 90:
      return ReadoutDirection::kLeft;
    case 180:
      return ReadoutDirection::kUp;
    case 270:
      return ReadoutDirection::kRight;
    default:
      return ReadoutDirection::kDown;
  }
}

double share_of_row(ImagePoint p, const Camera& picture, ReadoutDirection run) {
  const double down = (p.y + 0.5) / picture.height - 0.5, right = (p.x + 0.5) / picture.width - 0.5;
  switch (run) {
    case ReadoutDirection::kUp:
      return -down;
    case ReadoutDirection::kRight:
      return right;
    case ReadoutDirection::kLeft:
      return -right;
    case ReadoutDirection::kDown:
      break;
  }
  return down;
}

PathPlace path_place(const Pose& pose, const Pose& reference) {
  const Vector3d turn = turn_of(TurnedPose(pose).rotation * TurnedPose(reference).rotation.transpose());
  PathPlace out;
  out << turn, pose.shift[0] / pose.shift[2], pose.shift[1] / pose.shift[2], std::log(pose.shift[2]);
  return out;
}

Pose pose_at(const PathPlace& place, const Pose& reference) {
  const Vector3d turn = turn_of(rotation_by(place.head<3>()) * TurnedPose(reference).rotation);
  const double z = std::exp(place(5));
  return {{turn.x(), turn.y(), turn.z()}, {z * place(3), z * place(4), z}};
}

PathPlace path_variance(const Pose& pose, const Eigen::MatrixXd& covariance) {
  // Rotations of the pose act on the board before its shift. Assume that they are about the camera's axes (error: a few
  // per cent).
  const double z = pose.shift[2];
  PathPlace out;
  out << covariance(0, 0), covariance(1, 1), covariance(2, 2), covariance(3, 3) / (z * z), covariance(4, 4) / (z * z),
      covariance(5, 5) / (z * z);
  return out.cwiseMax(0.0);
}

BundleFrame to_frame_time(const Site& site, const Scene& scene, const BundleFrame& seen, const PathMotion& path,
                          const Readout& readout) {
  const auto& [motion, reference] = path;
  BundleFrame out = seen;
  RowDesign rows;
  rows.by_marker.resize(seen.points.size(), RowDesign::Columns::Zero());
  rows.information = information_of(motion);
  const CommonNumbers camera = numbers_of(scene);
  const PathPlace place = path_place(seen.pose, reference);
  const Numbers middle = numbers(pose_at(place, reference));
  const Sides sides(place, reference);
  for (std::size_t i = 0; i < seen.points.size(); ++i) {
    if (!seen.points[i] || !site.markers[i].grating) continue;
    const PatchResidual patch(*seen.points[i], site.markers[i]);
    RowDesign::Columns& columns = rows.by_marker[i];
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      const double share = share_of_row(seen.points[i]->image[n], scene.camera, readout.direction);
      const double delay = share * readout.duration_s;
      const auto board = patch.board(scene.stretch, scene.markers[i], seen.shift[i], n);
      const auto seen_from = [&](const Numbers& pose) {
        const auto p = projected(camera.data(), pose.data(), board);
        return Vector2d(p[0], p[1]);
      };
      const Numbers then = numbers(pose_at(moved(place, motion, delay), reference));
      auto shift = seen.shift[i];
      if (!motion.targets.empty())
        shift = shift + delay * motion.targets[i].rate + 0.5 * delay * delay * motion.targets[i].acceleration;
      const auto there = projected(camera.data(), then.data(), patch.board(scene.stretch, scene.markers[i], shift, n));
      const Vector2d went = Vector2d(there[0], there[1]) - seen_from(middle);
      out.points[i]->image[n].x -= went.x();
      out.points[i]->image[n].y -= went.y();
      const PathPlace by_readout = share * speed(motion, delay);
      Vector2d by_duration = Vector2d::Zero();
      const auto put = [&](int column, const Vector2d& value) {
        columns(static_cast<Eigen::Index>(n), column) = value.x();
        columns(static_cast<Eigen::Index>(n + kPatchPoints), column) = value.y();
      };
      for (int k = 0; k < kPathParameters; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const Vector2d off =
            patch.pitches_per_px(n) * (seen_from(sides.more[at]) - seen_from(sides.less[at])) / (2.0 * kStep);
        by_duration += off * by_readout(k);
        put(k, off * delay);
        put(k + kPathParameters, off * 0.5 * delay * delay);
      }
      put(kMotionParameters, by_duration);
    }
  }
  out.rows = std::move(rows);
  return out;
}

double chi2_of_turning(const Site& site, const Scene& scene, const BundleFrame& frame, const FrameFit& fit,
                       ReadoutDirection run) {
  if (!fit.ok) return 0.0;
  // Roll and the two directions to the board are free. Priors: 1 rad per readout, 10 rad per readout squared.
  FrameMotion free{};
  for (const std::size_t k : {2, 3, 4}) free.camera[k].covariance = Eigen::Vector2d(1.0, 100.0).asDiagonal();
  BundleFrame rolling = frame;
  rolling.pose = fit.pose;
  rolling.shift = fit.shift;
  const FrameFit after = fit_frame(site, scene, to_frame_time(site, scene, rolling, {free, fit.pose}, {1.0, run}));
  return after.ok ? std::max(0.0, fit.chi2_sum - after.chi2_sum) : 0.0;
}

}  // namespace moiregauge::internal
