// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/patch_of_points.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "moiregauge/observation/raster/noise.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Largest residual beyond noise of a whole grating, rms relative to the template's contrast. A hidden hundredth of the
// grating leaves as much. Chosen.
constexpr double kWholeContrast = 0.1;
// Smallest squared residual of a strip that is no grating, in units of the template's contrast squared. Paper deviates
// by at least the contrast, of which planes of light and contrast can absorb up to six tenths.
constexpr double kStripMisses = 0.1;

// Returns the points' positions on the board minus those of the site, as a plane about the grating's middle.
PrintMotion off_the_site(const Reference& reference, const View& view, std::size_t i, const PatchFit& fit) {
  const Grating& grating = *reference.site.markers[i].grating;
  const auto board_from_print = print_from_board(grating, {}).inverse() * reference.prints[i]->correction.inverse();
  const auto board_from_ideal = view.ideal_from_board.inverse();
  Eigen::Matrix<double, kPatchPoints, 3> plane;
  Eigen::Matrix<double, kPatchPoints, 2> off;
  for (int n = 0; n < kPatchPoints; ++n) {
    const auto k = static_cast<std::size_t>(n);
    const BoardPoint nominal = board_from_print(fit.print[k]);
    const BoardPoint seen = board_from_ideal(view.lens.undistort(fit.image[k]));
    plane.row(n) << 1.0, nominal.x - grating.centre.x, nominal.y - grating.centre.y;
    off.row(n) << seen.x - nominal.x, seen.y - nominal.y;
  }
  const Eigen::Matrix<double, 3, 2> c = (plane.transpose() * plane).ldlt().solve(plane.transpose() * off);
  return {{c(0, 0), c(0, 1)}, c.bottomRows<2>().transpose()};
}

// Returns u of a common shift of all nine points, pitches. 0 for an axis that is not shown.
double u_of_shift(const PatchInformation& information, int axis) {
  const double weight = information.block<kPatchPoints, kPatchPoints>(axis * kPatchPoints, axis * kPatchPoints).sum();
  return weight > 0.0 ? 1.0 / std::sqrt(weight) : 0.0;
}

}  // namespace

PrintMotion motion_of_points(const Reference& reference, const View& view, std::size_t i, const PatchFit& fit) {
  const PrintMotion now = off_the_site(reference, view, i, fit);
  const PrintMotion then = off_the_site(reference, reference.view, i, *reference.seen.markers[i].points);
  return {now.displacement - then.displacement, now.gradient - then.gradient};
}

PatchReading patch_of_points(const Reference& reference, std::size_t i, const PatchFit& fit, const PrintMotion& motion,
                             Extent<frame::Board> shift) {
  const RasterPlan& plan = reference.plans[i];
  const MarkerObservation& then = reference.seen.markers[i];
  PatchReading patch = then.patch;
  const auto along = raster_from_board(plan, motion.displacement - shift);
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  const Matrix2 turn = (Matrix2() << c, -s, s, c).finished();
  const Matrix2 bent = turn.transpose() * motion.gradient * turn;
  const double pitch_mm = reference.site.markers[i].grating->pitch_mm;
  for (std::size_t a = 0; a < 2; ++a) {
    patch.phase_rad[a] = wrapped(then.patch.phase_rad[a] - kTwoPi * along[a] / plan.pitch_mm);
    patch.u_phase_rad[a] = u_of_shift(fit.information, static_cast<int>(a)) * kTwoPi * pitch_mm / plan.pitch_mm;
    patch.modulation[a] *= fit.fundamental[a] / then.points->fundamental[a];
    for (std::size_t b = 0; b < 2; ++b)
      patch.gradient[a][b] += bent(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  }
  patch.noise_sigma = fit.sigma;
  patch.valid = true;
  return patch;
}

double clipped_share(const GreyPicture& picture, const PatchFit& fit) {
  const auto [left, right] =
      std::minmax_element(fit.image.begin(), fit.image.end(), [](auto p, auto q) { return p.x < q.x; });
  const auto [top, bottom] =
      std::minmax_element(fit.image.begin(), fit.image.end(), [](auto p, auto q) { return p.y < q.y; });
  const int x0 = static_cast<int>(left->x), y0 = static_cast<int>(top->y);
  return clipped_share(part_of(picture.luma, x0, y0, x0 + static_cast<int>(right->x - left->x),
                               y0 + static_cast<int>(bottom->y - top->y)),
                       picture.bits);
}

double missing_contrast(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model, double rounding) {
  const double usual = at_rest.sigma * at_rest.sigma + rounding * rounding;
  const double more = std::sqrt(std::max(0.0, points.sigma * points.sigma - usual));
  return more / (points.gain[0] * model.print.contrast());
}

bool is_whole(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model, double rounding) {
  return missing_contrast(points, at_rest, model, rounding) < kWholeContrast;
}

bool ends_with_print(const PatchFit& points, const PatchFit& at_rest, const PrintModel& model, double rounding) {
  if (!model.outline) return false;
  const double pitches = 2.0 * std::max(model.options.along_x ? model.window.half_x : 0.0,
                                        model.options.along_y ? model.window.half_y : 0.0);
  const double missing = missing_contrast(points, at_rest, model, rounding);
  return missing * missing < kStripMisses / pitches;
}

}  // namespace moiregauge::internal
