// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/patch_residual.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace moiregauge::internal {
namespace {

// Pivot of the information that is rounding only, relative to the largest. The curvature of a field has 1e-4.
constexpr double kRounding = 1e-12;

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Matrix3d cross_with(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

// Returns the derivative of grating coordinates by pixels at each of the nine points, pitches/px. The map X = (a x + b
// y + c) / (1 + g x + h y) is fitted to the points by linear least squares. It only scales residuals, so its own noise
// does not matter.
std::array<Matrix2d, kPatchPoints> print_per_image(const PatchFit& fit) {
  const ImagePoint middle = fit.image[kPatchPoints / 2];
  const double side = std::max(1e-300, length(fit.image.back() - fit.image.front()));
  std::array<Vector2d, kPatchPoints> at;
  // Sums over the points, with p = (x, y, 1) and q = (x, y): p p^T, u q p^T, v q p^T, (u^2 + v^2) q q^T.
  Matrix3d points = Matrix3d::Zero();
  Eigen::Matrix<double, 2, 3> by_u = Eigen::Matrix<double, 2, 3>::Zero(), by_v = by_u;
  Matrix2d by_both = Matrix2d::Zero();
  Eigen::Matrix<double, 8, 1> right = Eigen::Matrix<double, 8, 1>::Zero();
  const PrintPoint origin = fit.print[kPatchPoints / 2];
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const double x = (fit.image[n].x - middle.x) / side, y = (fit.image[n].y - middle.y) / side;
    const double u = fit.print[n].x - origin.x, v = fit.print[n].y - origin.y;
    at[n] = {x, y};
    const Vector3d p(x, y, 1.0);
    const Matrix3d pp = p * p.transpose();
    points += pp;
    by_u += u * pp.topRows<2>(), by_v += v * pp.topRows<2>();
    by_both += (u * u + v * v) * pp.topLeftCorner<2, 2>();
    right.head<3>() += u * p, right.segment<3>(3) += v * p;
    right.tail<2>() -= (u * u + v * v) * at[n];
  }
  Eigen::Matrix<double, 8, 8> normal = Eigen::Matrix<double, 8, 8>::Zero();
  normal.topLeftCorner<3, 3>() = normal.block<3, 3>(3, 3) = points;
  normal.block<2, 3>(6, 0) = -by_u, normal.block<2, 3>(6, 3) = -by_v;
  normal.block<3, 2>(0, 6) = -by_u.transpose(), normal.block<3, 2>(3, 6) = -by_v.transpose();
  normal.bottomRightCorner<2, 2>() = by_both;
  const Eigen::Matrix<double, 8, 1> h = normal.ldlt().solve(right);
  std::array<Matrix2d, kPatchPoints> out;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const double x = at[n].x(), y = at[n].y(), w = (1.0 + h(6) * x + h(7) * y);
    const double u = (h(0) * x + h(1) * y + h(2)) / w, v = (h(3) * x + h(4) * y + h(5)) / w;
    out[n] << h(0) - u * h(6), h(1) - u * h(7), h(3) - v * h(6), h(4) - v * h(7);
    out[n] /= w * side;
    if (!out[n].allFinite()) out[n].setZero();
  }
  return out;
}

// Returns the information without the coordinate along the lines. Runs of older versions have noise there.
PatchInformation across_lines(PatchInformation information, Pattern pattern) {
  const Eigen::Index along = pattern == Pattern::kLinesY ? 0 : kPatchPoints;
  information.middleRows<kPatchPoints>(along).setZero();
  information.middleCols<kPatchPoints>(along).setZero();
  return information;
}

// Image of a point in camera coordinates, with the derivatives of both its coordinates by the point and by the camera.
struct Projection {
  std::array<double, 2> image;
  std::array<Vector3d, 2> by_point;
  std::array<std::array<double, kCameraParameters>, 2> by_camera;
};

