// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/simulator.h"

#include <algorithm>
#include <utility>

#include "moiregauge/simulator/rendering/projection.h"

namespace moiregauge::internal::simulator {

LumaView view_of(const Picture& picture) {
  return std::visit([](const auto& image) { return LumaView(image.view()); }, picture);
}

ImagePoint project(const Scenario& scenario, long frame, const SceneMarker& marker, BoardPoint point) {
  const Matrix3 seen = camera_from_print(scenario, marker, time_of(scenario, frame));
  return image_of(scenario.camera, ray_of(seen, point));
}

ImagePoint project(const Scenario& scenario, long frame, BoardPoint point) {
  return project(scenario, frame, SceneMarker{}, point);
}

Truth truth(const Scenario& scenario, long frame, const SceneMarker& marker) {
  const double half = 0.5 * scenario.sensor.exposure_s, now = time_of(scenario, frame), then = time_of(scenario, 0);
  return {marker.dx.mean(now - half, now + half) - marker.dx.mean(then - half, then + half),
          marker.dy.mean(now - half, now + half) - marker.dy.mean(then - half, then + half)};
}

namespace {

void mirror(Marker& marker) {
  if (marker.circle) marker.circle->centre.x = -marker.circle->centre.x;
  if (!marker.grating) return;
  marker.grating->centre.x = -marker.grating->centre.x;
  marker.grating->angle_rad = -marker.grating->angle_rad;
}

// Exchanges two markers, except their names and roles.
void exchange(Site& site, const std::string& name_a, const std::string& name_b) {
  Marker *a = nullptr, *b = nullptr;
  for (Marker& marker : site.markers) {
    if (marker.name == name_a) a = &marker;
    if (marker.name == name_b) b = &marker;
  }
  if (a == nullptr || b == nullptr) return;
  std::swap(a->circle, b->circle);
  std::swap(a->grating, b->grating);
  std::swap(a->z_mm, b->z_mm);
}

}  // namespace

Site site_of(const Scenario& scenario) {
  Site site;
  for (const SceneMarker& marker : scenario.markers) {
    if (marker.listed) site.markers.push_back(marker.print);
  }
  site.known_to = scenario.known_to;
  for (const auto& [a, b] : scenario.site_errors.exchanged) exchange(site, a, b);
  if (scenario.site_errors.mirrored) std::for_each(site.markers.begin(), site.markers.end(), mirror);
  std::stable_sort(site.markers.begin(), site.markers.end(), [](const Marker& a, const Marker& b) {
    return a.role == Role::kReference && b.role == Role::kTarget;
  });
  return site;
}

const SceneMarker* find_marker(const Scenario& scenario, const std::string& name) {
  for (const SceneMarker& marker : scenario.markers) {
    if (marker.print.name == name) return &marker;
  }
  return nullptr;
}

}  // namespace moiregauge::internal::simulator
