// SPDX-License-Identifier: Apache-2.0
// How long a video file is by its own account. A copy that was cut off is mostly as good as whole to a decoder, which
// takes the end of the file for the end of the film; the outermost structure of the container knows better.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace moiregauge::internal {

// Fills `out` from `offset` on, as far as the file goes; gives the number of bytes.
using ReadAt = std::function<std::size_t(std::uint64_t offset, std::span<std::uint8_t> out)>;

// Bytes that a file with this beginning must have, at least: of an mp4 or mov by its boxes (ISO/IEC 14496-12, 4.2), of
// a Matroska file by its segment (RFC 8794, RFC 9559), of an AVI by its RIFF chunks, of an MPEG transport stream whole
// packets of 188 bytes. Nothing where it is no such file or does not say (a recording that was never closed).
[[nodiscard]] std::optional<std::uint64_t> stated_size(const ReadAt& read, std::uint64_t file_bytes);

}  // namespace moiregauge::internal
