// SPDX-License-Identifier: Apache-2.0
// The check sums that a Matroska file may carry of its parts (RFC 8794, 11.3.1: CRC-32 of all that follows in the
// element). libav writes them and does not read them. They find what no decoder sees: a flipped bit in a JPEG picture.
#pragma once

#include <cstdint>
#include <optional>

#include "moiregauge/decoder/headers/stated_size.h"

namespace moiregauge::internal {

class ClusterSums {
 public:
  // Of no Matroska file, or one without a segment: nothing is ever wrong.
  explicit ClusterSums(ReadAt read);

  // Checks the parts of the file from where the last call ended up to that which holds the byte at `place`. False once
  // a part with a sum does not agree with it. A part that is no element ends the checking: the reader of the container,
  // which cannot read on either, says so itself.
  [[nodiscard]] bool agree_up_to(std::uint64_t place);

 private:
  [[nodiscard]] bool agrees(std::uint64_t begin, std::uint64_t end) const;

  ReadAt read_;
  std::optional<std::uint64_t> next_;  // where the next part begins; nothing: no more to check
  bool agree_ = true;
};

}  // namespace moiregauge::internal
