// SPDX-License-Identifier: Apache-2.0
// Crowded scene for the identification: the small rig from any direction, among false candidates.
#pragma once

#include <cstdint>
#include <vector>

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::test {

// Ellipse painted on the image, not on the board. No circle of the board has such an outline.
struct PaintedEllipse {
  ImagePoint centre;
  double half_length = 0.0, half_width = 0.0;  // px
  double angle_rad = 0.0;
  double grey = 0.0;
};

struct CrowdedScene {
  simulator::Scenario scenario;  // references NW, NE, SW, SE and target "mid"; unlisted "spare" and "look-alike"s
  Site site;                     // the site as the user states it
  std::vector<PaintedEllipse> ellipses;
  double roll_deg = 0.0;
};

// Frame in which the camera has rotated a little and the target has moved by (0.6, 1.7) mm since frame 0.
inline constexpr long kMovedFrame = 10;

// kCircleMissing: one of the four reference circles is missing, and the site still lists it.
enum class Fault { kNone, kCircleMissing };

// Returns the scene of a seed. Distance 1.2 to 2.6 m, tilts up to 20 deg, roll up to 85 deg, all markers inside the
// image. Light falls off to one side, noise is 0.5 to 3 grey levels.
// False candidates are six circles at random positions, a spare grating of the same pitch, and four ellipses. Four of
// the circles have the references' size, two are within a quarter of it.
[[nodiscard]] CrowdedScene crowded_scene(std::uint64_t seed, Fault fault = Fault::kNone);

// Returns the image of a frame, with noise and 8 bits.
[[nodiscard]] Image<std::uint8_t> picture_of(const CrowdedScene& scene, long frame);

}  // namespace moiregauge::internal::test
