// SPDX-License-Identifier: Apache-2.0
// A progress line on stderr: on a terminal only, for runs over two seconds only.
#pragma once

#include <chrono>
#include <string>

namespace moiregauge::cli {

class Progress {
 public:
  Progress(std::string what, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // expected < 0: not known.
  void show(long done, long expected);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool shown_ = false;
  bool wanted_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

}  // namespace moiregauge::cli
