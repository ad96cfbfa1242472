// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/scene/patch_residual.h"

#include <cmath>

#include <Eigen/Cholesky>

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

// Image of a point in camera coordinates, with its derivatives by the point and by the camera.
struct Projection {
  Vector2d image;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Matrix<double, 2, kCameraParameters> by_camera;
};

Projection projection(const CommonNumbers& c, const Vector3d& p) {
  const auto [f, cx, cy, k1, k2, p1, p2, k3, stretch] = c;
  const double w = 1.0 / p.z(), x = p.x() * w, y = p.y() * w, r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3));
  const double xx = r2 + 2.0 * x * x, xy = 2.0 * x * y, yy = r2 + 2.0 * y * y;
  const double xd = x * radial + p1 * xy + p2 * xx, yd = y * radial + p1 * yy + p2 * xy;
  const double xd_x = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x;
  const double yd_y = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  const double mixed = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
  Projection out;
  out.image = {f * xd + cx, f * yd + cy};
  out.by_point << xd_x, mixed, -(xd_x * x + mixed * y), mixed, yd_y, -(mixed * x + yd_y * y);
  out.by_point *= f * w;
  const double r4 = r2 * r2, r6 = r4 * r2;
  out.by_camera << xd, 1, 0, f * x * r2, f * x * r4, f * xy, f * xx, f * x * r6,  //
      yd, 0, 1, f * y * r2, f * y * r4, f * yy, f * xy, f * y * r6;
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

PatchResidual::Design PatchResidual::off(const CommonNumbers& common, const MarkerShape& shape, const TurnedPose& pose,
                                         Extent<frame::Board> shift) const {
  const double angle = angle_rad_ + shape.value[MarkerShape::kRotation], scale = 1.0 + shape.value[MarkerShape::kScale];
  const double half = 0.5 * common[kStretchParameter];
  const double c = pitch_mm_ * std::cos(angle), s = pitch_mm_ * std::sin(angle);
  const Vector3d centre(x_mm_ + shape.value[MarkerShape::kX] + shift.x, y_mm_ + shape.value[MarkerShape::kY] + shift.y,
                        shape.value[MarkerShape::kHeight]);
  const TurnedPose tilt({tilt_of(shape), {}});
  const Eigen::Matrix<double, 3, 2> axes = tilt.rotation.leftCols<2>();
  Design off;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    const double px = (1.0 + half) * print_[n].x, py = (1.0 - half) * print_[n].y;
    const double bx = c * px - s * py, by = s * px + c * py;
    const Vector3d from_centre = axes.lazyProduct(Vector2d(scale * bx, scale * by)), board = centre + from_centre;
    const Vector3d turned = pose.rotation * Vector3d(board.x(), -board.y(), -board.z());
    const Projection seen = projection(common, turned + pose.shift);
    const Eigen::Matrix<double, 2, 3> by_point = pitches_per_px_[n].lazyProduct(seen.by_point);
    Eigen::Matrix<double, 2, 3> by_board = by_point.lazyProduct(pose.rotation);  // derivatives by (X, -Y, -Z)
    by_board.rightCols<2>() *= -1.0;
    const Matrix2d by_print = by_board.lazyProduct(axes);
    Eigen::Matrix<double, 2, PatchColumn::kColumns> rows;
    rows.leftCols<kCameraParameters>() = pitches_per_px_[n].lazyProduct(seen.by_camera);
    const double ex = 0.5 * scale * print_[n].x, ey = -0.5 * scale * print_[n].y;  // by half the stretch
    rows.col(kStretchParameter) = (c * ex - s * ey) * by_print.col(0) + (s * ex + c * ey) * by_print.col(1);
    auto by_shape = rows.middleCols<MarkerShape::kParameters>(PatchColumn::kShape);
    by_shape.col(MarkerShape::kX) = by_board.col(0);
    by_shape.col(MarkerShape::kY) = by_board.col(1);
    by_shape.col(MarkerShape::kRotation) = scale * (bx * by_print.col(1) - by * by_print.col(0));
    by_shape.col(MarkerShape::kScale) = bx * by_print.col(0) + by * by_print.col(1);
    by_shape.col(MarkerShape::kHeight) = by_board.col(2);
    const Eigen::Matrix<double, 2, 3> by_tilt = by_board.lazyProduct(cross_with(from_centre));
    by_shape.middleCols<2>(MarkerShape::kTiltX) = -by_tilt.lazyProduct(tilt.left.leftCols<2>());
    const Eigen::Matrix<double, 2, 3> by_turn = by_point.lazyProduct(cross_with(turned));
    rows.middleCols<3>(PatchColumn::kPose) = -by_turn.lazyProduct(pose.left);
    rows.middleCols<3>(PatchColumn::kPose + 3) = by_point;
    rows.col(PatchColumn::kResidual) = pitches_per_px_[n] * (seen.image - Vector2d(image_[n].x, image_[n].y));
    off.row(static_cast<Eigen::Index>(n)) = rows.row(0);
    off.row(static_cast<Eigen::Index>(n) + kPatchPoints) = rows.row(1);
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

PatchResidual::Vector PatchResidual::residual(const CommonNumbers& common, const MarkerShape& shape, const Pose& pose,
                                              Extent<frame::Board> shift) const {
  const std::array<double, 6> place{pose.turn[0],  pose.turn[1],  pose.turn[2],
                                    pose.shift[0], pose.shift[1], pose.shift[2]};
  const std::array<double, 2> moved{shift.x, shift.y};
  Vector r;
  (*this)(common.data(), shape.value.data(), place.data(), moved.data(), r.data());
  return r;
}

double PatchResidual::chi2(const CommonNumbers& common, const MarkerShape& shape, const Pose& pose,
                           Extent<frame::Board> shift) const {
  return residual(common, shape, pose, shift).squaredNorm();
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
