// SPDX-License-Identifier: Apache-2.0
// How coarsely a stream's codec rounded each frame, as far as the stream says. Runs in the child only.
//
// H.264, VP9 and the MPEGs report the parameter of every block; Motion JPEG carries its tables in every packet; lossless
// codecs lose nothing. HEVC's slice headers are read here, because libavcodec does not report them. The step of AV1 and
// others is not known.
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

// The luma's quantisation table of a JPEG: its step, NaN if none is found before the picture's data.
[[nodiscard]] double step_of_jpeg(std::span<const std::uint8_t> bytes);

class StreamQuantiser {
 public:
  // Before the decoder is opened.
  static void ask(AVCodecContext& decoder);
  // After it is opened.
  void begin(const AVCodecContext& decoder);
  // `number` counts packets; a frame has that of the packet it was coded in.
  void note_packet(const AVCodecContext& decoder, const AVPacket& packet, std::int64_t number);
  // The frame that came last; `blocks` has one byte per block of 16 px, rows packed, or none.
  void note_frame(const AVCodecContext& decoder, const AVFrame& frame, std::int64_t number);
  [[nodiscard]] Quantiser whole() const { return whole_; }
  [[nodiscard]] const std::vector<std::uint8_t>& blocks() const { return blocks_; }

 private:
  Quantiser whole_;
  std::vector<std::uint8_t> blocks_;
  double packet_step_ = kUnknownStep;
  HevcHeaders hevc_;
  // Steps of the last packets by their number, for a decoder that reorders frames (by 16 at most) and runs in threads.
  std::array<double, 128> steps_{};
};

}  // namespace moiregauge::internal
