// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/markers/grating_elements.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Dense>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

constexpr std::size_t kFewest = 3;   // dots inside an outline that say where the others are
constexpr double kInStep = 0.9;      // resultant length of their phases
constexpr double kBeyond = 6.0;      // pitches: so far the corner's lattice tells the step
constexpr double kStep = 0.2;        // pitches
constexpr double kOneElement = 0.2;  // relative difference of diameters
constexpr double kCautious = 0.5;    // pitches that a print may reach beyond its patch's outline

// Where p lies in the print, pitches, by the lattice at the nearest corner of the patch.
Eigen::Vector2d in_pitches(const SeenPatch& patch, ImagePoint p) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (length(p - patch.outline[i]) < length(p - patch.outline[nearest])) nearest = i;
  }
  const auto away = p - patch.outline[nearest];
  const auto& [kx, ky] = patch.k_corners[nearest];
  const Eigen::Vector2d corner(nearest == 1 || nearest == 2 ? patch.periods_x : 0.0,
                               nearest > 1 ? patch.periods_y : 0.0);
  return corner + Eigen::Vector2d(kx.x * away.x + kx.y * away.y, ky.x * away.x + ky.y * away.y);
}

// The dots of one grating.
class Elements {
 public:
  Elements(const SeenPatch& patch, std::span<const SeenCircle> circles) : patch_(patch) {
    std::vector<double> sizes;
    for (const SeenCircle& c : circles) {
      if (!holds(patch, c.centre)) continue;
      const Eigen::Vector2d s = in_pitches(patch, c.centre);
      x_ += std::polar(1.0, kTurn * s.x());
      y_ += std::polar(1.0, kTurn * s.y());
      sizes.push_back(c.diameter_px);
    }
    if (sizes.size() < kFewest) return;
    const auto n = static_cast<double>(sizes.size());
    round_ = std::abs(x_) > kInStep * n && std::abs(y_) > kInStep * n;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    size_px_ = *middle;
  }
  [[nodiscard]] bool hold(const SeenCircle& c) const {
    const double away = distance_px(patch_, c.centre) * std::hypot(patch_.k_x.x, patch_.k_x.y);
    if (away < kCautious) return true;
    if (!round_ || away > kBeyond || std::abs(std::log(c.diameter_px / size_px_)) > kOneElement) return false;
    const Eigen::Vector2d s = in_pitches(patch_, c.centre);
    const auto out_of_step = [](double at, std::complex<double> mean) {
      return std::abs(std::remainder(at - std::arg(mean) / kTurn, 1.0));
    };
    return out_of_step(s.x(), x_) < kStep && out_of_step(s.y(), y_) < kStep;
  }

 private:
  const SeenPatch& patch_;
  std::complex<double> x_, y_;
  double size_px_ = 1.0;
  bool round_ = false;
};

}  // namespace

std::vector<SeenCircle> without_elements(std::span<const SeenCircle> circles, std::span<const SeenPatch> patches) {
  std::vector<Elements> gratings;
  for (const SeenPatch& patch : patches) gratings.emplace_back(patch, circles);
  std::vector<SeenCircle> out;
  std::copy_if(circles.begin(), circles.end(), std::back_inserter(out), [&](const SeenCircle& c) {
    return std::none_of(gratings.begin(), gratings.end(), [&](const Elements& e) { return e.hold(c); });
  });
  return out;
}

}  // namespace moiregauge
