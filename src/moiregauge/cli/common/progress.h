// SPDX-License-Identifier: Apache-2.0
// Progress lines on stderr, on a terminal only, and only for work of more than two seconds.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <thread>

namespace moiregauge::internal::cli {

struct ProgressState {
  long done = 0;
  long expected = -1;  // < 0: unknown
  double elapsed_s = 0.0;
  std::optional<double> waiting_share;  // share of the time spent waiting for frames; empty: unknown
};

// Returns a line such as "measuring [####....] 240/1000 frames, decode-bound, 24 fps, 32 s left". The limit is the part
// that takes most of the time.
[[nodiscard]] std::string progress_line(const std::string& what, const ProgressState& state);

// Shows the progress of a run, from its third second on.
class Progress {
 public:
  Progress(std::string what, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // expected < 0: unknown.
  void show(long done, long expected, std::optional<double> waiting_share = std::nullopt);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool shown_ = false;
  bool wanted_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

// Shows the time that work without a measure of progress takes, from its second second on.
class ElapsedLine {
 public:
  ElapsedLine(std::string what, bool quiet);

 private:
  std::jthread thread_;  // its end stops it and clears the line
};

}  // namespace moiregauge::internal::cli
