// SPDX-License-Identifier: Apache-2.0
// What the decoding child may still do once it has begun to look at the input: read it, compute, fill the shared memory
// and talk to its parent. Everything else is refused by the kernel, whatever a decoder is talked into.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace moiregauge::internal {

// No further file, no core dump, and memory in proportion to the largest picture allowed.
//
// There is no limit on processor time: a run may take hours, and a decoder that works without a word is the watchdog's
// business (video_source.h). There is none on processes either: it counts all that the user runs, threads too, and the
// filter below knows a thread from a process.
void limit_resources(std::int64_t max_pixels);

// The filter of system calls (seccomp), for all threads and for good. Calls that an honest library makes in passing
// (to open a file, to ask for its status) fail with EPERM; those that only an intruder makes (to execute, to fork, to
// open a socket, to signal others) end the process with SIGSYS. The sanitizers get a few calls more.
// Returns why the kernel would not have it: the child is then held by limit_resources alone.
[[nodiscard]] std::optional<std::string> filter_system_calls();

}  // namespace moiregauge::internal
