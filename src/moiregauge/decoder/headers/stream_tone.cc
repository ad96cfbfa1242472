// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/stream_tone.h"

#include <optional>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
}

namespace moiregauge::internal {
namespace {

using CurveKind = ToneCurve::Kind;

std::optional<ToneCurve> stated_curve(AVColorTransferCharacteristic transfer) {
  switch (transfer) {
    case AVCOL_TRC_BT709:
    case AVCOL_TRC_SMPTE170M:
    case AVCOL_TRC_SMPTE240M:
    case AVCOL_TRC_BT1361_ECG:
    case AVCOL_TRC_BT2020_10:
    case AVCOL_TRC_BT2020_12:
      return ToneCurve{.kind = CurveKind::kBt709};
    case AVCOL_TRC_IEC61966_2_1:
    case AVCOL_TRC_IEC61966_2_4:
      return ToneCurve{.kind = CurveKind::kSrgb};
    case AVCOL_TRC_GAMMA22:
      return ToneCurve{.kind = CurveKind::kGamma, .gamma = 2.2};
    case AVCOL_TRC_GAMMA28:
      return ToneCurve{.kind = CurveKind::kGamma, .gamma = 2.8};
    case AVCOL_TRC_LINEAR:
      return ToneCurve{};
    case AVCOL_TRC_ARIB_STD_B67:
      return ToneCurve{.kind = CurveKind::kHlg};
    case AVCOL_TRC_SMPTE2084:
      return ToneCurve{.kind = CurveKind::kPq};
    default:
      return std::nullopt;
  }
}

}  // namespace

Tone tone_of(const AVFrame& frame) {
  const AVPixFmtDescriptor* pixels = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  const bool is_grey = pixels != nullptr && pixels->nb_components < 3;
  const bool is_rgb = pixels != nullptr && (pixels->flags & AV_PIX_FMT_FLAG_RGB) != 0;
  const bool is_jpeg = frame.format == AV_PIX_FMT_YUVJ420P || frame.format == AV_PIX_FMT_YUVJ422P ||
                       frame.format == AV_PIX_FMT_YUVJ444P || frame.format == AV_PIX_FMT_YUVJ440P;
  Tone tone;
  if (const auto stated = stated_curve(frame.color_trc)) {
    tone = {*stated, ToneSource::kTag};
  } else if (!is_grey) {
    tone.curve.kind = is_rgb || is_jpeg ? CurveKind::kSrgb : CurveKind::kBt709;
  }
  tone.curve.is_full_range = is_grey || is_rgb || is_jpeg || frame.color_range == AVCOL_RANGE_JPEG;
  return tone;
}

}  // namespace moiregauge::internal
