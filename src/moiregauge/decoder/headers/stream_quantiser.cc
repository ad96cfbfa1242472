// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/stream_quantiser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

extern "C" {
#include <libavcodec/codec_desc.h>
#include <libavutil/pixdesc.h>
#include <libavutil/video_enc_params.h>
}

namespace moiregauge::internal {
namespace {

// Allowance: parameters by which a grating's blocks may be coarser than their slice (chosen). Only decoding gives the
// blocks' own.
constexpr int kCoarserBlocks = 3;

// Returns the luma step of VP9 in grey levels. The approximation of its table is accurate to 8 %, which is far below a
// step's uncertainty.
double step_of_vp9(int index) {
  const double eighths = index < 100 ? index + 8.0 : 108.0 * std::exp2((index - 100) / 38.0);
  return eighths / 8.0;
}

// Returns true for lossless blocks of H.264, which are not transformed (7.4.2.1.1,
// qpprime_y_zero_transform_bypass_flag).
bool is_bypassed(const AVCodecContext& decoder, int parameter) {
  return parameter <= 0 && decoder.profile == FF_PROFILE_H264_HIGH_444_PREDICTIVE;
}

// Returns the step in 8-bit grey levels. The scale is that of H.264 (H.265, 8.6.2). If blocks differ, adaptive
// quantisation makes blocks with contrast coarser, such as those of a grating.
double step_of_hevc(const std::optional<HevcQuantiser>& quantiser) {
  if (!quantiser) return kUnknownStep;
  return step_of_parameter(quantiser->parameter + (quantiser->varies ? kCoarserBlocks : 0));
}

double step_of_block(const AVCodecContext& decoder, const AVVideoEncParams& all, const AVVideoBlockParams& block) {
  const int parameter = all.qp + block.delta_qp;
  switch (all.type) {
    case AV_VIDEO_ENC_PARAMS_VP9:
      return step_of_vp9(std::clamp(parameter, 0, 255));
    case AV_VIDEO_ENC_PARAMS_H264:
      return is_bypassed(decoder, parameter) ? 0.0 : step_of_parameter(std::clamp(parameter, 0, kMaxParameter));
    case AV_VIDEO_ENC_PARAMS_MPEG2:
      return 2.0 * std::clamp(parameter, 1, 62);  // flat tables; the usual ones are coarser at high frequencies only
    default:
      return kUnknownStep;
  }
}

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

using JpegTables = std::array<std::optional<std::array<std::uint16_t, 64>>, 4>;

// Reads the tables of a DQT segment, which follow one another (ITU-T T.81, B.2.4.1).
void read_tables(std::span<const std::uint8_t> segment, JpegTables& tables) {
  while (!segment.empty()) {
    const bool wide = segment[0] >> 4 != 0;
    const std::size_t number = segment[0] & 15U, length = wide ? 129 : 65;
    if (number >= tables.size() || segment.size() < length) return;
    auto& table = tables[number].emplace();
    for (std::size_t k = 0; k < table.size(); ++k) table[k] = wide ? word(segment, 1 + 2 * k) : segment[1 + k];
    segment = segment.subspan(length);
  }
}

}  // namespace

double step_of_jpeg(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kTables = 0xdb, kScan = 0xda, kFirstFrame = 0xc0, kLastBaseline = 0xc2;
  JpegTables tables;
  std::size_t luma = 0;
  for (std::size_t at = 2; at + 4 <= bytes.size() && bytes[at] == 0xff;) {
    const std::uint8_t marker = bytes[at + 1];
    const std::size_t length = word(bytes, at + 2);
    if (marker == kScan || length < 2 || at + 2 + length > bytes.size()) break;
    const auto segment = bytes.subspan(at + 4, length - 2);
    if (marker == kTables) read_tables(segment, tables);
    if (marker >= kFirstFrame && marker <= kLastBaseline && segment.size() >= 9) luma = segment[8];
    at += 2 + length;
  }
  return luma < tables.size() && tables[luma] ? step_of_jpeg_table(*tables[luma]) : kUnknownStep;
}

void StreamQuantiser::ask(AVCodecContext& decoder) {
  decoder.export_side_data |= AV_CODEC_EXPORT_DATA_VIDEO_ENC_PARAMS;
}

void StreamQuantiser::begin(const AVCodecContext& decoder) {
  steps_.fill(kUnknownStep);
  if (decoder.codec_id == AV_CODEC_ID_HEVC && decoder.extradata != nullptr && decoder.extradata_size > 0)
    hevc_.read_extradata({decoder.extradata, static_cast<std::size_t>(decoder.extradata_size)});
}

void StreamQuantiser::note_packet(const AVCodecContext& decoder, const AVPacket& packet, std::int64_t number) {
  if (packet.data == nullptr || packet.size <= 0) return;
  const std::span bytes(packet.data, static_cast<std::size_t>(packet.size));
  if (decoder.codec_id == AV_CODEC_ID_MJPEG) packet_step_ = step_of_jpeg(bytes);
  if (decoder.codec_id == AV_CODEC_ID_HEVC)
    steps_[static_cast<std::size_t>(number) % steps_.size()] = step_of_hevc(hevc_.read_packet(bytes));
}

void StreamQuantiser::note_frame(const AVCodecContext& decoder, const AVFrame& frame, std::int64_t number) {
  blocks_.clear();
  const AVCodecDescriptor* about = avcodec_descriptor_get(decoder.codec_id);
  const int properties = about == nullptr ? AV_CODEC_PROP_LOSSY : about->props;
  whole_ = {kUnknownStep, (properties & AV_CODEC_PROP_INTRA_ONLY) == 0};
  if ((properties & AV_CODEC_PROP_LOSSY) == 0) whole_.step = 0.0;
  if (decoder.codec_id == AV_CODEC_ID_MJPEG) whole_.step = packet_step_;
  if (decoder.codec_id == AV_CODEC_ID_HEVC) {
    const AVPixFmtDescriptor* pixels = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    const int more_bits = pixels == nullptr ? 0 : pixels->comp[0].depth - 8;
    whole_.step = std::ldexp(steps_[static_cast<std::size_t>(number) % steps_.size()], more_bits);
  }
  const AVFrameSideData* side = av_frame_get_side_data(&frame, AV_FRAME_DATA_VIDEO_ENC_PARAMS);
  if (side == nullptr) return;
  const auto& all = *reinterpret_cast<const AVVideoEncParams*>(side->data);
  const int across = blocks_across(frame.width), down = blocks_across(frame.height);
  blocks_.assign(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 0);
  double sum = 0.0;
  for (unsigned k = 0; k < all.nb_blocks; ++k) {
    const AVVideoBlockParams& block = *av_video_enc_params_block(const_cast<AVVideoEncParams*>(&all), k);
    const double step = step_of_block(decoder, all, block);
    sum += step;
    const int x0 = std::max(0, block.src_x / kQuantiserBlock), y0 = std::max(0, block.src_y / kQuantiserBlock);
    const int x1 = std::min(across, blocks_across(block.src_x + block.w));
    const int y1 = std::min(down, blocks_across(block.src_y + block.h));
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        auto& parameter = blocks_[static_cast<std::size_t>(y * across + x)];
        parameter = std::max(parameter, parameter_of_step(step));
      }
  }
  if (all.nb_blocks > 0) whole_.step = sum / all.nb_blocks;
  if (all.nb_blocks == 0 || !(whole_.step > 0.0)) blocks_.clear();
}

}  // namespace moiregauge::internal
