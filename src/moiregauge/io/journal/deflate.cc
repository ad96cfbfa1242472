// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/deflate.h"

#include <stdexcept>

#include <zlib.h>

#include "moiregauge/io/journal/stored_bytes.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kLength = 4;  // bytes of the length field
// zlib level. Higher levels save 1 % of packed observations and take twice as long.
constexpr int kLevel = 6;

}  // namespace

std::string deflated(std::string_view bytes) {
  std::string out;
  append_little_endian(out, bytes.size(), kLength);
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  out.resize(kLength + size);
  if (compress2(reinterpret_cast<Bytef*>(out.data() + kLength), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), kLevel) != Z_OK)
    throw std::runtime_error("there is not enough memory for zlib");
  out.resize(kLength + size);
  return out;
}

std::optional<std::string> inflated(std::string_view bytes) {
  if (bytes.size() < kLength) return std::nullopt;
  const std::size_t length = from_little_endian(bytes.substr(0, kLength));
  // One deflated byte expands to at most 1032 bytes (zlib technical details), so a false length allocates little.
  constexpr std::size_t kMaxRatio = 1032;
  if (length > kMaxInflated || length > kMaxRatio * bytes.size()) return std::nullopt;
  std::string out(length, '\0');
  uLongf size = static_cast<uLongf>(length);
  uLong used = static_cast<uLong>(bytes.size() - kLength);
  const int done = uncompress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data() + kLength), &used);
  if (done != Z_OK || size != length || used != bytes.size() - kLength) return std::nullopt;
  return out;
}

}  // namespace moiregauge::internal
