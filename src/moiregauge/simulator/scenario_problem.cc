// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "moiregauge/simulator/settings.h"

namespace moiregauge::simulator {
namespace {

std::optional<std::string> problem_with_sensor(const Scenario& s) {
  const auto& [psf, sigma, gain, bits, fps, exposure] = s.sensor;
  if (s.camera.width < 16 || s.camera.height < 16 || s.camera.width > 20000 || s.camera.height > 20000) {
    return fmt::format("a picture of {}x{} px: width and height must lie in 16 to 20000", s.camera.width,
                       s.camera.height);
  }
  if (!(s.camera.fx > 0.0 && s.camera.fy > 0.0)) return "camera.fx and camera.fy must be greater than 0";
  if (!(s.mount.distance_mm > 0.0)) return "mount.distance_mm must be greater than 0";
  if (bits != 8 && bits != 10 && bits != 12) return fmt::format("sensor.bits is {}: it must be 8, 10 or 12", bits);
  if (!(fps > 0.0)) return "sensor.fps must be greater than 0";
  if (exposure < 0.0 || exposure > 1.0 / fps) {
    return fmt::format("sensor.exposure_s is {}: it must lie in 0 to 1 / fps = {}", exposure, 1.0 / fps);
  }
  if (psf < 0.0 || psf > 20.0) return "sensor.psf_sigma_px must lie in 0 to 20";
  if (sigma < 0.0 || gain < 0.0) return "noise.sigma and noise.gain must not be negative";
  if (s.frames < 1 || s.frames > 1000000) return "frames must lie in 1 to 1000000";
  if (s.decoys > 10000) return "decoys must not be more than 10000";
  return std::nullopt;
}

std::optional<std::string> problem_with_marker(const SceneMarker& marker) {
  const Marker& print = marker.print;
  if (!print.circle && !print.grating) return fmt::format("marker {} needs a circle, a grating, or both", print.name);
  if (print.circle && !(print.circle->diameter_mm > 0.0)) {
    return fmt::format("marker {}: circle_diameter_mm must be greater than 0", print.name);
  }
  if (!print.grating) return std::nullopt;
  const Grating& grating = *print.grating;
  if (!(grating.pitch_mm > 0.0)) return fmt::format("marker {}: pitch_mm must be greater than 0", print.name);
  if (!(grating.width_mm > 0.0 && grating.height_mm > 0.0)) {
    return fmt::format("marker {}: grating_size_mm must be two numbers greater than 0", print.name);
  }
  if (std::max(grating.width_mm, grating.height_mm) > 10000.0 * grating.pitch_mm) {
    return fmt::format("marker {}: more than 10000 lines", print.name);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> problem_with(const Scenario& scenario) {
  if (const auto problem = problem_with_sensor(scenario)) return problem;
  if (scenario.markers.empty()) return "there is no marker to be seen";
  std::set<std::string> names;
  for (const SceneMarker& marker : scenario.markers) {
    if (const auto problem = problem_with_marker(marker)) return problem;
    if (!names.insert(marker.print.name).second) return fmt::format("two markers are called {}", marker.print.name);
  }
  return std::nullopt;
}

}  // namespace moiregauge::simulator
