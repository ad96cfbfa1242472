// SPDX-License-Identifier: Apache-2.0
// Measures one clip in a process of its own, by the program's own command `measure`.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/base/child_process.h"
#include "moiregauge/batch/clip.h"
#include "moiregauge/batch/clip_state.h"
#include "moiregauge/batch/manifest.h"

namespace moiregauge::internal {

class ClipJob {
 public:
  // Starts `program` measure. Writes the clip's state before, so that a killed batch knows what was in progress.
  // Fails with path and reason: no process can start, or OUT cannot be written.
  [[nodiscard]] static tl::expected<ClipJob, std::string> start(const std::string& program, const BatchFolder& folder,
                                                                const Clip& clip, const ClipOptions& options,
                                                                Need need);
  // Returns the final state once the process has ended, and writes it. The state of an interrupted clip stays
  // unfinished. Fails with path and reason if the state cannot be written.
  [[nodiscard]] tl::expected<std::optional<ClipState>, std::string> poll();
  // Asks the process to stop. Its frames are kept.
  void interrupt();
  [[nodiscard]] RunningProgram& program() { return program_; }
  [[nodiscard]] const Clip& clip() const { return clip_; }

 private:
  ClipJob(RunningProgram program, const BatchFolder& folder, Clip clip, ClipState state)
      : program_(std::move(program)), folder_(folder), clip_(std::move(clip)), state_(std::move(state)) {}
  void take_messages();
  void conclude(const ChildEnd& end);

  RunningProgram program_;
  BatchFolder folder_;
  Clip clip_;
  ClipState state_;
  std::string last_line_;
  bool is_interrupted_ = false;
};

// Returns the arguments of the process that measures a clip.
[[nodiscard]] std::vector<std::string> command_of(const std::string& program, const BatchFolder& folder,
                                                  const Clip& clip, const ClipOptions& options, Need need);

}  // namespace moiregauge::internal
