// SPDX-License-Identifier: Apache-2.0
// Site: the markers and their positions in board millimetres (site.toml, docs/conventions.md). Values only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/units/point.h"

namespace moiregauge::internal {

enum class Pattern { kAuto, kGrid, kSquares, kDots, kLinesX, kLinesY, kCheckerboard, kCosine };
enum class Role { kReference, kTarget };

struct Circle {
  BoardPoint centre;         // mm
  double diameter_mm = 0.0;  // 0: not stated
};

// A periodic print. pitch_mm is the period along x (and y): line to line, centre to centre, two squares of a
// checkerboard.
struct Grating {
  BoardPoint centre;       // mm, a symmetry point of the grating
  double width_mm = 0.0;   // size of the grating along its own x
  double height_mm = 0.0;  // size along its own y
  double pitch_mm = 0.0;
  double angle_rad = 0.0;  // counter-clockwise from the board's x to the grating's x
  Pattern pattern = Pattern::kAuto;
};

// A marker has a circle, a grating, or both, and a name.
struct Marker {
  std::string name;
  Role role = Role::kReference;
  std::optional<Circle> circle;
  std::optional<Grating> grating;
  std::optional<double> z_mm;  // height above the reference plane; not stated: 0 for references, unknown for targets
};

// Standard uncertainties (k = 1) of the site's values.
struct KnownTo {
  double position_mm = 1.0;
  double rotation_rad = 0.3 * 3.14159265358979323846 / 180.0;
  double height_mm = 3.0;
  double print_scale = 0.0005;  // relative
};

struct Site {
  std::vector<Marker> markers;  // references first, then targets, each in the file's order
  KnownTo known_to;
};

// Returns the direction of a grating's lines on the board, which it does not show (length 1). Nothing: it shows both axes.
[[nodiscard]] std::optional<Extent<frame::Board>> direction_of_lines(const Grating& grating);

// Return the word of a pattern in site.toml and run.json ("grid", "lines-x", ...), and the pattern of a word.
[[nodiscard]] const char* word_for(Pattern pattern);
[[nodiscard]] std::optional<Pattern> pattern_named(const std::string& word);

}  // namespace moiregauge::internal
