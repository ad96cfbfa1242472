// SPDX-License-Identifier: Apache-2.0
// Input: headers of an HEVC stream. The first byte is the length of the extradata; the rest is one packet.
// Requires: a quantiser from -48 to 51, or none.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "moiregauge/decoder/headers/hevc_headers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span bytes(data + 1, size - 1);
  const auto first = std::min<std::size_t>(bytes.size(), data[0]);
  moiregauge::internal::HevcHeaders headers;
  headers.read_extradata(bytes.first(first));
  const auto quantiser = headers.read_packet(bytes.subspan(first));
  if (quantiser && (quantiser->parameter < -48 || quantiser->parameter > 51)) std::abort();
  return 0;
}
