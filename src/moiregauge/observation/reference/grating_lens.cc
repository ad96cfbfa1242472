// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/grating_lens.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {
namespace {

constexpr double kMostDistortion = 0.15;  // beyond it one radial term describes no lens; chosen
constexpr double kSureOfLens = 3.0;       // coverage factor from which the lens is used; chosen
constexpr std::size_t kMinGratings = 4;   // that show both axes
constexpr int kLensRounds = 4;            // Gauss-Newton steps: each reduces the error by the distortion
constexpr double kLensStep = 1e-3;        // change of k1 for its derivatives
constexpr double kPrintShear = 1e-3;      // u of a gradient by printer and paper; chosen
constexpr double kUnknownStretch = 0.1;   // prior of the common stretch; chosen

// LensUnknowns: stretch of all gratings along x and y, common shear, k1.
using LensUnknowns = Eigen::Vector4d;
enum LensUnknown { kStretchX, kStretchY, kShear, kLens };

// Gradients of one grating, each a sum over the unknowns.
struct LensRow {
  LensUnknowns by = LensUnknowns::Zero();
  double value = 0.0, u = 1.0;
};

struct LensGrating {
  Matrix2 gradient;
  BoardPoint centre;
  double angle_rad = 0.0, u = 0.0;
  bool is_target = false;
};

std::optional<View> view_through(const Reference& reference, double k1) {
  Camera lens{.width = reference.width, .height = reference.height};
  lens.fx = lens.fy = 0.5 * std::hypot(reference.width, reference.height);
  lens.cx = 0.5 * (reference.width - 1), lens.cy = 0.5 * (reference.height - 1);
  lens.k1 = k1;
  std::vector<CirclePoint> circles = reference.circles;
  for (CirclePoint& circle : circles) circle.ideal = lens.undistort({circle.ideal.x, circle.ideal.y});
  const auto ideal_from_board = fit_circles(circles);
  if (!ideal_from_board) return std::nullopt;
  return View{*ideal_from_board, lens};
}

std::vector<LensGrating> gratings_of(const Reference& reference, double u_scale) {
  std::vector<LensGrating> out;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const PatchReading& patch = reference.seen.markers[i].patch;
    if (!marker.grating || !patch.valid) continue;
    Matrix2 gradient;
    gradient << patch.gradient[0][0], patch.gradient[0][1], patch.gradient[1][0], patch.gradient[1][1];
    if (!gradient.allFinite() || !std::isfinite(patch.u_gradient)) continue;
    out.push_back({gradient, marker.grating->centre, reference.plans[i].angle_rad,
                   std::hypot(patch.u_gradient, u_scale, kPrintShear), marker.role != Role::kReference});
  }
  return out;
}

// Adds what one grating shows: size along x and y, and shear. A target shows the difference of its sizes.
void add_rows(const LensGrating& grating, const Matrix2& by_lens, const Matrix2& per_k1, std::vector<LensRow>& rows) {
  const Matrix2 left = grating.gradient - by_lens;
  const auto shear = [](const Matrix2& m) { return 0.5 * (m(0, 1) + m(1, 0)); };
  rows.push_back({{0.0, 0.0, 1.0, shear(per_k1)}, shear(left), grating.u});
  if (grating.is_target) {
    rows.push_back(
        {{1.0, -1.0, 0.0, per_k1(0, 0) - per_k1(1, 1)}, left(0, 0) - left(1, 1), std::sqrt(2.0) * grating.u});
    return;
  }
  rows.push_back({{1.0, 0.0, 0.0, per_k1(0, 0)}, left(0, 0), grating.u});
  rows.push_back({{0.0, 1.0, 0.0, per_k1(1, 1)}, left(1, 1), grating.u});
}

struct LensStep {
  double k1 = 0.0, u = 0.0;
};

// Returns the change of k1 by least squares. Its u is enlarged if the gratings do not agree.
LensStep lens_step(const std::vector<LensRow>& rows) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Identity() / (kUnknownStretch * kUnknownStretch);
  LensUnknowns right = LensUnknowns::Zero();
  for (const LensRow& row : rows) {
    normal += row.by * row.by.transpose() / (row.u * row.u);
    right += row.by * row.value / (row.u * row.u);
  }
  const Eigen::LDLT<Eigen::Matrix4d> root(normal);
  const LensUnknowns found = root.solve(right);
  double chi2 = 0.0;
  for (const LensRow& row : rows) chi2 += std::pow((row.value - row.by.dot(found)) / row.u, 2);
  const double unit = std::max(1.0, chi2 / (static_cast<double>(rows.size()) - 4.0));
  const LensUnknowns variance = root.solve(LensUnknowns(LensUnknowns::Unit(kLens)));
  return {found(kLens), std::sqrt(unit * variance(kLens))};
}

}  // namespace

Matrix2 gradient_by_lens(const Reference& reference, const View& through_lens, BoardPoint at, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Matrix2 axes;
  axes << c, -s, s, c;
  const double step = reference.view.mm_per_px(at);  // 1 px
  Matrix2 seen;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Extent<frame::Board> by{step * axes(0, k), step * axes(1, k)};
    const auto d = reference.view.board(through_lens(at + by)) - reference.view.board(through_lens(at + -1.0 * by));
    seen.col(k) << d.x / (2.0 * step), d.y / (2.0 * step);
  }
  // The raster of the reading is regular as seen, so the gradient is by the seen position.
  return Matrix2::Identity() - (axes.transpose() * seen).inverse();
}

std::optional<GratingLens> lens_from_gratings(const Reference& reference, double u_scale) {
  if (reference.knows_camera() || !reference.view.lens.is_distortion_free()) return std::nullopt;
  const auto gratings = gratings_of(reference, u_scale);
  if (gratings.size() < kMinGratings) return std::nullopt;
  LensStep step;
  double k1 = 0.0;
  for (int round = 0; round < kLensRounds; ++round) {
    const auto here = view_through(reference, k1), next = view_through(reference, k1 + kLensStep);
    if (!here || !next) return std::nullopt;
    std::vector<LensRow> rows;
    for (const LensGrating& grating : gratings) {
      const Matrix2 by_lens = gradient_by_lens(reference, *here, grating.centre, grating.angle_rad);
      const Matrix2 then = gradient_by_lens(reference, *next, grating.centre, grating.angle_rad);
      add_rows(grating, by_lens, (then - by_lens) / kLensStep, rows);
    }
    step = lens_step(rows);
    k1 += step.k1;
    if (!(std::abs(k1) < kMostDistortion)) return std::nullopt;
  }
  const auto view = view_through(reference, k1);
  if (!view || !(std::abs(k1) > kSureOfLens * step.u)) return std::nullopt;
  return GratingLens{*view, step.u};
}

}  // namespace moiregauge::internal