Projection projection(const CommonNumbers& c, const Vector3d& p) {
  const auto [f, cx, cy, k1, k2, p1, p2, k3, stretch] = c;
  const double w = 1.0 / p.z(), x = p.x() * w, y = p.y() * w, r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3));
  const double xx = r2 + 2.0 * x * x, xy = 2.0 * x * y, yy = r2 + 2.0 * y * y;
  const double xd = x * radial + p1 * xy + p2 * xx, yd = y * radial + p1 * yy + p2 * xy;
  const double per_mm = f * w;
  const double xd_x = per_mm * (radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x);
  const double yd_y = per_mm * (radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x);
  const double mixed = per_mm * (slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y);
  const double r4 = r2 * r2, r6 = r4 * r2;
  Projection out{{f * xd + cx, f * yd + cy}, {}, {}};
  out.by_point = {Vector3d(xd_x, mixed, -(xd_x * x + mixed * y)), Vector3d(mixed, yd_y, -(mixed * x + yd_y * y))};
  out.by_camera = {{{xd, 1, 0, f * x * r2, f * x * r4, f * xy, f * xx, f * x * r6},
                    {yd, 0, 1, f * y * r2, f * y * r4, f * yy, f * xy, f * y * r6}}};
  return out;
}

}  // namespace

CommonNumbers numbers_of(const Camera& c, double stretch) {
  return {c.fx, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, stretch};
}
CommonNumbers numbers_of(const Scene& scene) { return numbers_of(scene.camera, scene.stretch); }

TurnedPose::TurnedPose(const Pose& pose)
    : rotation(Matrix3d::Identity()), left(Matrix3d::Identity()), shift(pose.shift.data()) {
  const Vector3d turn(pose.turn.data());
  const double angle2 = turn.squaredNorm(), angle = std::sqrt(angle2);
  const Matrix3d k = cross_with(turn), kk = k * k;
  // Below 0.1 rad use the series of (1 - cos a) / a^2 and (a - sin a) / a^3: the differences cancel.
  const bool small = angle < 0.1;
  const double one_less_cos =
      small ? 0.5 - angle2 * (1.0 / 24 - angle2 * (1.0 / 720 - angle2 / 40320)) : (1.0 - std::cos(angle)) / angle2;
  const double less_sin = small ? 1.0 / 6 - angle2 * (1.0 / 120 - angle2 * (1.0 / 5040 - angle2 / 362880))
                                : (angle - std::sin(angle)) / (angle2 * angle);
  rotation += (1.0 - angle2 * less_sin) * k + one_less_cos * kk;
  left += one_less_cos * k + less_sin * kk;
}

PatchResidual::PatchResidual(const PatchFit& fit, const Marker& marker)
    : image_(fit.image),
      print_(fit.print),
      x_mm_(marker.grating->centre.x),
      y_mm_(marker.grating->centre.y),
      angle_rad_(marker.grating->angle_rad),
      pitch_mm_(marker.grating->pitch_mm),
      pitches_per_px_(print_per_image(fit)) {
  const auto lines = direction_of_lines(*marker.grating);
  const PatchInformation information = lines ? across_lines(fit.information, marker.grating->pattern) : fit.information;
  const Eigen::LLT<PatchInformation> llt(information);
  const auto pivots = llt.matrixLLT().diagonal();
  is_upper_ = llt.info() == Eigen::Success && pivots.minCoeff() > std::sqrt(kRounding) * pivots.maxCoeff();
  if (is_upper_) {
    root_ = llt.matrixU();
    rank_ = kSize;
  } else {
    find_root(information);
  }
  if (!lines || marker.role != Role::kTarget) return;
  const double per_u = 1.0 / (kStillAlongLines * pitch_mm_);
  along_lines_ = {per_u * lines->x, per_u * lines->y};
  ++rank_;
}

// Pivoting puts an axis that the grating does not show last, with zero weight.
void PatchResidual::find_root(const PatchInformation& information) {
  const Eigen::LDLT<PatchInformation> ldlt(information);
  PatchInformation upper = ldlt.matrixU();
  upper = ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal() * upper;
  rank_ = static_cast<int>((ldlt.vectorD().array() > kRounding * ldlt.vectorD().maxCoeff()).count());
  root_ = upper;
  const auto& swaps = ldlt.transpositionsP().indices();  // rows in this order, so columns in the opposite one
  for (Eigen::Index k = swaps.size(); k-- > 0;) root_.col(k).swap(root_.col(swaps(k)));
}

