// SPDX-License-Identifier: Apache-2.0
// Determines the time of a frame in an AVI, which is its number. After a loss libav continues the count as if nothing
// were missing. The index at the file's end gives the frame number of a chunk by its position.
#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/decoder/stream/video_stream.h"

namespace moiregauge::internal {
namespace {

constexpr std::int64_t kChunkHead = 8;  // bytes; an index contains the chunk's start, a packet that of its data

// Returns the entry of the chunk at `place`. The index is in order of position.
const AVIndexEntry* entry_at(AVStream* stream, std::int64_t place) {
  int low = 0, high = avformat_index_get_entries_count(stream);
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (avformat_index_get_entry(stream, middle)->pos < place)
      low = middle + 1;
    else
      high = middle;
  }
  const AVIndexEntry* entry = avformat_index_get_entry(stream, low);
  return entry != nullptr && entry->pos == place ? entry : nullptr;
}

// Returns true if complete chunks (sound, index, padding) fill the range between the two offsets.
bool chunks_lead(const ReadAt& read, std::uint64_t from, std::uint64_t to) {
  for (int chunks = 0; from < to && chunks < 1000; ++chunks) {
    std::array<std::uint8_t, 8> head{};
    if (read(from, head) != head.size()) return false;
    if (!std::all_of(head.begin(), head.begin() + 4, [](std::uint8_t c) { return c >= 0x20 && c < 0x7f; }))
      return false;
    const std::string_view name(reinterpret_cast<const char*>(head.data()), 4);
    const std::uint64_t size = std::uint64_t{head[4]} | std::uint64_t{head[5]} << 8U | std::uint64_t{head[6]} << 16U |
                               std::uint64_t{head[7]} << 24U;
    from += name == "LIST" || name == "RIFF" ? 12 : 8 + size + size % 2;
  }
  return from == to;
}

}  // namespace

// Corrects the packet's number. A packet missing in the index is the next one if complete chunks precede it. Otherwise
// its number is unknown.
bool VideoStream::note_count() {
  if (std::strcmp(container_->iformat->name, "avi") != 0 || packet_->pos < 0 || packet_->dts == AV_NOPTS_VALUE)
    return true;
  const AVIndexEntry* entry = entry_at(stream_, packet_->pos - kChunkHead);
  if (packets_ == 1) has_places_ = has_places_ && entry != nullptr;
  const std::int64_t head = packet_->pos - kChunkHead;
  const bool follows =
      packets_ == 1 || head < chunk_end_ ||  // chunks out of order: libav follows the index
      chunks_lead(reader_of(file_), static_cast<std::uint64_t>(chunk_end_), static_cast<std::uint64_t>(head));
  chunk_end_ = packet_->pos + packet_->size + packet_->size % 2;
  if (!has_places_) entry = nullptr;
  if (entry != nullptr && entry->timestamp > packet_->dts + count_shift_) {
    count_shift_ = entry->timestamp - packet_->dts;
    damage_.complaint(packets_);
  }
  if (entry == nullptr && !follows) {
    tear_ = VideoProblem{InputErrorKind::kDamaged, "data is missing, and an AVI file has no times",
                         "copy it again (earlier frames are valid)"};
    return false;
  }
  packet_->dts += count_shift_;
  if (packet_->pts != AV_NOPTS_VALUE) packet_->pts += count_shift_;
  return true;
}

}  // namespace moiregauge::internal
