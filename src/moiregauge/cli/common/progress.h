// SPDX-License-Identifier: Apache-2.0
// Progress lines on stderr: on a terminal only, and only for what takes a while.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <thread>

namespace moiregauge::internal::cli {

struct ProgressState {
  long done = 0;
  long expected = -1;  // < 0: not known
  double elapsed_s = 0.0;
  std::optional<double> waiting_share;  // of the time, spent waiting for frames; empty: not a matter of frames read
};

// "measuring [####....] 240/1000 frames, decode-bound, 24 fps, 32 s left": what limits the run is what most of its time
// goes into.
[[nodiscard]] std::string progress_line(const std::string& what, const ProgressState& state);

// Shows how far a run is, from its third second on.
class Progress {
 public:
  Progress(std::string what, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // expected < 0: not known.
  void show(long done, long expected, std::optional<double> waiting_share = std::nullopt);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool shown_ = false;
  bool wanted_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

// Shows how long work takes that does not say how far it is, from its second second on.
class ElapsedLine {
 public:
  ElapsedLine(std::string what, bool quiet);

 private:
  std::jthread thread_;  // its end stops it and clears the line
};

}  // namespace moiregauge::internal::cli
