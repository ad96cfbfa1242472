// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/cluster_sums.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

extern "C" {
#include <libavutil/crc.h>
}

namespace moiregauge::internal {
namespace {

struct Head {
  std::uint64_t identity = 0;
  std::uint64_t begin = 0;  // offset of the content
  std::optional<std::uint64_t> size;
};

std::size_t length_of(std::uint8_t first) {
  std::size_t length = 1;
  while (length <= 8 && (first & (0x80U >> (length - 1))) == 0) ++length;
  return length;
}

std::optional<Head> head_at(const ReadAt& read, std::uint64_t place) {
  std::array<std::uint8_t, 12> bytes{};
  const std::size_t got = read(place, bytes);
  const std::size_t name = length_of(bytes[0]);
  if (name > 4 || name >= got) return std::nullopt;
  const std::size_t number = length_of(bytes[name]);
  if (number > 8 || name + number > got) return std::nullopt;
  Head head{0, place + name + number, std::uint64_t{0}};
  for (std::size_t i = 0; i < name; ++i) head.identity = head.identity << 8U | bytes[i];
  for (std::size_t i = 0; i < number; ++i) *head.size = *head.size << 8U | bytes[name + i];
  const std::uint64_t all_ones = (std::uint64_t{1} << (7 * number)) - 1;
  *head.size &= all_ones;
  if (*head.size == all_ones) head.size.reset();  // unknown when it was written
  return head;
}

constexpr std::uint64_t kFile = 0x1A45DFA3, kSegment = 0x18538067;

}  // namespace

ClusterSums::ClusterSums(ReadAt read) : read_(std::move(read)) {
  const auto file = head_at(read_, 0);
  if (!file || file->identity != kFile || !file->size) return;
  const auto segment = head_at(read_, file->begin + *file->size);
  if (segment && segment->identity == kSegment) next_ = segment->begin;
}

bool ClusterSums::agree_up_to(std::uint64_t place) {
  while (next_ && *next_ <= place) {
    const auto part = head_at(read_, *next_);
    if (!part || !part->size || *part->size > (std::uint64_t{1} << 40)) {
      next_.reset();
      break;
    }
    const std::uint64_t end = part->begin + *part->size;
    agree_ = agree_ && agrees(part->begin, end);
    next_ = end;
  }
  return agree_;
}

bool ClusterSums::agrees(std::uint64_t begin, std::uint64_t end) const {
  std::array<std::uint8_t, 6> first{};
  if (end - begin < first.size() || read_(begin, first) != first.size()) return true;
  if (first[0] != 0xBF || first[1] != 0x84) return true;  // no check sum
  const std::uint32_t stated = std::uint32_t{first[2]} | std::uint32_t{first[3]} << 8U |
                               std::uint32_t{first[4]} << 16U | std::uint32_t{first[5]} << 24U;
  const AVCRC* table = av_crc_get_table(AV_CRC_32_IEEE_LE);
  std::uint32_t sum = 0xffffffffU;
  std::vector<std::uint8_t> block(1 << 16);
  for (std::uint64_t place = begin + first.size(); place < end;) {
    const std::size_t wanted = static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), end - place));
    const std::size_t got = read_(place, std::span(block).first(wanted));
    if (got == 0) return true;  // truncated: reported elsewhere
    sum = av_crc(table, sum, block.data(), got);
    place += got;
  }
  return (sum ^ 0xffffffffU) == stated;
}

}  // namespace moiregauge::internal
