// SPDX-License-Identifier: Apache-2.0
// State of a clip: a small file in OUT for each one. So a batch or a Slurm task can skip finished clips.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/batch/clip.h"
#include "moiregauge/batch/manifest.h"

namespace moiregauge::internal {

// Identifies the clip's files and everything that determines its result.
struct ClipIdentity {
  std::string options;      // SHA-256 of the options, and of the bytes of the site and camera files
  std::string stamp;        // number, bytes and newest change of the input's files
  std::string fingerprint;  // quick_fingerprint of the input. Empty: not needed so far
};

struct ClipState {
  bool is_finished = false;  // false: in progress, or interrupted
  ClipIdentity identity;
  int exit_code = 0;  // that of `measure`; 128 + N: ended by signal N
  bool is_timed_out = false;
  std::string message;  // error line, without `error: `
  double wall_s = 0.0, cpu_s = 0.0;
  std::int64_t max_resident_bytes = 0;
  double time_limit_s = 0.0;  // in force
  std::int64_t memory_limit_bytes = 0;
};

// Returns the state of a clip, or nothing if there is none or the file is damaged.
[[nodiscard]] std::optional<ClipState> read_state(const BatchFolder& folder, const std::string& name);

// Writes a state as a whole. Fails with path and reason.
[[nodiscard]] tl::expected<void, std::string> write_state(const BatchFolder& folder, const std::string& name,
                                                          const ClipState& state);

// Returns the identity of a clip without its fingerprint. Reads no images.
[[nodiscard]] ClipIdentity identity_of(const Clip& clip, const ClipOptions& options);

// Returns the fingerprint of a clip. It reads up to two megabytes.
[[nodiscard]] std::string fingerprint_of(const Clip& clip);

// kRestart: an unfinished run, if there is one, had other options.
enum class Need { kNothing, kMeasure, kRestart };

// Decides if a clip must be measured. A finished clip must not, unless its input, its site or the options differ.
// A clip that failed for lack of time, memory or disk space is repeated if there may be more now. `retry` repeats every
// clip that failed.
[[nodiscard]] Need need_of(const Clip& clip, const ClipOptions& options, const std::optional<ClipState>& state,
                           bool retry);

}  // namespace moiregauge::internal
