// SPDX-License-Identifier: Apache-2.0
// Starts and controls the decoding child process.
//
// Decoders are the most attacked code in the program, and their crash must cost frames, not a measurement. So they run
// in a child that has one input, one shared memory and one socket.
// The child is the same program, executed again with `--decode-child`, because a forked program with threads may only
// call exec or exit. It starts decoding before main(), in a constructor. So every program linked with this module can
// be its own child, including test programs and sanitizer builds. A shared library may be loaded into a foreign program
// (Python), so it brings a program of its own.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/decoder/child/wire.h"

namespace moiregauge::internal {

// Returns the program to start: moiregauge/moiregauge-decode next to the shared library with this code, if it exists.
// Otherwise the running program, which then contains this code.
[[nodiscard]] std::string default_child_program();

class ChildProcess {
 public:
  // Starts a child. `input` remains the caller's. The child decodes no image of more than `max_pixels`. `mode`:
  // wire::kChildMode or wire::kLiveMode. The child may omit frames before `first_frame`. Fails with the reason.
  [[nodiscard]] static tl::expected<ChildProcess, std::string> start(const std::string& program, int input,
                                                                     std::int64_t max_pixels,
                                                                     const char* mode = wire::kChildMode,
                                                                     long first_frame = 0);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();  // kills the child if it is running

  // Waits until receive() would not wait. Returns false if it still would.
  [[nodiscard]] bool has_record(std::chrono::milliseconds timeout) const;
  // Returns the next record. Fails if the child is silent for longer than `watchdog` or has died.
  [[nodiscard]] tl::expected<wire::Record, std::string> receive(std::chrono::milliseconds watchdog);
  void release(int slot) const;
  // Maps the pixels. Call it after kOpened. Returns null if the memory is smaller than the record states.
  [[nodiscard]] const std::byte* map(std::size_t bytes);

 private:
  ChildProcess() = default;
  [[nodiscard]] std::string last_words();
  pid_t process_ = -1;
  int socket_ = -1;
  int memory_file_ = -1;
  const std::byte* memory_ = nullptr;
  std::size_t memory_bytes_ = 0;
};

}  // namespace moiregauge::internal
