// SPDX-License-Identifier: Apache-2.0
// Projection of the scene, and its residual: nine points of a grating against the nine pixels that show them. The
// program uses closed-form derivatives. A version for any number type checks them with Ceres' dual numbers.
#pragma once

#include <array>

#include <Eigen/Core>

#include "moiregauge/calibration/scene/scene.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Rotates v by the rotation vector `turn`, rad (Rodrigues' formula, to first order near zero).
template <typename T>
std::array<T, 3> turned_by(const T* turn, const std::array<T, 3>& v) {
  using std::cos, std::sin, std::sqrt;
  const T angle2 = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2];
  const std::array<T, 3> cross{turn[1] * v[2] - turn[2] * v[1], turn[2] * v[0] - turn[0] * v[2],
                               turn[0] * v[1] - turn[1] * v[0]};
  if (!(angle2 > T(1e-24))) return {v[0] + cross[0], v[1] + cross[1], v[2] + cross[2]};
  const T angle = sqrt(angle2), c = cos(angle), s = sin(angle) / angle;
  const T along = (turn[0] * v[0] + turn[1] * v[1] + turn[2] * v[2]) * (T(1.0) - c) / angle2;
  return {v[0] * c + cross[0] * s + turn[0] * along, v[1] * c + cross[1] * s + turn[1] * along,
          v[2] * c + cross[2] * s + turn[2] * along};
}

// Returns the image (px) of a point in camera coordinates (mm), by OpenCV's lens model. `camera` starts with f cx cy k1
// k2 p1 p2 k3.
template <typename T>
std::array<T, 2> image_of(const T* camera, const std::array<T, 3>& point) {
  const T x = point[0] / point[2], y = point[1] / point[2];
  const T r2 = x * x + y * y;
  const T radial = T(1.0) + r2 * (camera[3] + r2 * (camera[4] + r2 * camera[7]));
  const T xd = x * radial + T(2.0) * camera[5] * x * y + camera[6] * (r2 + T(2.0) * x * x);
  const T yd = y * radial + camera[5] * (r2 + T(2.0) * y * y) + T(2.0) * camera[6] * x * y;
  return {camera[0] * xd + camera[1], camera[0] * yd + camera[2]};
}

// Projects a board point (mm) to the image (px): pose, then lens.
template <typename T>
std::array<T, 2> projected(const T* camera, const T* pose, const std::array<T, 3>& board) {
  const auto p = turned_by(pose, {board[0], -board[1], -board[2]});
  return image_of(camera, {p[0] + pose[3], p[1] + pose[4], p[2] + pose[5]});
}

// Standard uncertainty of a target's movement along its lines, pitches. It only fixes the coordinate: the samples' u has
// the part of an unknown movement. Chosen.
inline constexpr double kStillAlongLines = 1e-3;

using CommonNumbers = std::array<double, kCommonParameters>;  // f cx cy k1 k2 p1 p2 k3, stretch
[[nodiscard]] CommonNumbers numbers_of(const Camera& camera, double stretch);
[[nodiscard]] CommonNumbers numbers_of(const Scene& scene);

// Returns the tilt of a print as a rotation vector on the board, rad.
[[nodiscard]] inline std::array<double, 3> tilt_of(const MarkerShape& shape) {
  return {shape.value[MarkerShape::kTiltX], shape.value[MarkerShape::kTiltY], 0.0};
}

// Rotation matrix of a pose, with its derivative: d(R v) = (left d turn) x R v.
struct TurnedPose {
  explicit TurnedPose(const Pose& pose);
  Eigen::Matrix3d rotation, left;
  Eigen::Vector3d shift;
};

// Columns of a grating's design matrix: derivatives of the whitened residual, then the residual itself. A shift has the
// columns of the position.
struct PatchColumn {
  static constexpr int kCommon = 0;
  static constexpr int kShape = kCommon + kCommonParameters;
  static constexpr int kPose = kShape + MarkerShape::kParameters;
  static constexpr int kResidual = kPose + 6;
  static constexpr int kColumns = kResidual + 1;
};

// Whitened residual of one grating in one frame. Its squared length is chi2. The degrees of freedom are the rank of the
// information. A target of lines has one more residual: its movement along the lines is zero within kStillAlongLines.
// Otherwise tiny errors of rotation and lens would move it along its lines by metres.
class PatchResidual {
 public:
  static constexpr int kSize = 2 * kPatchPoints;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Design = Eigen::Matrix<double, kSize, PatchColumn::kColumns>;
  PatchResidual(const PatchFit& fit, const Marker& marker);

