// SPDX-License-Identifier: Apache-2.0
// Confines the decoding child before it reads the input. It may read the input, compute, write the shared memory and
// talk to its parent. The kernel refuses everything else, even if a decoder is compromised.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace moiregauge::internal {

// Limits resources: no further file, no core dump, and memory in proportion to the largest image allowed.
//
// There is no limit on processor time, because a run may take hours, and the watchdog kills a silent decoder
// (video_source.h). There is none on processes either, because that limit counts threads and all processes of the user.
// The filter below distinguishes threads from processes.
void limit_resources(std::int64_t max_pixels);

// Input of a child: a file, or a connection that it has opened before.
enum class InputAccess { kFile, kConnection };

// Installs the filter of system calls (seccomp) for all threads, irrevocably. With kConnection the child may also read
// and write descriptors that it opened itself.
// Calls that a library may make (open a file, read its status) fail with EPERM. Calls that only an intruder makes
// (execute, fork, open a socket, signal others) end the process with SIGSYS. Sanitizers may make some more calls.
// Returns the reason if the kernel refuses the filter. Then only limit_resources confines the child.
[[nodiscard]] std::optional<std::string> filter_system_calls(InputAccess access = InputAccess::kFile);

}  // namespace moiregauge::internal
