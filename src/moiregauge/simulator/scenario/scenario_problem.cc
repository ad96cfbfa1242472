// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "moiregauge/simulator/scenario/settings.h"

namespace moiregauge::internal::simulator {
namespace {

constexpr double kMaxBlurPx = 64.0;  // rendering time grows with the square of the blur; chosen

std::optional<std::string> problem_with_sensor(const Scenario& s) {
  const double psf = s.sensor.psf_sigma_px, sigma = s.sensor.noise_sigma, gain = s.sensor.noise_gain;
  const double fps = s.sensor.fps, exposure = s.sensor.exposure_s, readout = s.sensor.readout_s;
  const int bits = s.sensor.bits;
  if (s.camera.width < 16 || s.camera.height < 16 || s.camera.width > 20000 || s.camera.height > 20000) {
    return fmt::format("camera.width and camera.height must be 16 to 20000, not {}x{}", s.camera.width,
                       s.camera.height);
  }
  if (!(s.camera.fx > 0.0 && s.camera.fy > 0.0)) return "camera.fx and camera.fy must be greater than 0";
  if (!(s.mount.distance_mm > 0.0)) return "mount.distance_mm must be greater than 0";
  if (bits != 8 && bits != 10 && bits != 12) return fmt::format("sensor.bits must be 8, 10 or 12, not {}", bits);
  if (!(fps > 0.0)) return "sensor.fps must be greater than 0";
  if (exposure < 0.0 || exposure > 1.0 / fps) {
    return fmt::format("sensor.exposure_s must be 0 to 1 / fps = {1}, not {0}", exposure, 1.0 / fps);
  }
  if (readout < 0.0 || readout > 1.0 / fps) {
    return fmt::format("sensor.readout_s must be 0 to 1 / fps = {1}, not {0}", readout, 1.0 / fps);
  }
  if (psf < 0.0 || psf > 20.0) return "sensor.psf_sigma_px must be 0 to 20";
  if (sigma < 0.0 || gain < 0.0 || s.sensor.row_noise < 0.0)
    return "noise.sigma, noise.gain and noise.row must not be negative";
  if (!(s.sensor.gamma > 0.1 && s.sensor.gamma < 10.0)) return "sensor.gamma must be 0.1 to 10";
  if (!(s.sensor.defocus_px.limit() <= kMaxBlurPx && s.sensor.defocus_disc_px.limit() <= kMaxBlurPx))
    return fmt::format("sensor.defocus_px and sensor.defocus_disc_px must be {} at most", kMaxBlurPx);
  if (s.optics.focus_mm < 0.0 || s.optics.aperture_mm < 0.0)
    return "lens.focus_mm and lens.aperture_mm must not be negative";
  if (s.frames < 1 || s.frames > 1000000) return "frames must be 1 to 1000000";
  if (s.decoys > 10000) return "decoys must be 10000 at most";
  return std::nullopt;
}

std::optional<std::string> problem_with_processing(const Processing& p) {
  if (p.median_px != 0 && p.median_px != 3 && p.median_px != 5 && p.median_px != 7)
    return "processing.median_px must be 0, 3, 5 or 7";
  if (p.bilateral_px < 0.0 || p.bilateral_px > 5.0) return "processing.bilateral_px must be 0 to 5";
  if (!(p.bilateral_grey > 0.0)) return "processing.bilateral_grey must be greater than 0";
  if (p.local_tone.strength < 0.0 || p.local_tone.strength > 1.0) return "processing.local_tone must be 0 to 1";
  if (p.local_tone.tile_px < 8) return "processing.local_tone_tile_px must be at least 8";
  if (!(p.local_tone.most_slope >= 1.0)) return "processing.local_tone_slope must be at least 1";
  if (std::abs(p.sharpen_amount) > 10.0) return "processing.sharpen must be -10 to 10";
  if (!(p.sharpen_radius_px > 0.0 && p.sharpen_radius_px <= 20.0))
    return "processing.sharpen_radius_px must be greater than 0 and 20 at most";
  if (p.low_pass < 0.0 || p.low_pass > 0.5) return "processing.low_pass must be 0 to 0.5";
  if (!(p.pixel_size >= 1.0 && p.pixel_size <= 16.0)) return "processing.pixel_size must be 1 to 16";
  if (p.average_frames < 1 || p.average_frames > 64) return "processing.average_frames must be 1 to 64";
  if (p.recursion < 0.0 || p.recursion > 0.99) return "processing.recursion must be 0 to 0.99";
  if (p.motion_grey < 0.0) return "processing.motion_grey must not be negative";
  return std::nullopt;
}

std::optional<std::string> problem_with_timing(const Scenario& s) {
  const double most = 0.45 / s.sensor.fps;
  const Timing& timing = s.timing;
  if (timing.jitter_s < 0.0 || timing.stamp_jitter_s < 0.0 || timing.jitter_s + timing.stamp_jitter_s > most) {
    return fmt::format(
        "timing.jitter_s and timing.stamp_jitter_s must not be negative, and their sum must be 0.45 / fps = {} at "
        "most, so that time stamps rise",
        most);
  }
  if (s.haze.rms_mm < 0.0) return "haze.rms_mm must not be negative";
  if (s.haze.rms_mm > 0.0 && !(s.haze.step_s >= 0.999 / s.sensor.fps)) {
    return fmt::format("haze.step_s must be 1 / fps = {1} or longer, not {0}", s.haze.step_s, 1.0 / s.sensor.fps);
  }
  return std::nullopt;
}

std::optional<std::string> problem_with_tracks(const Scenario& s) {
  std::vector<const Track*> tracks{&s.mount.rotation_x, &s.mount.rotation_y, &s.mount.rotation_z,
                                   &s.mount.shift_x,    &s.mount.shift_y,    &s.mount.shift_z};
  tracks.insert(tracks.end(), {&s.optics.zoom, &s.optics.shift_x, &s.optics.shift_y, &s.light.flicker,
                               &s.sensor.defocus_px, &s.sensor.defocus_disc_px});
  for (const SceneMarker& m : s.markers) {
    tracks.insert(tracks.end(), {&m.dx, &m.dy, &m.dz, &m.wander_x, &m.wander_y, &m.cover.x_mm, &m.cover.y_mm,
                                 &m.glare.grey, &m.glare.x_mm, &m.glare.y_mm, &m.fold_mm});
  }
  for (const Track* track : tracks) {
    // The tolerance of 0.1 % accepts rounded decimals of 1 / fps.
    if (track->random != 0.0 && !(track->random_step_s >= 0.999 / s.sensor.fps)) {
      return fmt::format("random_step_s must be 1 / fps = {1} or longer, not {0}", track->random_step_s,
                         1.0 / s.sensor.fps);
    }
  }
  return std::nullopt;
}

std::optional<std::string> problem_with_known_to(const KnownTo& known) {
  if (known.position_mm < 0.0 || known.rotation_rad < 0.0 || known.height_mm < 0.0 || known.print_scale < 0.0)
    return "the standard uncertainties of known_to must not be negative";
  // At five standard deviations the scale must still be positive.
  if (known.print_scale > 0.1) return "known_to.print_scale must be 0.1 at most";
  return std::nullopt;
}

std::optional<std::string> problem_with_ink(const Ink& ink, double pitch_mm) {
  if (!(ink.line_share > 0.0 && ink.line_share < 1.0)) return "ink.line_share must be between 0 and 1";
  const double dark = ink.line_share + 2.0 * std::abs(ink.gain_mm) / std::max(pitch_mm, 1e-9);
  if (!(dark < 1.0) || !(ink.line_share - 2.0 * std::abs(ink.gain_mm) / std::max(pitch_mm, 1e-9) > 0.0))
    return "ink.gain_mm is too large, so that lines or gaps vanish";
  if (ink.rough_mm < 0.0 || ink.grain < 0.0) return "ink.rough_mm and ink.grain must not be negative";
  if (ink.mottle < 0.0 || ink.mottle > 0.4) return "ink.mottle must be 0 to 0.4";
  if (!(ink.rough_length_mm > 0.0 && ink.mottle_length_mm > 0.0 && ink.grain_length_mm > 0.0))
    return "ink.rough_length_mm, ink.mottle_length_mm and ink.grain_length_mm must be greater than 0";
  return std::nullopt;
}

std::optional<std::string> problem_with_marker(const SceneMarker& marker) {
  const Marker& print = marker.print;
  if (!print.circle && !print.grating)
    return fmt::format("marker {} requires a circle, a grating, or both", print.name);
  if (print.circle && !(print.circle->diameter_mm > 0.0)) {
    return fmt::format("marker {}, circle_diameter_mm must be greater than 0", print.name);
  }
  if (!(marker.cover.share > 0.0 && marker.cover.share <= 1.0)) {
    return fmt::format("marker {}, cover.share must be greater than 0 and 1 at most", print.name);
  }
  if (!(marker.cover.height_share > 0.0 && marker.cover.height_share <= 1.0 && marker.cover.opacity >= 0.0 &&
        marker.cover.opacity <= 1.0)) {
    return fmt::format("marker {}, cover.height_share and cover.opacity must be 0 to 1", print.name);
  }
  if (!(marker.glare.sigma_mm > 0.0))
    return fmt::format("marker {}, glare.sigma_mm must be greater than 0", print.name);
  if (std::abs(marker.place.stretch_x) > 0.5) {
    return fmt::format("marker {}, place.stretch_x must be -0.5 to 0.5", print.name);
  }
  if (std::abs(marker.place.print_scale) > 0.5) {
    return fmt::format("marker {}, place.print_scale must be -0.5 to 0.5", print.name);
  }
  if (!print.grating) return std::nullopt;
  if (const auto problem = problem_with_ink(marker.ink, print.grating->pitch_mm))
    return fmt::format("marker {}, {}", print.name, *problem);
  const Grating& grating = *print.grating;
  if (!(grating.pitch_mm > 0.0)) return fmt::format("marker {}, pitch_mm must be greater than 0", print.name);
  if (!(grating.width_mm > 0.0 && grating.height_mm > 0.0)) {
    return fmt::format("marker {}, grating_size_mm must be two numbers greater than 0", print.name);
  }
  if (std::max(grating.width_mm, grating.height_mm) > 10000.0 * grating.pitch_mm) {
    return fmt::format("marker {}, its grating has more than 10000 lines", print.name);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> problem_with(const Scenario& scenario) {
  if (auto problem = problem_with_sensor(scenario)) return problem;
  if (auto problem = problem_with_processing(scenario.processing)) return problem;
  if (auto problem = problem_with_timing(scenario)) return problem;
  if (auto problem = problem_with_tracks(scenario)) return problem;
  if (auto problem = problem_with_known_to(scenario.known_to)) return problem;
  if (scenario.markers.empty()) return "the scenario has no marker";
  std::set<std::string> names;
  for (const SceneMarker& marker : scenario.markers) {
    if (auto problem = problem_with_marker(marker)) return problem;
    if (!names.insert(marker.print.name).second) return fmt::format("two markers are named {}", marker.print.name);
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal::simulator
