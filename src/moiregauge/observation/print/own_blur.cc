// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/own_blur.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include <Eigen/LU>

#include "moiregauge/observation/print/print_origin.h"
#include "moiregauge/observation/print/print_pixels.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Complex = std::complex<double>;

// Residual relative to the reference frame's, from which on the blur may differ. A turn to 8 deg gives 1.1. Chosen.
constexpr double kOtherResidual = 1.3;
// Least share of the residual beyond noise that the second order of a change of blur explains. In blurred and refocused
// frames it is 0.11 and more, behind H.264 at most 0.07. Chosen.
constexpr double kBlurShare = 0.09;
// Largest residual of the new fit, relative to the first one. A template of its own lowers the residual of the same
// blur by 2 %, because it also fits the noise. Chosen.
constexpr double kExplains = 0.8;
// A new template absorbs a share of the map's errors. Each round leaves 1 / n^2 of a wrong scale over n periods.
constexpr int kRounds = 2;
constexpr double kFarOff = 0.1;     // pitches: largest shift between both templates. Chosen.
constexpr double kMinSignal = 3.0;  // amplitude of a harmonic that counts, in u; chosen
// Highest orders of the harmonics that are used in turn. A phase modulo pi is unique if the shift is known to a
// quarter of the harmonic's period: 0.1 pitch for two periods. Three harmonics then know it much better.
constexpr std::array kOrders{2, 3, 5, 8, 1 << 20};

struct Phase {
  double m = 0.0, n = 0.0;  // order along both axes
  double angle = 0.0;       // rad, -pi/2 to pi/2
  double variance = 0.0;    // rad^2
};

double variance_of(const TemplateNoise& noise) { return 0.5 * noise.sigma * noise.sigma / noise.pixels; }

// Appends the phases of one half of the plane, because the series is real.
std::vector<Phase> phases_of(const PrintSeries& then, double variance_then, const PrintSeries& now, double variance_now,
                             const PatchFitOptions& options) {
  std::vector<Phase> all;
  const int order = std::min(then.order(), now.order());
  const double least = kMinSignal * kMinSignal;
  for (int n = 0; n <= order; ++n) {
    for (int m = n == 0 ? 1 : -order; m <= order; ++m) {
      if ((!options.along_x && m != 0) || (!options.along_y && n != 0)) continue;
      const Complex c = then.coefficient(m, n), d = now.coefficient(m, n);
      if (std::norm(c) < least * variance_then || std::norm(d) < least * variance_now) continue;
      const Complex ratio = d * std::conj(c);
      all.push_back(
          {double(m), double(n), std::arg(ratio), variance_then / std::norm(c) + variance_now / std::norm(d)});
    }
  }
  return all;
}

// Returns the angle's distance from the nearest multiple of pi.
double modulo_pi(double angle) { return angle - kPi * std::round(angle / kPi); }

TemplateNoise noise_of(const PatchFit& fit, double contrast) {
  return {fit.sigma / contrast, static_cast<double>(fit.pixels)};
}

// Returns the share of the pixels' degrees of freedom that the template leaves.
double share_left(const PrintSeries& print, int pixels) {
  const double side = 2.0 * print.order() + 1.0;
  return std::max(0.1, 1.0 - side * side / pixels);
}

// Returns the factor by which phases that disagree enlarge the variance of a common shift. The worse axis counts.
double enlargement(const TemplateShift& shift, const PatchFit& fit, const PatchFitOptions& options) {
  if (!(shift.chi2_dof > 1.0)) return 1.0;
  double largest = 0.0;
  for (const int axis : {0, 1}) {
    if (axis == 0 ? !options.along_x : !options.along_y) continue;
    const double own =
        fit.information.block<kPatchPoints, kPatchPoints>(axis * kPatchPoints, axis * kPatchPoints).sum();
    largest = std::max(largest, own / shift.information(axis, axis));
  }
  return 1.0 + (shift.chi2_dof - 1.0) * largest;
}

double change_of(const PrintSeries& now, const PrintSeries& then, int m, int n) {
  const double before = std::norm(then.coefficient(m, n));
  return before > 0.0 ? (now.coefficient(m, n) * std::conj(then.coefficient(m, n))).real() / before : 1.0;
}

double squared(double v) { return v * v; }

