// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/stated_size.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

namespace moiregauge::internal {
namespace {

using Size = std::optional<std::uint64_t>;
constexpr std::uint64_t kMax = std::numeric_limits<std::uint64_t>::max();

template <std::size_t N>
std::optional<std::array<std::uint8_t, N>> bytes_at(const ReadAt& read, std::uint64_t offset) {
  std::array<std::uint8_t, N> bytes{};
  if (read(offset, bytes) != N) return std::nullopt;
  return bytes;
}

std::uint64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8U | byte;
  return value;
}

template <std::size_t N>
bool is_text(const std::array<std::uint8_t, N>& bytes, std::size_t at, std::string_view text) {
  return std::equal(text.begin(), text.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

Size sum(std::uint64_t a, std::uint64_t b) { return b > kMax - a ? Size() : Size(a + b); }

Size size_by_boxes(const ReadAt& read, std::uint64_t file_bytes) {
  constexpr int kMaxBoxes = 1 << 20;  // 12 days of one fragment per second
  std::uint64_t offset = 0;
  for (int boxes = 0; offset < file_bytes; ++boxes) {
    if (boxes == kMaxBoxes) return std::nullopt;
    const auto head = bytes_at<8>(read, offset);
    if (!head) return sum(offset, 8);  // truncated within a box header
    std::uint64_t size = big_endian(std::span(*head).first(4));
    if (size == 0) return std::nullopt;  // extends to the end of the file
    if (size == 1) {
      const auto large = bytes_at<8>(read, offset + 8);
      if (!large) return sum(offset, 16);
      size = big_endian(*large);
    }
    const Size end = sum(offset, size);
    if (size < 8 || !end) return std::nullopt;
    offset = *end;
  }
  return offset;
}

// Returns the number of variable length at `offset`, and moves `offset` after it. Returns nothing for "unknown".
Size ebml_size(const ReadAt& read, std::uint64_t& offset) {
  std::array<std::uint8_t, 8> bytes{};
  const std::size_t got = read(offset, bytes);
  std::size_t length = 1;
  while (length <= 8 && (bytes[0] & (0x80U >> (length - 1))) == 0) ++length;
  if (length > got) return std::nullopt;
  const std::uint64_t value = big_endian(std::span(bytes).first(length));
  const std::uint64_t unknown = (std::uint64_t{1} << (7 * length)) - 1;
  offset += length;
  return (value & unknown) == unknown ? Size() : Size(value & unknown);
}

Size size_by_segment(const ReadAt& read) {
  std::uint64_t offset = 4;  // after the identity of the EBML header
  const Size head = ebml_size(read, offset);
  if (!head || *head > 4096) return std::nullopt;
  offset += *head;
  const auto identity = bytes_at<4>(read, offset);
  if (!identity || big_endian(*identity) != 0x18538067) return std::nullopt;
  offset += 4;
  const Size segment = ebml_size(read, offset);
  return segment ? sum(offset, *segment) : Size();
}

Size size_by_riff(const ReadAt& read, std::uint64_t file_bytes) {
  std::uint64_t offset = 0;
  while (offset < file_bytes) {
    const auto head = bytes_at<12>(read, offset);
    if (!head || !is_text(*head, 0, "RIFF") || !is_text(*head, 8, "AVI")) break;
    const std::uint64_t size = std::uint64_t{(*head)[4]} | std::uint64_t{(*head)[5]} << 8U |
                               std::uint64_t{(*head)[6]} << 16U | std::uint64_t{(*head)[7]} << 24U;
    if (size == 0 || size == 0xffffffffU) return std::nullopt;  // never closed
    offset += 8 + size;
  }
  return offset;
}

}  // namespace

std::optional<std::uint64_t> stated_size(const ReadAt& read, std::uint64_t file_bytes) {
  const auto head = bytes_at<12>(read, 0);
  if (!head) return std::nullopt;
  if (is_text(*head, 4, "ftyp")) return size_by_boxes(read, file_bytes);
  if (big_endian(std::span(*head).first(4)) == 0x1a45dfa3) return size_by_segment(read);
  if (is_text(*head, 0, "RIFF") && is_text(*head, 8, "AVI")) return size_by_riff(read, file_bytes);
  constexpr std::uint64_t kPacket = 188;
  const auto second = bytes_at<1>(read, kPacket), third = bytes_at<1>(read, 2 * kPacket);
  const bool is_transport = (*head)[0] == 0x47 && second && (*second)[0] == 0x47 && third && (*third)[0] == 0x47;
  return is_transport ? Size((file_bytes + kPacket - 1) / kPacket * kPacket) : Size();
}

}  // namespace moiregauge::internal