// Blocks of rows have a fixed size, so that the compiler unrolls them. Those of an upper triangle begin at the diagonal.
template <int kWide>
Eigen::Matrix<double, PatchResidual::kSize, kWide> PatchResidual::whitened(
    const Eigen::Matrix<double, kSize, kWide>& off) const {
  constexpr int kBlock = 6;
  static_assert(kSize % kBlock == 0);
  Eigen::Matrix<double, kSize, kWide> out;
  for (int column = 0; column < kWide; ++column) {
    for (int first = 0; first < kSize; first += kBlock) {
      Eigen::Matrix<double, kBlock, 1> sum = Eigen::Matrix<double, kBlock, 1>::Zero();
      for (int k = is_upper_ ? first : 0; k < kSize; ++k) sum += off(k, column) * root_.block<kBlock, 1>(first, k);
      out.template block<kBlock, 1>(first, column) = sum;
    }
  }
  return out;
}

// A print on the board.
struct PatchResidual::Sheet {
  Sheet(const PatchResidual& patch, const CommonNumbers& common, const MarkerShape& shape, Extent<frame::Board> shift)
      : half(0.5 * common[kStretchParameter]),
        scale(1.0 + shape.value[MarkerShape::kScale]),
        c(patch.pitch_mm_ * std::cos(patch.angle_rad_ + shape.value[MarkerShape::kRotation])),
        s(patch.pitch_mm_ * std::sin(patch.angle_rad_ + shape.value[MarkerShape::kRotation])),
        centre(patch.x_mm_ + shape.value[MarkerShape::kX] + shift.x,
               patch.y_mm_ + shape.value[MarkerShape::kY] + shift.y, shape.value[MarkerShape::kHeight]),
        tilt({tilt_of(shape), {}}) {}

  // Returns print coordinates (pitches) along the axes of an untilted board, mm.
  [[nodiscard]] Vector2d turned(double x, double y) const { return {c * x - s * y, s * x + c * y}; }
  [[nodiscard]] Vector2d turned(PrintPoint p) const { return turned((1.0 + half) * p.x, (1.0 - half) * p.y); }
  // Returns a point of the print, relative to its centre, mm.
  [[nodiscard]] Vector3d from_centre(const Vector2d& at) const {
    return scale * (at.x() * tilt.rotation.col(0) + at.y() * tilt.rotation.col(1));
  }

  double half, scale;  // half the stretch, relative pitch
  double c, s;         // mm per pitch
  Vector3d centre;     // mm
  TurnedPose tilt;
};

PatchResidual::Design PatchResidual::off(const CommonNumbers& common, const MarkerShape& shape, const TurnedPose& pose,
                                         Extent<frame::Board> shift) const {
  const Sheet sheet(*this, common, shape, shift);
  const Vector3d x_axis = sheet.tilt.rotation.col(0), y_axis = sheet.tilt.rotation.col(1);
  Design off;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const Vector2d at = sheet.turned(print_[n]);
    const Vector2d by_half = sheet.scale * sheet.turned(print_[n].x, -print_[n].y);
    const Vector3d from_centre = sheet.from_centre(at), board = sheet.centre + from_centre;
    const Vector3d turned = pose.rotation * Vector3d(board.x(), -board.y(), -board.z());
    const Projection seen = projection(common, turned + pose.shift);
    const Vector2d miss(seen.image[0] - image_[n].x, seen.image[1] - image_[n].y);
    for (const int axis : {0, 1}) {
      const double by_x = pitches_per_px_[n](axis, 0), by_y = pitches_per_px_[n](axis, 1);  // pitches/px
      auto row = off.row(static_cast<Eigen::Index>(n) + axis * kPatchPoints);
      for (std::size_t k = 0; k < kCameraParameters; ++k)
        row(static_cast<Eigen::Index>(k)) = by_x * seen.by_camera[0][k] + by_y * seen.by_camera[1][k];
      const Vector3d by_point = by_x * seen.by_point[0] + by_y * seen.by_point[1];
      Vector3d by_board = pose.rotation.transpose() * by_point;
      by_board.tail<2>() *= -1.0;  // the rotation has (X, -Y, -Z)
      const double by_print_x = by_board.dot(x_axis), by_print_y = by_board.dot(y_axis);
      // The derivative of a . (turn x b) by the turn is b x a.
      const Vector3d by_tilt = sheet.tilt.left.transpose() * from_centre.cross(by_board);
      const Vector3d by_turn = pose.left.transpose() * turned.cross(by_point);
      row(kStretchParameter) = 0.5 * (by_half.x() * by_print_x + by_half.y() * by_print_y);
      const auto of_shape = [&row](int k) -> double& { return row(PatchColumn::kShape + k); };
      of_shape(MarkerShape::kX) = by_board.x();
      of_shape(MarkerShape::kY) = by_board.y();
      of_shape(MarkerShape::kRotation) = sheet.scale * (at.x() * by_print_y - at.y() * by_print_x);
      of_shape(MarkerShape::kScale) = at.x() * by_print_x + at.y() * by_print_y;
      of_shape(MarkerShape::kHeight) = by_board.z();
      of_shape(MarkerShape::kTiltX) = by_tilt.x();
      of_shape(MarkerShape::kTiltY) = by_tilt.y();
      for (Eigen::Index k = 0; k < 3; ++k)
        row(PatchColumn::kPose + k) = by_turn(k), row(PatchColumn::kPose + 3 + k) = by_point(k);
      row(PatchColumn::kResidual) = by_x * miss.x() + by_y * miss.y();
    }
  }
  return off;
}

