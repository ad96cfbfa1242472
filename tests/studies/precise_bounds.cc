// SPDX-License-Identifier: Apache-2.0
#include "studies/precise_bounds.h"

#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/planning/reference_weights.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::study {
namespace {

using Eigen::Matrix2d;
using simulator::Scenario;
using simulator::SceneMarker;

// Returns the standard deviation of noise and rounding in grey levels of 8 bits.
double noise_of(const Scenario& s) {
  return std::hypot(s.sensor.noise_sigma, std::ldexp(1.0, 8 - s.sensor.bits) / std::sqrt(12.0));
}

// Returns the map from mm on a marker's sheet to px, at the centre of its grating.
Matrix2d px_per_mm(const Scenario& s, long frame, const SceneMarker& marker) {
  const BoardPoint c = marker.print.grating->centre;
  const auto at = [&](double x, double y) { return project(s, frame, marker, {c.x + x, c.y + y}); };
  const auto along_x = at(0.5, 0) - at(-0.5, 0), along_y = at(0, 0.5) - at(0, -0.5);
  Matrix2d j;
  j << along_x.x, along_y.x, along_x.y, along_y.y;
  return j;
}

// Returns the amplitude, in grey levels, of the fundamental along one axis of a crossed grating. The pattern is a
// cosine of each axis, or lines of half a pitch.
double amplitude_of(const Scenario& s, const Grating& g, double blur_mm) {
  const double contrast = s.light.white - s.light.black;
  const double sharp = g.pattern == Pattern::kCosine ? 0.25 * contrast : contrast / kPi;
  return sharp * std::exp(-0.5 * std::pow(kTwoPi * blur_mm / g.pitch_mm, 2));
}

Matrix2d phase_covariance(const Scenario& s, long frame, const SceneMarker& marker) {
  const Grating& g = *marker.print.grating;
  const Matrix2d j = px_per_mm(s, frame, marker);
  const double pixels = g.width_mm * g.height_mm * std::abs(j.determinant());
  const double variance_px = s.sensor.psf_sigma_px * s.sensor.psf_sigma_px + 1.0 / 12.0;
  const Matrix2d blur = variance_px * (j.transpose() * j).inverse();  // mm^2
  const auto u = [&](double blur_mm2) {
    return g.pitch_mm / kTwoPi * phase_bound(noise_of(s), amplitude_of(s, g, std::sqrt(blur_mm2)), pixels);
  };
  const double x = u(blur(0, 0)), y = u(blur(1, 1));
  return Eigen::Vector2d(x * x, y * y).asDiagonal();
}

Matrix2d full_covariance(const Scenario& s, long frame, const SceneMarker& marker) {
  Scenario alone = s;
  alone.markers = {marker};
  alone.markers[0].cover.frames.clear();
  alone.markers[0].print.circle.reset();
  const double step = 0.01 * marker.print.grating->pitch_mm;
  const auto picture = [&](double x, double y) {
    Scenario moved = alone;
    moved.markers[0].place.x_mm += x;
    moved.markers[0].place.y_mm += y;
    return render_ideal(moved, frame, {0, simulator::Area::kMarkersOnly});
  };
  const auto right = picture(step, 0), left = picture(-step, 0), up = picture(0, step), down = picture(0, -step);
  Matrix2d information = Matrix2d::Zero();
  for (int y = 0; y < right.height(); ++y) {
    for (int x = 0; x < right.width(); ++x) {
      const Eigen::Vector2d d(right.at(x, y) - left.at(x, y), up.at(x, y) - down.at(x, y));
      information += d * d.transpose();
    }
  }
  information /= std::pow(2.0 * step * noise_of(s), 2);
  return information.inverse();
}

template <typename Covariance>
Extent<frame::Board> through_layout_um(const Scenario& s, long frame, const Covariance& covariance) {
  std::vector<BoardPoint> at;
  std::vector<const SceneMarker*> references;
  const SceneMarker* target = nullptr;
  for (const SceneMarker& m : s.markers) {
    if (m.print.role == Role::kTarget) {
      if (target == nullptr) target = &m;
      continue;
    }
    at.push_back(m.print.grating->centre);
    references.push_back(&m);
  }
  BoardPoint there = target->print.grating->centre;
  const auto moved = truth(s, frame, *target);
  there = {there.x + moved.dx_mm, there.y + moved.dy_mm};
  const std::vector<Matrix2> weights = reference_weights(at, there);
  Matrix2d sum = covariance(s, frame, *target);
  for (std::size_t i = 0; i < weights.size(); ++i)
    sum += weights[i] * covariance(s, frame, *references[i]) * weights[i].transpose();
  return {1000.0 * std::sqrt(sum(0, 0)), 1000.0 * std::sqrt(sum(1, 1))};
}

}  // namespace

Extent<frame::Board> phase_bound_um(const Scenario& scenario, long frame) {
  return through_layout_um(scenario, frame, phase_covariance);
}

Extent<frame::Board> full_bound_um(const Scenario& scenario, long frame) {
  return through_layout_um(scenario, frame, full_covariance);
}

}  // namespace moiregauge::internal::study