// Returns what the fit of the linear change of blur leaves, grey levels^2. A blur multiplies a harmonic (m, n) by exp(-e)
// with e = 4 pi^2 (hx m^2 + hy n^2). The fit takes the part that is linear in e, and e^2 / 2 is the next one.
double left_by_blur2(const PrintSeries& print, const PatchFit& fit) {
  const double along_x = 1.0 - fit.fundamental[0] / fit.gain[0], along_y = 1.0 - fit.fundamental[1] / fit.gain[0];
  double sum = 0.0;
  for (int n = -print.order(); n <= print.order(); ++n) {
    for (int m = -print.order(); m <= print.order(); ++m) {
      const double e = along_x * m * m + along_y * n * n;
      sum += std::norm(print.coefficient(m, n)) * squared(0.5 * e * e);
    }
  }
  return squared(fit.gain[0]) * sum;
}

// Returns true if the codec may have left the residual and the blur has not. A template of the frame would only fit the
// codec's errors.
bool is_left_by_codec(const PrintSeries& print, const PatchFit& at_rest, const PatchFit& fit, double rounding) {
  const double beyond_noise2 = squared(fit.sigma) - squared(at_rest.sigma);
  return beyond_noise2 < squared(rounding) && left_by_blur2(print, fit) < squared(kBlurShare) * beyond_noise2;
}

// Makes one round from the fit of the last one: a template of this frame, its shift, and its fit.
std::optional<PatchFit> fit_with_new_template(const LumaView& luma, const PrintModel& model, const PatchFit& at_rest,
                                              const PatchFit& last) {
  const PrintFromImage map = map_of(last, model.window);
  PrintBins bins(model.print.order());
  std::visit([&](const auto& picture) { gather_grey(picture, map, model.window, &last, bins); }, luma);
  const auto learned = bins.fit(&model.print);
  if (!learned) return std::nullopt;
  const auto shift = shift_by_phases(model.print, noise_of(at_rest, at_rest.gain[0]), *learned,
                                     noise_of(at_rest, last.gain[0]), model.options);
  if (!shift) return std::nullopt;
  const PrintTemplate moved(with_origin(*learned, {-shift->at.x, -shift->at.y}));
  auto fitted = fit_patch(luma, map, {model.window, moved, model.options});
  if (!fitted) return std::nullopt;
  PatchFit fit = std::move(fitted->fit);
  const double left = share_left(moved, fit.pixels);
  fit.sigma /= std::sqrt(left);
  fit.information *= left / enlargement(*shift, fit, model.options);
  fit.fundamental[0] *= change_of(moved, model.print, 1, 0), fit.fundamental[1] *= change_of(moved, model.print, 0, 1);
  return fit;
}

}  // namespace

std::optional<TemplateShift> shift_by_phases(const PrintSeries& then, const TemplateNoise& noise_then,
                                             const PrintSeries& now, const TemplateNoise& noise_now,
                                             const PatchFitOptions& options) {
  const auto phases = phases_of(then, variance_of(noise_then), now, variance_of(noise_now), options);
  TemplateShift shift;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  int count = 0;
  for (const int most : kOrders) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double chi2 = 0.0;
    count = 0;
    for (const Phase& phase : phases) {
      if (std::max(std::abs(phase.m), std::abs(phase.n)) > most) continue;
      const Eigen::Vector2d slope(kTwoPi * phase.m, kTwoPi * phase.n);
      const double off = modulo_pi(phase.angle - slope.dot(at));
      normal += slope * slope.transpose() / phase.variance;
      right += slope * off / phase.variance;
      chi2 += off * off / phase.variance;
      ++count;
    }
    shift.information = normal;
    if (!options.along_x) normal(0, 0) = 1.0;
    if (!options.along_y) normal(1, 1) = 1.0;
    if (!(normal.determinant() > 0.0)) return std::nullopt;
    const Eigen::Vector2d step = normal.inverse() * right;
    at += step;
    if (!(at.cwiseAbs().maxCoeff() < kFarOff)) return std::nullopt;
    shift.chi2_dof = count > 2 ? (chi2 - step.dot(right)) / (count - 2) : 1.0;
  }
  shift.at = {at(0), at(1)};
  return shift;
}

std::optional<PatchFit> fit_in_own_blur(const LumaView& luma, const PrintModel& model, const PatchFit& at_rest,
                                        const PatchFit& fit, double rounding) {
  if (model.print.order() < 2 || !(fit.sigma > kOtherResidual * at_rest.sigma) || !(at_rest.sigma > 0.0))
    return std::nullopt;
  if (is_left_by_codec(model.print, at_rest, fit, rounding)) return std::nullopt;
  std::optional<PatchFit> better = fit;
  for (int round = 0; round < kRounds && better; ++round) better = fit_with_new_template(luma, model, at_rest, *better);
  return better && better->sigma < kExplains * fit.sigma ? better : std::nullopt;
}

}  // namespace moiregauge::internal
