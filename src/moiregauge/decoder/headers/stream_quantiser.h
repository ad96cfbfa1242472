// SPDX-License-Identifier: Apache-2.0
// Determines the codec's quantisation step of each frame, as far as the stream states it. Runs in the child only.
//
// H.264, VP9 and MPEG codecs report the parameter of every block. Motion JPEG has its tables in every packet, and
// lossless codecs lose nothing. HEVC's slice headers are read here, because libavcodec does not report them. The
// step of AV1 and others is unknown.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "moiregauge/decoder/headers/hevc_headers.h"
#include "moiregauge/image/quantiser.h"

extern "C" {
#include <libavcodec/avcodec.h>
}

namespace moiregauge::internal {

// Returns the step of a JPEG's luma table. Returns NaN if there is no table before the image data.
[[nodiscard]] double step_of_jpeg(std::span<const std::uint8_t> bytes);

class StreamQuantiser {
 public:
  // Requests the parameters from the decoder. Call it before the decoder is opened.
  static void ask(AVCodecContext& decoder);
  // Reads the parameter sets. Call it after the decoder is opened.
  void begin(const AVCodecContext& decoder);
  // Reads the step of packet `number`. A frame has the step of the packet in which it was coded.
  void note_packet(const AVCodecContext& decoder, const AVPacket& packet, std::int64_t number);
  // Reads the step of the last frame. Then blocks() has one byte per block of 16 px, rows packed, or is empty.
  void note_frame(const AVCodecContext& decoder, const AVFrame& frame, std::int64_t number);
  [[nodiscard]] Quantiser whole() const { return whole_; }
  [[nodiscard]] const std::vector<std::uint8_t>& blocks() const { return blocks_; }

 private:
  Quantiser whole_;
  std::vector<std::uint8_t> blocks_;
  double packet_step_ = kUnknownStep;
  HevcHeaders hevc_;
  // Steps of the last packets by their number. Decoders reorder frames (by at most 16) and use threads.
  std::array<double, 128> steps_{};
};

}  // namespace moiregauge::internal
