// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_fit.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/phase/patch_moments.h"
#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

using Field = Eigen::Matrix<double, kFieldColumns, 1>;
using Vandermonde = Eigen::Matrix<double, kFieldColumns, kFieldColumns>;
using Failure = PatchFitFailure;

constexpr int kLeastPixelsPerUnknown = 4;
// A fit whose last pass still moves a point by this much (pitches) has found nothing to hold on to.
constexpr double kStillMoving = 0.1;
// Of noise, each of the print's columns explains one sigma^2, give or take a third.
constexpr double kSeenPattern = 4.0;

Field powers(double u, double v) {
  Field f;
  f << 1, u, u * u, v, v * u, v * u * u, v * v, v * v * u, v * v * u * u;
  return f;
}

double u_of(const PatchMap& map, double x) { return (x - map.x0) / map.scale; }
double v_of(const PatchMap& map, double y) { return (y - map.y0) / map.scale; }

PrintPoint at(const PatchMap& map, ImagePoint at) {
  const PrintPoint p = map.map(at);
  const Field f = powers(u_of(map, at.x), v_of(map, at.y));
  return {p.x + f.dot(Eigen::Map<const Field>(map.dx.data())), p.y + f.dot(Eigen::Map<const Field>(map.dy.data()))};
}

// Least squares with the columns that the print shows; the others stay 0.
struct Solution {
  NormalVector value = NormalVector::Zero();
  Eigen::Matrix<double, 2 * kFieldColumns, 2 * kFieldColumns> information =
      Eigen::Matrix<double, 2 * kFieldColumns,
                    2 * kFieldColumns>::Zero();  // of the field, sigma = 1, the base eliminated
  bool ok = false;
};

// Relative. On a print of one harmonic more blur is less contrast: then contrast has it.
constexpr double kBlurRidge = 1e-4;

Solution solved(NormalMatrix n, NormalVector r, const PatchFitOptions& options) {
  const double slopes = n(0, 0) + n(3, 3);
  for (int i = kLightColumns; i < kBaseColumns; ++i) n(i, i) = n(i, i) * (1.0 + kBlurRidge) + 1e-12 * slopes;
  const auto silence = [&](int first) {  // a column that is not there: unit diagonal, nothing else
    for (int i = first; i < first + kFieldColumns; ++i) {
      n.row(i).setZero();
      n.col(i).setZero();
      n(i, i) = 1.0;
      r(i) = 0.0;
    }
  };
  if (!options.along_x) silence(kBaseColumns);
  if (!options.along_y) silence(kBaseColumns + kFieldColumns);
  // Columns of unit length, or the pivots would compare grey levels with slopes.
  const NormalVector length = n.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const NormalMatrix scaled = length.cwiseInverse().asDiagonal() * n * length.cwiseInverse().asDiagonal();
  const Eigen::LDLT<NormalMatrix> ldlt(scaled);
  Solution s;
  s.ok = ldlt.info() == Eigen::Success && ldlt.isPositive() && ldlt.vectorD().minCoeff() > 1e-9;
  if (!s.ok) return s;
  s.value = length.cwiseInverse().cwiseProduct(ldlt.solve(length.cwiseInverse().cwiseProduct(r)));
  const auto base = n.topLeftCorner<kBaseColumns, kBaseColumns>();
  const auto cross = n.topRightCorner<kBaseColumns, 2 * kFieldColumns>();
  s.information =
      n.bottomRightCorner<2 * kFieldColumns, 2 * kFieldColumns>() - cross.transpose() * base.ldlt().solve(cross);
  if (!options.along_x) {
    s.information.topRows<kFieldColumns>().setZero();
    s.information.leftCols<kFieldColumns>().setZero();
  }
  if (!options.along_y) {
    s.information.bottomRows<kFieldColumns>().setZero();
    s.information.rightCols<kFieldColumns>().setZero();
  }
  return s;
}

// The 3 x 3 points: two thirds of the way to the window's edge, where three points stand for a third of it each.
std::array<ImagePoint, kPatchPoints> points_in(const Homography<frame::Image, frame::Print>& image_from_print,
                                               const PatchWindow& w) {
  std::array<ImagePoint, kPatchPoints> points;
  for (int n = 0; n < kPatchPoints; ++n) {
    points[static_cast<std::size_t>(n)] = image_from_print(
        {w.centre.x + (n % 3 - 1) * 2.0 / 3.0 * w.half_x, w.centre.y + (n / 3 - 1) * 2.0 / 3.0 * w.half_y});
  }
  return points;
}

// What the columns of the print explain beyond a plane of light, each.
double explained(const NormalMatrix& n, const NormalVector& r, const Solution& s) {
  const Eigen::Matrix3d light = n.topLeftCorner<3, 3>();
  const Eigen::Vector3d of_light = r.head<3>();
  return (s.value.dot(r) - of_light.dot(light.ldlt().solve(of_light))) / (kColumns - 3);
}

// What the first pass takes off, so that single precision sees small numbers: the middle pixel will do.
double first_light(const LumaView& luma, const PixelBox& box) {
  const int x = (box.x0 + box.x1) / 2, y = (box.y0 + box.y1) / 2;
  return std::visit([x, y](const auto& picture) { return static_cast<double>(picture.at(x, y)); }, luma);
}

}  // namespace

