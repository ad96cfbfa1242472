// SPDX-License-Identifier: Apache-2.0
// Reads the length that a video file states. Decoders accept a truncated copy, because they cannot distinguish the
// end of the file from the end of the video. The outermost structure of the container shows it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace moiregauge::internal {

// Fills `out` from `offset` on, up to the end of the file. Returns the number of bytes.
using ReadAt = std::function<std::size_t(std::uint64_t offset, std::span<std::uint8_t> out)>;

// Returns the smallest number of bytes that the file must have by its own structure. Sources: boxes of mp4 and mov
// (ISO/IEC 14496-12, 4.2), the segment of Matroska (RFC 8794, RFC 9559), RIFF chunks of AVI. An MPEG transport stream
// has whole packets of 188 bytes.
// Returns nothing for other files, and for recordings that were never closed.
[[nodiscard]] std::optional<std::uint64_t> stated_size(const ReadAt& read, std::uint64_t file_bytes);

}  // namespace moiregauge::internal
