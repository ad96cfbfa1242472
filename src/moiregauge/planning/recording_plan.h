// SPDX-License-Identifier: Apache-2.0
// Plan of a recording: expected uncertainty of its layout, blur, rolling shutter error and room for rotation.
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

// Sinusoidal motion: amplitude (half of peak to peak; mm for the target, rad for the camera) and frequency.
struct Swing {
  double amplitude = 0.0;
  double frequency_hz = 0.0;
  [[nodiscard]] double speed() const;         // largest speed, unit of the amplitude per s
  [[nodiscard]] double acceleration() const;  // largest acceleration, unit of the amplitude per s^2
};

struct RecordingSetup {
  Site site;      // patterns, pitches, sizes and positions of the gratings
  Camera camera;  // width, height, fx, fy, cx, cy; faces the middle of the markers
  double distance_mm = 0.0;
  double noise_sigma = 1.5;  // each pixel's noise, grey levels of 8 bits; rounding is added
  PlannedOptics optics;      // without motion blur, which follows from the swings
  double fps = 30.0;
  double exposure_s = 0.0;
  double readout_s = 0.0;  // readout time; 0: global shutter
  Quantiser codec;         // used for the recording; the default is lossless
  std::optional<Swing> target_swing, camera_swing;
};

struct PlannedTarget {
  std::size_t marker = 0;              // index in the site
  Extent<frame::Board> phase_bound{};  // mm, one frame, fundamentals of the whole gratings (k = 1)
  Extent<frame::Board> full_bound{};   // the same with all harmonics
  // u of a displacement by `precise` since the reference frame, mm. All harmonics in its windows (without edges of 2.4
  // px), the noise of both frames, and the parts of codec and rolling shutter.
  Extent<frame::Board> u{};
  Extent<frame::Board> codec{};  // mm; 0: lossless
  // Root mean square of the false displacement by a rolling shutter and the camera's vibration, mm. `precise` corrects
  // the motion that its frames resolve, so this is an upper limit. The direction is unknown: both axes have the whole.
  double shutter = 0.0;
};

// Returns one entry per target. NaN: an axis that is not shown, or references that do not determine it.
// Every grating is seen frontally at its height. A view tilted by 20 degrees changes a bound by 3 % (docs/cli/plan.md).
[[nodiscard]] std::vector<PlannedTarget> planned_targets(const RecordingSetup& setup);

// Returns the image scale of a plane at height z above the board, px/mm.
[[nodiscard]] double px_per_mm(const RecordingSetup& setup, double z_mm = 0.0);

// Motion blur: movement in the image during the exposure at the largest speed, px, by target and camera.
struct PlannedBlur {
  double target_px = 0.0, camera_px = 0.0;
};
[[nodiscard]] PlannedBlur planned_blur(const RecordingSetup& setup);

// Errors from the time `lag` between the rows of the target and those of a reference.
struct ShutterError {
  double lag_s = 0.0;      // largest time between a target's row and a reference's
  double camera_mm = 0.0;  // 1/2 acceleration lag^2: a constant speed of the image cancels
  double target_mm = 0.0;  // speed times lag: the target is read at its own row's time
};
// All targets, or one (index in the site).
[[nodiscard]] ShutterError shutter_error(const RecordingSetup& setup, std::optional<std::size_t> target = std::nullopt);

// Largest rotation of the camera about its own axes before a grating leaves the image, rad to either side. Negative:
// one is outside already. Pan is about the upright axis, tilt about the level one, roll about the line of sight.
struct TurningRoom {
  double pan = 0.0, tilt = 0.0, roll = 0.0;
};
[[nodiscard]] TurningRoom turning_room(const RecordingSetup& setup);

// A layout with a smaller uncertainty of the weak axis: the references on one side are moved away from the middle.
struct BetterLayout {
  std::vector<std::string> moved;                          // names
  Extent<frame::Board> by{};                               // mm
  double span_ratio_before = 0.0, span_ratio_after = 0.0;  // short side by long side of the references' extent
  Extent<frame::Board> u_before{}, u_after{};              // for the worst target, mm
  std::size_t target = 0;                                  // index in the site
  bool picture_ends_it = false;                            // more would help, but leaves the image
};
// Returns a better layout if u of one axis is more than `kWeakAxis` times that of the other.
// Fails (nothing): no axis is that weak, or no move helps.
inline constexpr double kWeakAxis = 2.0;
[[nodiscard]] std::optional<BetterLayout> better_layout(const RecordingSetup& setup);

}  // namespace moiregauge::internal
