// SPDX-License-Identifier: Apache-2.0
// What a recording that has not been made yet will be good for: the bound of its layout, blur, reach, room.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/geometry/camera.h"
#include "moiregauge/image/quantiser.h"
#include "moiregauge/planning/layout_bound.h"
#include "moiregauge/planning/planned_print.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// A swing: amplitude (half of peak to peak) and frequency. of the target in mm, of the camera in rad.
struct Swing {
  double amplitude = 0.0;
  double frequency_hz = 0.0;
  [[nodiscard]] double speed() const;         // largest, per s
  [[nodiscard]] double acceleration() const;  // largest, per s^2
};

struct RecordingSetup {
  Site site;      // patterns, pitches and sizes of the prints, places
  Camera camera;  // width, height, fx, fy, cx, cy; faces the middle of the markers
  double distance_mm = 0.0;
  double noise_sigma = 1.5;  // of a pixel, grey levels of 8 bits; rounding comes on top
  PlannedOptics optics;      // without blur: that follows from the swings
  double fps = 30.0;
  double exposure_s = 0.0;
  double readout_s = 0.0;  // rolling shutter, first to last row
  Quantiser codec;         // of the recording's frames; the default loses nothing
  std::optional<Swing> target_swing, camera_swing;
};

struct PlannedTarget {
  std::size_t marker = 0;              // index in the site
  Extent<frame::Board> phase_bound{};  // mm, one frame, fundamentals over the whole prints (k = 1)
  Extent<frame::Board> full_bound{};   // every harmonic
  // u of a displacement since the reference frame, as `precise` reads it: every harmonic over its windows (without edges
  // of 2.4 px), both frames' noise, and the codec's share.
  Extent<frame::Board> u{};
  Extent<frame::Board> codec{};  // mm; 0: nothing is lost
};

// NaN where an axis is not shown or the references do not determine it. Every print is seen square on, at its height;
// of a camera that faces the board a view 20 degrees aslant changes a bound by 3 % (docs/cli/plan.md).
[[nodiscard]] std::vector<PlannedTarget> planned_targets(const RecordingSetup& setup);

// Of a plane at height z before the board.
[[nodiscard]] double px_per_mm(const RecordingSetup& setup, double z_mm = 0.0);

// Way in the picture during the exposure at the swings' greatest speed, px: of target and camera.
struct PlannedBlur {
  double target_px = 0.0, camera_px = 0.0;
};
[[nodiscard]] PlannedBlur planned_blur(const RecordingSetup& setup);

// A rolling shutter reads the target's row `lag` away from the references' rows.
struct ShutterError {
  double lag_s = 0.0;      // the most between a target's row and a reference's
  double camera_mm = 0.0;  // 1/2 acceleration lag^2: what no constant speed of the picture explains
  double target_mm = 0.0;  // speed times lag: a target that is where it is at its own row's time
};
[[nodiscard]] ShutterError shutter_error(const RecordingSetup& setup);

// How far the camera may turn about its own axes, rad to either side, before a print leaves the picture; negative: one
// is outside already. Pan about the upright axis, tilt about the level one, roll about the line of sight.
struct TurningRoom {
  double pan = 0.0, tilt = 0.0, roll = 0.0;
};
[[nodiscard]] TurningRoom turning_room(const RecordingSetup& setup);

// A layout that tells its weak axis better: the references on one side moved away from the middle.
struct BetterLayout {
  std::vector<std::string> moved;                          // names
  Extent<frame::Board> by{};                               // mm
  double span_ratio_before = 0.0, span_ratio_after = 0.0;  // short by long side of what the references span
  Extent<frame::Board> u_before{}, u_after{};              // of the worst target
  std::size_t target = 0;                                  // index in the site
  bool picture_ends_it = false;                            // further would help, but leaves the picture
};
// Where one axis is worth `kWeakAxis` times the other; nothing where it is not, or where no move helps.
inline constexpr double kWeakAxis = 2.0;
[[nodiscard]] std::optional<BetterLayout> better_layout(const RecordingSetup& setup);

}  // namespace moiregauge::internal
