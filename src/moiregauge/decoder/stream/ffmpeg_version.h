// SPDX-License-Identifier: Apache-2.0
// The differences between FFmpeg 5 (Debian 12) and FFmpeg 7 (Debian 13).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace moiregauge::internal {

// A frame carries the number of its packet through the decoder, which changes the order. Call `copy_packet_numbers`
// before the decoder is opened.

#if LIBAVCODEC_VERSION_MAJOR >= 61

inline void copy_packet_numbers(AVCodecContext& decoder) { decoder.flags |= AV_CODEC_FLAG_COPY_OPAQUE; }

inline void set_packet_number(AVCodecContext& /*decoder*/, AVPacket& packet, std::int64_t number) {
  packet.opaque = reinterpret_cast<void*>(static_cast<std::intptr_t>(number));
}

[[nodiscard]] inline std::optional<std::int64_t> packet_number(const AVFrame& frame) {
  if (frame.opaque == nullptr) return std::nullopt;
  return static_cast<std::int64_t>(reinterpret_cast<std::intptr_t>(frame.opaque));
}

[[nodiscard]] inline bool is_interlaced(const AVFrame& frame) { return (frame.flags & AV_FRAME_FLAG_INTERLACED) != 0; }

[[nodiscard]] inline std::span<const std::uint8_t> display_matrix(const AVStream& stream) {
  const AVCodecParameters& stored = *stream.codecpar;
  const auto* found =
      av_packet_side_data_get(stored.coded_side_data, stored.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  return found == nullptr ? std::span<const std::uint8_t>() : std::span(found->data, found->size);
}

#else

inline void copy_packet_numbers(AVCodecContext& /*decoder*/) {}

inline void set_packet_number(AVCodecContext& decoder, AVPacket& /*packet*/, std::int64_t number) {
  decoder.reordered_opaque = number;
}

[[nodiscard]] inline std::optional<std::int64_t> packet_number(const AVFrame& frame) {
  return frame.reordered_opaque > 0 ? std::optional(frame.reordered_opaque) : std::nullopt;
}

[[nodiscard]] inline bool is_interlaced(const AVFrame& frame) { return frame.interlaced_frame != 0; }

[[nodiscard]] inline std::span<const std::uint8_t> display_matrix(const AVStream& stream) {
  std::size_t size = 0;
  const std::uint8_t* data = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &size);
  return data == nullptr ? std::span<const std::uint8_t>() : std::span(data, size);
}

#endif

}  // namespace moiregauge::internal