  template <typename T>
  bool operator()(const T* common, const T* shape, const T* pose, const T* shift, T* residual) const {
    using std::cos, std::sin;
    const T angle = T(angle_rad_) + shape[MarkerShape::kRotation];
    const T scale = T(pitch_mm_) * (T(1.0) + shape[MarkerShape::kScale]);
    const T c = scale * cos(angle), s = scale * sin(angle), half = T(0.5) * common[kStretchParameter];
    const std::array<T, 3> tilt{shape[MarkerShape::kTiltX], shape[MarkerShape::kTiltY], T(0.0)};
    std::array<T, kSize> off;  // pitches
    for (std::size_t n = 0; n < kPatchPoints; ++n) {
      const T px = (T(1.0) + half) * print_[n].x, py = (T(1.0) - half) * print_[n].y;
      const auto from_centre = turned_by(tilt.data(), std::array<T, 3>{c * px - s * py, s * px + c * py, T(0.0)});
      const std::array<T, 3> board{T(x_mm_) + shape[MarkerShape::kX] + shift[0] + from_centre[0],
                                   T(y_mm_) + shape[MarkerShape::kY] + shift[1] + from_centre[1],
                                   shape[MarkerShape::kHeight] + from_centre[2]};
      const auto image = projected(common, pose, board);
      const T dx = image[0] - image_[n].x, dy = image[1] - image_[n].y;
      off[n] = pitches_per_px_[n](0, 0) * dx + pitches_per_px_[n](0, 1) * dy;
      off[kPatchPoints + n] = pitches_per_px_[n](1, 0) * dx + pitches_per_px_[n](1, 1) * dy;
    }
    for (int i = 0; i < kSize; ++i) {
      residual[i] = T(0.0);
      for (int j = is_upper_ ? i : 0; j < kSize; ++j) residual[i] += root_(i, j) * off[static_cast<std::size_t>(j)];
    }
    residual[kLinesRow] += T(along_lines_[0]) * (shape[0] + shift[0]) + T(along_lines_[1]) * (shape[1] + shift[1]);
    return true;
  }
  // Overload for a reference, which has no shift.
  template <typename T>
  bool operator()(const T* common, const T* shape, const T* pose, T* residual) const {
    const T still[2]{T(0.0), T(0.0)};
    return (*this)(common, shape, pose, still, residual);
  }

  // Columns that a frame's fit to a fixed scene needs: pose, shift and residual.
  struct FrameColumn {
    static constexpr int kPose = 0, kShift = 6, kResidual = 8, kColumns = 9;
  };
  using FrameDesign = Eigen::Matrix<double, kSize, FrameColumn::kColumns>;
  [[nodiscard]] FrameDesign frame_design(const CommonNumbers& common, const MarkerShape& shape, const TurnedPose& pose,
                                         Extent<frame::Board> shift) const;
  [[nodiscard]] Design design(const CommonNumbers& common, const MarkerShape& shape, const TurnedPose& pose,
                              Extent<frame::Board> shift) const;
  [[nodiscard]] Vector residual(const CommonNumbers& common, const MarkerShape& shape, const TurnedPose& pose,
                                Extent<frame::Board> shift) const;

  // Returns grating point n on the board: (X, Y, Z) in mm, as `projected` takes it.
  [[nodiscard]] std::array<double, 3> board(double stretch, const MarkerShape& shape, Extent<frame::Board> shift,
                                            std::size_t n) const;
  // Returns the residual's derivative by the projected position of point n, pitches/px.
  [[nodiscard]] const Eigen::Matrix2d& pitches_per_px(std::size_t n) const { return pitches_per_px_[n]; }

  // Returns the whitening matrix: root^T root is the information matrix.
  [[nodiscard]] const Eigen::Matrix<double, kSize, kSize>& root() const { return root_; }
  // Returns the degrees of freedom: the rank of the information.
  [[nodiscard]] int rank() const { return rank_; }

 private:
  struct Sheet;
  // Row of the residual along the lines. The information of lines has no part in it.
  static constexpr int kLinesRow = kSize - 1;
  // Returns the design matrix before it is whitened.
  [[nodiscard]] Design off(const CommonNumbers& common, const MarkerShape& shape, const TurnedPose& pose,
                           Extent<frame::Board> shift) const;
  // Sets root and rank for an information matrix without full rank.
  void find_root(const PatchInformation& information);
  // Returns root times `off`.
  template <int kWide>
  [[nodiscard]] Eigen::Matrix<double, kSize, kWide> whitened(const Eigen::Matrix<double, kSize, kWide>& off) const;
  // Returns the movement along the lines over its u.
  [[nodiscard]] double moved_along_lines(const MarkerShape& shape, Extent<frame::Board> shift) const;

  std::array<ImagePoint, kPatchPoints> image_;
  std::array<PrintPoint, kPatchPoints> print_;
  double x_mm_, y_mm_, angle_rad_, pitch_mm_;
  std::array<Eigen::Matrix2d, kPatchPoints> pitches_per_px_;
  Eigen::Matrix<double, kSize, kSize> root_;
  bool is_upper_ = false;  // the root is an upper triangle
  int rank_ = 0;
  // Direction of the lines, 1/mm: per u of the movement. Zero for other patterns and references.
  std::array<double, 2> along_lines_{};
};

}  // namespace moiregauge::internal
