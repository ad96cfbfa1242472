// SPDX-License-Identifier: Apache-2.0
// The small rig from anywhere, among things that look like its markers: what identity must see through.
#pragma once

#include <cstdint>
#include <vector>

#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::test {

// Painted on the picture, not on the board: an outline that no circle of the board has.
struct PaintedEllipse {
  ImagePoint centre;
  double half_length = 0.0, half_width = 0.0;  // px
  double angle_rad = 0.0;
  double grey = 0.0;
};

struct CrowdedScene {
  simulator::Scenario scenario;  // references NW, NE, SW, SE and target "mid"; "spare" and "look-alike"s
  Site site;                     // what its owner knows of it
  std::vector<PaintedEllipse> ellipses;
  double roll_deg = 0.0;
};

// Frame 0, and frame kMovedFrame in which the camera has turned a little and the target has moved by (0.6, 1.7) mm.
inline constexpr long kMovedFrame = 10;

enum class Fault { kNone, kCircleMissing };  // one of the four reference circles is not there; the site does not know

// Same seed, same scene: distance 1.2 to 2.6 m, tilts up to 20 deg, roll up to 85 deg (all markers in the picture), six
// look-alike circles at random places, four of the references' own size and two within a quarter of it, a spare grating
// of the same pitch, four ellipses, light falling off to one side, noise 0.5 to 3 grey levels.
[[nodiscard]] CrowdedScene crowded_scene(std::uint64_t seed, Fault fault = Fault::kNone);

[[nodiscard]] Image<std::uint8_t> picture_of(const CrowdedScene& scene, long frame);

}  // namespace moiregauge::internal::test
