// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/patch_fit.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/phase/patch_moments.h"

namespace moiregauge {
namespace {

using Field = Eigen::Matrix<double, kFieldColumns, 1>;
using Vandermonde = Eigen::Matrix<double, kFieldColumns, kFieldColumns>;
using Failure = PatchFitFailure;

constexpr int kLeastPixelsPerUnknown = 4;

// The patch's own coordinates: u, v about -1 to 1 inside it.
struct Frame {
  double x0 = 0.0, y0 = 0.0, scale = 1.0;  // px
  [[nodiscard]] double u(double x) const { return (x - x0) / scale; }
  [[nodiscard]] double v(double y) const { return (y - y0) / scale; }
};

Field powers(double u, double v) {
  Field f;
  f << 1, u, u * u, v, v * u, v * u * u, v * v, v * v * u, v * v * u * u;
  return f;
}

// What one pass of the least squares corrects: map plus field, light and contrast.
struct Model {
  PrintFromImage map;
  Frame frame;
  Field dx = Field::Zero(), dy = Field::Zero();
  std::array<double, 3> gain{1.0, 0.0, 0.0};

  [[nodiscard]] PrintPoint at(double x, double y) const {
    const PrintPoint p = map({x, y});
    const Field f = powers(frame.u(x), frame.v(y));
    return {p.x + f.dot(dx), p.y + f.dot(dy)};
  }
};

template <typename Grey>
PatchMoments moments(const ImageView<Grey>& picture, const Model& model, const PatchWindow& w,
                     const PrintTemplate& print, const PixelBox& box, double offset) {
  PatchMoments sums;
  const Matrix3& h = model.map.matrix();
  for (int y = box.y0; y <= box.y1; ++y) {
    const double v = model.frame.v(y);
    // The field on this row is quadratic in u.
    std::array<double, 3> dx{}, dy{};
    for (int i = 0; i < 3; ++i) {
      dx[static_cast<std::size_t>(i)] = model.dx(i) + v * (model.dx(3 + i) + v * model.dx(6 + i));
      dy[static_cast<std::size_t>(i)] = model.dy(i) + v * (model.dy(3 + i) + v * model.dy(6 + i));
    }
    const auto row = picture.row(y);
    for (int x = box.x0; x <= box.x1; ++x) {
      const double u = model.frame.u(x);
      const double z = 1.0 / (h(2, 0) * x + h(2, 1) * y + h(2, 2));
      const double px = (h(0, 0) * x + h(0, 1) * y + h(0, 2)) * z + dx[0] + u * (dx[1] + u * dx[2]);
      const double py = (h(1, 0) * x + h(1, 1) * y + h(1, 2)) * z + dy[0] + u * (dy[1] + u * dy[2]);
      if (!(std::abs(px - w.centre.x) <= w.half_x && std::abs(py - w.centre.y) <= w.half_y)) continue;
      const PrintLevel t = print.at({px, py});
      const double gain = model.gain[0] + model.gain[1] * u + model.gain[2] * v;
      sums.add({u, static_cast<double>(row[static_cast<std::size_t>(x)]) - offset, t.t, gain * t.dx, gain * t.dy,
                gain * t.dxx, gain * t.dyy});
    }
    sums.end_row(v);
  }
  return sums;
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

template <typename Grey>
tl::expected<PatchFit, Failure> fit_in(const ImageView<Grey>& picture, const PrintFromImage& start,
                                       const PatchWindow& window, const PrintTemplate& print,
                                       const PatchFitOptions& options) {
  const auto image_from_print = start.inverse();
  const PixelBox box = box_round(image_from_print, window);
  if (box.x0 < 0 || box.y0 < 0 || box.x1 >= picture.width || box.y1 >= picture.height)
    return tl::unexpected(Failure::kOutsidePicture);
  PatchFit fit;
  fit.image = points_in(image_from_print, window);
  Model model{start,
              {0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), 0.5 * std::max(box.x1 - box.x0, box.y1 - box.y0)}};
  Vandermonde at_points;
  for (int n = 0; n < kPatchPoints; ++n) {
    const ImagePoint p = fit.image[static_cast<std::size_t>(n)];
    at_points.row(n) = powers(model.frame.u(p.x), model.frame.v(p.y)).transpose();
  }
  const double offset = static_cast<double>(picture.at((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2));
  Solution s;
  for (int pass = 0; pass < options.passes; ++pass) {
    const PatchMoments sums = moments(picture, model, window, print, box, offset);
    if (sums.pixels() < kLeastPixelsPerUnknown * kColumns) return tl::unexpected(Failure::kTooFewPixels);
    NormalMatrix n;
    NormalVector r;
    sums.write(n, r);
    s = solved(n, r, options);
    if (!s.ok || !(s.value(3) > 0.0)) return tl::unexpected(Failure::kNoPattern);
    // The slopes were taken with the last pass' contrast.
    const double contrast = model.gain[0] / s.value(3);
    const Field dx = contrast * s.value.segment<kFieldColumns>(kBaseColumns),
                dy = contrast * s.value.tail<kFieldColumns>();
    model.dx += dx;
    model.dy += dy;
    model.gain = {s.value(3), s.value(4), s.value(5)};
    fit.last_step = std::max((at_points * dx).cwiseAbs().maxCoeff(), (at_points * dy).cwiseAbs().maxCoeff());
    fit.middle = {model.frame.x0, model.frame.y0};
    fit.light = {s.value(0) + offset, s.value(1) / model.frame.scale, s.value(2) / model.frame.scale};
    fit.gain = {s.value(3), s.value(4) / model.frame.scale, s.value(5) / model.frame.scale};
    fit.pixels = sums.pixels();
    fit.sigma = std::sqrt(std::max(0.0, sums.grey_squared() - s.value.dot(r)) / (sums.pixels() - kColumns));
  }
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto i = static_cast<std::size_t>(n);
    fit.print[i] = model.at(fit.image[i].x, fit.image[i].y);
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

}  // namespace

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

tl::expected<PatchFit, PatchFitFailure> fit_patch(const LumaView& luma, const PrintFromImage& start,
                                                  const PatchWindow& window, const PrintTemplate& print,
                                                  const PatchFitOptions& options) {
  return std::visit([&](const auto& picture) { return fit_in(picture, start, window, print, options); }, luma);
}

}  // namespace moiregauge