tl::expected<PatchFit, Failure> fit_patch(const LumaView& luma, const PrintFromImage& start, const PatchWindow& window,
                                          const PrintTemplate& print, const PatchFitOptions& options) {
  const auto image_from_print = start.inverse();
  const PixelBox box = box_round(image_from_print, window);
  if (box.x0 < 0 || box.y0 < 0 || box.x1 >= width_of(luma) || box.y1 >= height_of(luma))
    return tl::unexpected(Failure::kOutsidePicture);
  PatchFit fit;
  fit.image = points_in(image_from_print, window);
  PatchMap model{start, 0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), 0.5 * std::max(box.x1 - box.x0, box.y1 - box.y0)};
  model.light[0] = first_light(luma, box);
  Vandermonde at_points;
  for (int n = 0; n < kPatchPoints; ++n) {
    const ImagePoint p = fit.image[static_cast<std::size_t>(n)];
    at_points.row(n) = powers(u_of(model, p.x), v_of(model, p.y)).transpose();
  }
  Solution s;
  for (int pass = 0; pass < options.passes; ++pass) {
    const bool is_last = pass + 1 == options.passes;
    const int step = is_last ? 1 : options.row_step;
    PatchSums sums;
    sum_patch(luma, model, window, print.nodes(), box, step, sums);
    if (step * sums.pixels() < kLeastPixelsPerUnknown * kColumns) return tl::unexpected(Failure::kTooFewPixels);
    NormalMatrix n;
    NormalVector r;
    normal_equations(sums, n, r);
    s = solved(n, r, options);
    for (std::size_t k = 0; s.ok && k < 3; ++k) {
      model.light[k] += s.value(static_cast<Eigen::Index>(k));
      model.contrast[k] += s.value(static_cast<Eigen::Index>(3 + k));
    }
    if (!s.ok || !(model.contrast[0] > 0.0)) return tl::unexpected(Failure::kNoPattern);
    // The slopes were taken with the last pass' contrast.
    const double contrast = model.gain[0] / model.contrast[0];
    const Field dx = contrast * s.value.segment<kFieldColumns>(kBaseColumns),
                dy = contrast * s.value.tail<kFieldColumns>();
    Eigen::Map<Field>(model.dx.data()) += dx;
    Eigen::Map<Field>(model.dy.data()) += dy;
    model.gain = model.contrast;
    fit.last_step = std::max((at_points * dx).cwiseAbs().maxCoeff(), (at_points * dy).cwiseAbs().maxCoeff());
    fit.pixels = sums.pixels();
    const double left = std::max(0.0, sums.moment(PatchProduct::kGrey2, 0, 0) - s.value.dot(r));
    fit.sigma = std::sqrt(left / (sums.pixels() - kColumns));
    if (pass == 0 && explained(n, r, s) < kSeenPattern * fit.sigma * fit.sigma) return tl::unexpected(Failure::kNoPattern);
  }
  if (!(fit.last_step < kStillMoving)) return tl::unexpected(Failure::kNoPattern);
  for (std::size_t a = 0; a < 2; ++a)
    fit.fundamental[a] = model.contrast[0] * (1.0 - kTurn * kTurn * s.value(kLightColumns + static_cast<Eigen::Index>(a)));
  fit.middle = {model.x0, model.y0};
  fit.light = {model.light[0], model.light[1] / model.scale, model.light[2] / model.scale};
  fit.gain = {model.contrast[0], model.contrast[1] / model.scale, model.contrast[2] / model.scale};
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto i = static_cast<std::size_t>(n);
    fit.print[i] = at(model, fit.image[i]);
  }
  const Vandermonde back = at_points.inverse();
  Eigen::Matrix<double, 2 * kFieldColumns, 2 * kFieldColumns> both =
      Eigen::Matrix<double, 2 * kFieldColumns, 2 * kFieldColumns>::Zero();
  both.topLeftCorner<kFieldColumns, kFieldColumns>() = back;
  both.bottomRightCorner<kFieldColumns, kFieldColumns>() = back;
  if (fit.sigma > 0.0) {  // symmetric to the last bit, so that one triangle tells it all
    const PatchInformation whole = both.transpose() * s.information * both / (fit.sigma * fit.sigma);
    fit.information = whole.selfadjointView<Eigen::Lower>();
  }
  return fit;
}

PixelBox box_round(const Homography<frame::Image, frame::Print>& image_from_print, const PatchWindow& w) {
  double x0 = 1e30, x1 = -1e30, y0 = 1e30, y1 = -1e30;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      const ImagePoint p = image_from_print({w.centre.x + sx * w.half_x, w.centre.y + sy * w.half_y});
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
  }
  constexpr double kFar = 1e6;
  const auto whole = [kFar](double v) { return static_cast<int>(std::clamp(v, -kFar, kFar)); };
  return {whole(std::floor(x0)) - 1, whole(std::floor(y0)) - 1, whole(std::ceil(x1)) + 1, whole(std::ceil(y1)) + 1};
}

}  // namespace moiregauge
