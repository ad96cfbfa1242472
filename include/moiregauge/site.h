// SPDX-License-Identifier: Apache-2.0
// Site: what is printed where, in millimetres on the board (x right, y up, z towards the camera). docs/file-formats.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/errors.h"

namespace moiregauge {

// Pattern of a grating. kAuto: one of the crossed patterns, recognised in the image.
enum class Pattern { kAuto, kGrid, kSquares, kDots, kLinesX, kLinesY, kCheckerboard, kCosine };

struct Circle {
  double x_mm = 0.0, y_mm = 0.0;  // centre
  double diameter_mm = 0.0;       // 0: not stated
};

struct Grating {
  double x_mm = 0.0, y_mm = 0.0;           // a symmetry point of the pattern near the middle
  double width_mm = 0.0, height_mm = 0.0;  // extent along its own axes
  double pitch_mm = 0.0;                   // period along both axes; two squares of a checkerboard
  double angle_deg = 0.0;                  // counter-clockwise
  Pattern pattern = Pattern::kAuto;
};

// A marker has a circle, a grating, or both.
struct Marker {
  std::string name;
  bool is_reference = false;  // fixed; otherwise a target, which moves
  std::optional<Circle> circle;
  std::optional<Grating> grating;
  std::optional<double> z_mm;  // height above the reference plane; empty: unknown for targets, 0 for references
};

// Standard uncertainties (k = 1) of the site.
struct KnownTo {
  double position_mm = 1.0;
  double rotation_deg = 0.3;
  double height_mm = 3.0;
  double print_scale = 0.0005;  // relative
};

struct Site {
  std::vector<Marker> markers;
  KnownTo known_to;
};

// Reads a site file.
// Fails (kUsage): the file is missing or has mistakes; the message lists each with line and column.
[[nodiscard]] MOIREGAUGE_API Expected<Site> read_site(const std::string& path);

// Returns the text of a site file.
[[nodiscard]] MOIREGAUGE_API std::string site_text(const Site& site);

}  // namespace moiregauge
