// SPDX-License-Identifier: Apache-2.0
// Runs a program as a child process: without a shell, with limits, and with its messages as lines.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace moiregauge::internal {

struct ChildRequest {
  std::vector<std::string> argv{};             // argv[0]: the program's path. No shell reads these
  std::string folder{};                        // working folder. Empty: the caller's
  std::vector<std::string> environment{};      // "NAME=value", in addition to the caller's
  std::int64_t max_memory_bytes = 0;           // private memory of each process (RLIMIT_DATA). 0: no limit
  std::chrono::milliseconds max_time{0};       // then the whole process group is ended. 0: no limit
  std::chrono::milliseconds patience{15'000};  // from SIGTERM to SIGKILL after max_time
  bool reads_stdout = false;                   // take_stdout() returns its output. Otherwise it is discarded
};

struct ChildEnd {
  int exit_code = -1;  // -1: ended by a signal
  int signal = 0;      // 0: ended by exit
  bool timed_out = false;
  double wall_s = 0.0;
  double cpu_s = 0.0;                   // the program's and that of the children it waited for
  std::int64_t max_resident_bytes = 0;  // largest resident set among these processes
};

// A running child in a process group of its own. So Ctrl-C at the terminal reaches only the caller.
// The child is killed when the thread that started it ends, in particular when the caller's process dies.
// Not safe for use by two threads at the same time.
class RunningProgram {
 public:
  // Starts the program with stdin from /dev/null, default signal actions and no other open file.
  // Fails with the reason: no such program or folder, or no further process is allowed.
  [[nodiscard]] static tl::expected<RunningProgram, std::string> start(const ChildRequest& request);
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  RunningProgram(RunningProgram&& other) noexcept;
  RunningProgram& operator=(RunningProgram&& other) noexcept;
  ~RunningProgram();  // kills the whole process group if the child runs

  // Collects output and returns how the child ended, or nothing if it runs on after `timeout`. Enforces max_time, so it
  // must be called regularly. After the end it returns the same again.
  std::optional<ChildEnd> wait(std::chrono::milliseconds timeout);
  // Sends a signal to the whole process group, e.g. SIGINT. Has no effect after the end.
  void send_signal(int signal) const;
  // Ends the child: SIGTERM to its process group, and SIGKILL after `patience`. Returns at once. wait() reports the end.
  void stop(std::chrono::milliseconds patience);

  // Returns the lines of stderr since the last call, without line ends: at most the newest 1000, each cut at 4096 bytes.
  // After the end, an unfinished last line counts too.
  [[nodiscard]] std::vector<std::string> take_stderr_lines();
  // Returns the bytes of stdout since the last call.
  [[nodiscard]] std::string take_stdout();
  [[nodiscard]] pid_t id() const { return process_; }  // also the process group

 private:
  using Clock = std::chrono::steady_clock;
  friend void wait_for_any(std::span<RunningProgram* const> programs, std::chrono::milliseconds timeout);
  RunningProgram() = default;
  void release();
  void collect_output();
  void add_messages(const char* bytes, std::size_t count);
  void enforce_limits();
  bool reap();
  [[nodiscard]] std::chrono::milliseconds shortened(std::chrono::milliseconds timeout) const;

  pid_t process_ = -1;
  int process_file_ = -1;  // readable once the child has ended
  int stderr_file_ = -1;
  int stdout_file_ = -1;
  Clock::time_point start_;
  std::optional<Clock::time_point> stop_at_;  // SIGTERM
  std::optional<Clock::time_point> kill_at_;  // SIGKILL
  std::chrono::milliseconds patience_{0};
  bool timed_out_ = false;
  std::optional<ChildEnd> end_;
  std::string unfinished_line_;
  std::deque<std::string> lines_;
  std::string output_;
};

// Waits until one of the programs has ended or written, or until one of their limits is due. Waits at most `timeout`.
void wait_for_any(std::span<RunningProgram* const> programs, std::chrono::milliseconds timeout);

// Returns the path of the program that is running now.
[[nodiscard]] std::string own_program();

}  // namespace moiregauge::internal
