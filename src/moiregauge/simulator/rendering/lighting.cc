// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/lighting.h"

#include <cmath>
#include <cstddef>

#include "moiregauge/simulator/rendering/projection.h"

namespace moiregauge::internal::simulator {

Lighting::Lighting(const Scenario& scenario, long frame)
    : vignetting_(scenario.light.vignetting),
      slope_x_(scenario.light.slope_x.at(time_of(scenario, frame))),
      slope_y_(scenario.light.slope_y.at(time_of(scenario, frame))),
      middle_x_(0.5 * (scenario.camera.width - 1)),
      middle_y_(0.5 * (scenario.camera.height - 1)),
      corner2_(middle_x_ * middle_x_ + middle_y_ * middle_y_) {
  const bool by_row = scenario.sensor.exposes_row_by_row();
  const double half = 0.5 * scenario.sensor.exposure_s;
  for (int y = 0; y < (by_row ? scenario.camera.height : 1); ++y) {
    const double now = time_of(scenario, frame) + (by_row ? delay_of_row(scenario, y) : 0.0);
    brightness_.push_back(1.0 + scenario.light.flicker.mean(now - half, now + half));
  }
  find_spots(scenario, frame);
}

// Places the spots at the middle of the exposure. A spot is many times wider than its movement during the exposure.
void Lighting::find_spots(const Scenario& scenario, long frame) {
  const double now = time_of(scenario, frame);
  for (const SceneMarker& marker : scenario.markers) {
    const Glare& glare = marker.glare;
    const double grey = glare.grey.at(now);
    if (grey == 0.0) continue;
    const Matrix3 seen = camera_from_print(scenario, marker, now);
    const BoardPoint centre = centre_of(marker.print),
                     spot{centre.x + glare.x_mm.at(now), centre.y + glare.y_mm.at(now)};
    const ImagePoint p = image_of(scenario.camera, ray_of(seen, spot));
    const double distance_mm = product(seen, Vector3{spot.x, spot.y, 1.0})[2];
    const double blur = std::hypot(scenario.sensor.psf_sigma_px, scenario.sensor.defocus_px.at(now));
    spots_.push_back({p.x, p.y, std::hypot(glare.sigma_mm * scenario.camera.fx / distance_mm, blur), grey});
  }
}

double Lighting::share_at(int x, int y) const {
  const double dx = x - middle_x_, dy = y - middle_y_;
  return (1.0 - vignetting_ * (dx * dx + dy * dy) / corner2_) *
         (1.0 + slope_x_ * dx / middle_x_ + slope_y_ * dy / middle_y_);
}

void Lighting::fall_on(int y, int from, int to, std::span<double> row) const {
  const double brightness = brightness_of(y);
  for (int x = from; x < to; ++x) row[static_cast<std::size_t>(x)] *= share_at(x, y) * brightness;
  for (const Spot& spot : spots_) {
    const double half = 0.5 / (spot.sigma * spot.sigma), v = y - spot.y;
    for (int x = from; x < to; ++x) {
      const double u = x - spot.x;
      row[static_cast<std::size_t>(x)] += spot.grey * std::exp(-half * (u * u + v * v));
    }
  }
}

}  // namespace moiregauge::internal::simulator
