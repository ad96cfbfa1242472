// SPDX-License-Identifier: Apache-2.0
// Result of a measurement: displacement of every target in every frame, with its standard uncertainty.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/camera.h"
#include "moiregauge/site.h"

namespace moiregauge {

// Status of a sample. Only kOk is trusted. From kLost on all numbers are NaN.
enum class Status {
  kOk,
  kUntrusted,
  kCameraMoved,
  kBlurred,
  kSaturated,
  kPartlyCovered,
  kLost,
  kReferenceLost,
  kOrderUnproven,  // the fringe order (number of whole pitches) could not be determined
  kDecodeError,
  kTooCoarse
};

// Returns the word of displacement.csv: "ok", "partly-covered", ...
[[nodiscard]] MOIREGAUGE_API const char* to_string(Status status);

// Displacement of one target in one frame since the reference frame. x is right, y is up. Not measured is NaN.
struct Sample {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  long frame = 0;
  double time_s = kNaN;  // from frame 0
  double dx_mm = kNaN, dy_mm = kNaN;
  double u_dx_mm = kNaN, u_dy_mm = kNaN;  // standard uncertainty (k = 1), including the reference frame's share
  Status status = Status::kLost;
};

struct Target {
  std::string name;
  std::vector<Sample> samples;                            // one per frame
  long ok = 0;                                            // samples with status kOk
  double u_dx_mm = Sample::kNaN, u_dy_mm = Sample::kNaN;  // rms over the measured samples
};

struct Result {
  std::vector<Target> targets;
  Site site;                         // as stated, or as detected
  std::optional<Camera> camera;      // as solved from the footage
  long reference_frame = -1;         // -1: none was found
  bool references_verified = false;  // the references were tested against each other, and none moves
  std::vector<std::string> warnings;
  std::string refusal;  // why no sample is trusted; empty for a measurement
  std::string remedy;   // what to do about it, imperative; empty: see overlay.png
  int exit_code = 0;    // the program's code for the same run: 0, 4 (refused), 5 (over 1 % not ok), 130 (stopped)
  std::string folder;   // contains the written results; empty: nothing was written

  // Returns the target with this name, or null.
  [[nodiscard]] const Target* find(const std::string& name) const {
    for (const Target& target : targets)
      if (target.name == name) return &target;
    return nullptr;
  }
};

}  // namespace moiregauge