PatchResidual::Design PatchResidual::design(const CommonNumbers& common, const MarkerShape& shape,
                                            const TurnedPose& pose, Extent<frame::Board> shift) const {
  Design all = whitened(off(common, shape, pose, shift));
  const int place = PatchColumn::kShape + MarkerShape::kX;
  all(kLinesRow, place) += along_lines_[0], all(kLinesRow, place + 1) += along_lines_[1];
  all(kLinesRow, PatchColumn::kResidual) += moved_along_lines(shape, shift);
  return all;
}

double PatchResidual::moved_along_lines(const MarkerShape& shape, Extent<frame::Board> shift) const {
  return along_lines_[0] * (shape.value[MarkerShape::kX] + shift.x) +
         along_lines_[1] * (shape.value[MarkerShape::kY] + shift.y);
}

PatchResidual::FrameDesign PatchResidual::frame_design(const CommonNumbers& common, const MarkerShape& shape,
                                                       const TurnedPose& pose, Extent<frame::Board> shift) const {
  const Design all = off(common, shape, pose, shift);
  FrameDesign used;
  used << all.middleCols<6>(PatchColumn::kPose), all.middleCols<2>(PatchColumn::kShape + MarkerShape::kX),
      all.col(PatchColumn::kResidual);
  FrameDesign out = whitened(used);
  out(kLinesRow, FrameColumn::kShift) += along_lines_[0], out(kLinesRow, FrameColumn::kShift + 1) += along_lines_[1];
  out(kLinesRow, FrameColumn::kResidual) += moved_along_lines(shape, shift);
  return out;
}

PatchResidual::Vector PatchResidual::residual(const CommonNumbers& common, const MarkerShape& shape,
                                              const TurnedPose& pose, Extent<frame::Board> shift) const {
  const Sheet sheet(*this, common, shape, shift);
  Vector off;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const Vector3d board = sheet.centre + sheet.from_centre(sheet.turned(print_[n]));
    const Vector3d point = pose.rotation * Vector3d(board.x(), -board.y(), -board.z()) + pose.shift;
    const auto seen = image_of(common.data(), {point.x(), point.y(), point.z()});
    const double x = seen[0] - image_[n].x, y = seen[1] - image_[n].y;
    const auto row = static_cast<Eigen::Index>(n);
    off(row) = pitches_per_px_[n](0, 0) * x + pitches_per_px_[n](0, 1) * y;
    off(row + kPatchPoints) = pitches_per_px_[n](1, 0) * x + pitches_per_px_[n](1, 1) * y;
  }
  Vector out = whitened(off);
  out(kLinesRow) += moved_along_lines(shape, shift);
  return out;
}

std::array<double, 3> PatchResidual::board(double stretch, const MarkerShape& shape, Extent<frame::Board> shift,
                                           std::size_t n) const {
  const double angle = angle_rad_ + shape.value[MarkerShape::kRotation];
  const double pitch = pitch_mm_ * (1.0 + shape.value[MarkerShape::kScale]);
  const double c = pitch * std::cos(angle), s = pitch * std::sin(angle);
  const double px = (1.0 + 0.5 * stretch) * print_[n].x, py = (1.0 - 0.5 * stretch) * print_[n].y;
  const auto from_centre = turned_by(tilt_of(shape).data(), std::array{c * px - s * py, s * px + c * py, 0.0});
  return {x_mm_ + shape.value[MarkerShape::kX] + shift.x + from_centre[0],
          y_mm_ + shape.value[MarkerShape::kY] + shift.y + from_centre[1],
          shape.value[MarkerShape::kHeight] + from_centre[2]};
}

}  // namespace moiregauge::internal
