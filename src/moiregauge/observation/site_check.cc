// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/site_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "moiregauge/observation/reference.h"
#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

// The scale of the view along a direction of the board is no better than the circles' places: two of them, each known
// to u, a spacing s apart, tell it to sqrt(2) u / s.
class ScaleUncertainty {
 public:
  explicit ScaleUncertainty(const Reference& reference) : u_(reference.site.known_to.position_mm) {
    double x = 0.0, y = 0.0;
    const double n = static_cast<double>(reference.circles.size());
    for (const CirclePoint& c : reference.circles) x += c.board.x / n, y += c.board.y / n;
    for (const CirclePoint& c : reference.circles) {
      xx_ += 4.0 / n * (c.board.x - x) * (c.board.x - x);
      yy_ += 4.0 / n * (c.board.y - y) * (c.board.y - y);
    }
  }
  [[nodiscard]] double along(double angle_rad) const {
    if (!(xx_ > 0.0 && yy_ > 0.0)) return 0.0;
    return std::sqrt(2.0) * u_ * std::hypot(std::cos(angle_rad) / std::sqrt(xx_), std::sin(angle_rad) / std::sqrt(yy_));
  }

 private:
  double u_, xx_ = 0.0, yy_ = 0.0;  // squared spacings
};

// Beyond so many standard uncertainties it is the site that is wrong, not a place that was hardly known.
constexpr double kSure = 4.0;

// The pitch that the picture shows, by the scale of the circle spacing: the phase gradient beyond the nominal carrier.
// A displacement gradient g along its own axis means the print is stretched by g against the board. Of two axes the
// one with the better known spacing counts more.
std::optional<std::string> pitch_disagreement(const Reference& reference, std::size_t i) {
  const Marker& marker = reference.site.markers[i];
  const PatchReading& patch = reference.seen.markers[i].patch;
  const ScaleUncertainty scale(reference);
  double stretch = 0.0, weights = 0.0;
  for (std::size_t a = 0; a < 2; ++a) {
    if (std::isnan(patch.phase_rad[a]) || std::isnan(patch.gradient[a][a])) continue;
    const double u = std::hypot(scale.along(reference.plans[i].angle_rad + 0.5 * kPi * static_cast<double>(a)), 1e-6);
    stretch += patch.gradient[a][a] / (u * u);
    weights += 1.0 / (u * u);
  }
  if (weights == 0.0) return std::nullopt;
  stretch /= weights;
  const double allowed =
      std::max(marker.role == Role::kTarget ? kTargetTolerance : kSiteTolerance, kSure / std::sqrt(weights));
  // A region of a few pixels tells no scale: ask three times its noise, too.
  if (std::abs(stretch) <= allowed + 3.0 * patch.u_gradient || !std::isfinite(patch.u_gradient)) return std::nullopt;
  char text[240];
  std::snprintf(
      text, sizeof text,
      "pitch_mm = %.4g of marker '%s' disagrees with the spacing of the reference circles, by which it is %.4g mm",
      marker.grating->pitch_mm, marker.name.c_str(), marker.grating->pitch_mm * (1.0 + stretch));
  return text;
}

std::optional<std::string> diameter_disagreement(const Reference& reference, std::size_t i) {
  const Marker& marker = reference.site.markers[i];
  const auto& seen = reference.seen.markers[i].circle;
  if (!seen || !marker.circle || marker.circle->diameter_mm <= 0.0) return std::nullopt;
  const double mm_per_px = reference.view.mm_per_px(marker.circle->centre);
  const double difference_px = seen->diameter_px - marker.circle->diameter_mm / mm_per_px;
  if (std::abs(difference_px) <= kDiameterTolerance) return std::nullopt;
  const ScaleUncertainty scale(reference);
  const double u = 0.5 * std::hypot(scale.along(0.0), scale.along(0.5 * kPi));
  if (std::abs(difference_px) * mm_per_px <= std::max(kSiteTolerance, kSure * u) * marker.circle->diameter_mm)
    return std::nullopt;
  char text[240];
  std::snprintf(
      text, sizeof text,
      "circle_diameter_mm = %.4g of marker '%s' disagrees with the spacing of the reference circles, by which it "
      "is %.4g mm",
      marker.circle->diameter_mm, marker.name.c_str(), seen->diameter_px * mm_per_px);
  return text;
}

}  // namespace

std::optional<std::string> site_disagreement(const Reference& reference) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    if (marker.grating && reference.seen.markers[i].patch.valid) {
      if (auto text = pitch_disagreement(reference, i)) return text;
    }
    if (auto text = diameter_disagreement(reference, i)) return text;
  }
  return std::nullopt;
}

}  // namespace moiregauge
