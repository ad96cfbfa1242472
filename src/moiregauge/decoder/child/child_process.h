// SPDX-License-Identifier: Apache-2.0
// The decoding child as the parent sees it.
//
// Decoders are the most attacked code there is, and a crash of one must cost frames, not a measurement. So they run in
// a child that holds one input, one piece of memory and one socket. The child is our own program executed anew with
// `--decode-child`: a plain fork() of a program with threads may only execute anew or die. It turns off into decoding
// before main(), in a constructor, so every program linked with this module can be its own child: the command, each
// test program, under sanitizers too.
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

class ChildProcess {
 public:
  // `input` stays the caller's; no picture of it with more than `max_pixels` is decoded. The error says why no child
  // could be started.
  [[nodiscard]] static tl::expected<ChildProcess, std::string> start(const std::string& program, int input,
                                                                     std::int64_t max_pixels);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();  // kills it if it still runs

  // The next record, or how the child was lost: silent for longer than the watchdog allows, or dead.
  [[nodiscard]] tl::expected<wire::Record, std::string> receive(std::chrono::milliseconds watchdog);
  void release(int slot) const;
  // The pixels, once kOpened has come; nothing when the memory is not what the record promises.
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
