// SPDX-License-Identifier: Apache-2.0
// Checks the check sums of a Matroska file: CRC-32 over the rest of an element (RFC 8794, 11.3.1).
// FFmpeg writes them but does not read them. They detect errors that no decoder can: a wrong bit in a JPEG image.
#pragma once

#include <cstdint>
#include <optional>

#include "moiregauge/decoder/headers/stated_size.h"

namespace moiregauge::internal {

class ClusterSums {
 public:
  // A file that is no Matroska, or has no segment, always agrees.
  explicit ClusterSums(ReadAt read);

  // Checks the elements from the end of the last call to the one that contains the byte at `place`. Returns false once
  // an element contradicts its check sum.
  // Bytes that are no element end the check: the container's reader reports them.
  [[nodiscard]] bool agree_up_to(std::uint64_t place);

 private:
  [[nodiscard]] bool agrees(std::uint64_t begin, std::uint64_t end) const;

  ReadAt read_;
  std::optional<std::uint64_t> next_;  // offset of the next element; none: nothing left to check
  bool agree_ = true;
};

}  // namespace moiregauge::internal
