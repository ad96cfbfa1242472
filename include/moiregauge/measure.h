// SPDX-License-Identifier: Apache-2.0
// Measurement of a recording: the program's `moiregauge measure` as one function.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "moiregauge/result.h"
#include "moiregauge/units.h"

namespace moiregauge {

// Times first <= t < end of a recording.
struct TimeRange {
  Seconds first;
  Seconds end;
};

// Frames first, first + step, ... below end. With `time` the frames' times select them, not first and end.
struct FrameRange {
  long first = 0;
  long end = -1;  // -1: to the end
  long step = 1;
  std::optional<TimeRange> time = std::nullopt;
};

// Reads a range such as "0:20", "0:100:2" (frames) or "1.5s:3s" (times), as the command line does. `option` is its name
// in the message.
// Fails (kUsage): the text is no range.
[[nodiscard]] MOIREGAUGE_API Expected<FrameRange> read_frame_range(const std::string& text, const std::string& option);

// Use of the frames that an unfinished run left in the output folder.
enum class Unfinished { kRefuse, kResume, kRestart };

// The scale is mandatory: `pitch`, `site` or `site_file`. All else has a default that works.
struct MeasureOptions {
  std::optional<Millimetres> pitch;  // the gratings' pitch; the site is then detected in the reference frame
  std::optional<Site> site;
  std::string site_file;
  std::optional<Camera> camera;  // calibrated; empty: solved from the footage
  std::string camera_file;
  std::string method = "precise";     // or "two-stage", "conventional"
  std::optional<double> fps;          // frames per second of a folder of images
  std::optional<double> slow_motion;  // recorded by stored frame rate: 8 for 240 frames/s stored as 30
  FrameRange frames;
  std::optional<long> reference_frame;  // empty: the first measurable frame
  std::optional<FrameRange> rest;       // frames in which no target moves
  std::optional<Seconds> readout;       // rolling shutter: first row to last row; empty: solved from the footage
  std::string tone = "auto";            // tone curve: auto, linear, srgb, bt709, gamma:2.2
  std::optional<FrameRange> zero;       // displacements are relative to the mean over these frames
  std::string output;                   // folder for the results; empty: nothing is written
  Unfinished unfinished = Unfinished::kRefuse;
  int threads = 0;                                            // 0: one per core; the number does not change the result
  std::function<bool(long done, long expected)> on_progress;  // after each frame; false stops the run
};

// Measures a video, a folder of images or a multi-page TIFF.
// Model: docs/methods/precise.md. Units: mm and s.
// Fails: options that exclude each other (kUsage), unreadable input (kInput), results not written (kOutput). A refused
// measurement is no error: Result::refusal is its reason.
// Error: u_dx_mm and u_dy_mm of every sample; status kOk is trusted.
[[nodiscard]] MOIREGAUGE_API Expected<Result> measure(const std::string& input, const MeasureOptions& options);

}  // namespace moiregauge
