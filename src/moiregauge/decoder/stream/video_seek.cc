// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stream/video_stream.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kTestEvery = 256;  // packets; each test reads all notes once

std::optional<std::int64_t> time_if_known(std::int64_t time) {
  return time == AV_NOPTS_VALUE ? std::nullopt : std::optional(time);
}

}  // namespace

std::vector<PacketNote> VideoStream::note_packets(long wanted) {
  std::vector<PacketNote> notes;
  while (read_packet()) {
    notes.push_back({time_if_known(packet_->pts), time_if_known(packet_->dts), (packet_->flags & AV_PKT_FLAG_KEY) != 0,
                     (packet_->flags & AV_PKT_FLAG_DISCARD) != 0});
    if (notes.size() % kTestEvery == 0 && is_enough(notes, wanted)) break;
  }
  return notes;
}

bool VideoStream::skip_to(std::int64_t packet) {
  if (packets_ > packet) return false;
  avcodec_flush_buffers(decoder_);
  while (packets_ < packet) {
    if (!read_packet()) return false;
  }
  return true;
}

}  // namespace moiregauge::internal
