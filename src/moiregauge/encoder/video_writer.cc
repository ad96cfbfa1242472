// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/encoder/video_writer.h"

#include <cmath>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

namespace moiregauge::internal {
namespace {

constexpr int kTicksPerSecond = 90000;

std::string words_of(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, text, sizeof text);
  return text;
}

struct Freed {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFormatContext* context) const {
    if (context->pb != nullptr) avio_closep(&context->pb);
    avformat_free_context(context);
  }
};
template <typename Of>
using Owned = std::unique_ptr<Of, Freed>;

AVPixelFormat layout_of(const VideoFormat& format) {
  if (format.codec == VideoCodec::kX264) return AV_PIX_FMT_YUV420P;
  if (format.codec == VideoCodec::kMjpeg) return AV_PIX_FMT_YUVJ420P;
  switch (format.bits) {
    case 9:
      return AV_PIX_FMT_GRAY9;
    case 10:
      return AV_PIX_FMT_GRAY10;
    case 12:
      return AV_PIX_FMT_GRAY12;
    case 16:
      return AV_PIX_FMT_GRAY16;
    default:
      return AV_PIX_FMT_GRAY8;
  }
}

const AVCodec* encoder_of(VideoCodec codec) {
  if (codec == VideoCodec::kX264) return avcodec_find_encoder_by_name("libx264");
  return avcodec_find_encoder(codec == VideoCodec::kMjpeg ? AV_CODEC_ID_MJPEG : AV_CODEC_ID_FFV1);
}

class LibavWriter : public VideoWriter {
 public:
  LibavWriter(std::string path, const VideoFormat& format) : path_(std::move(path)), format_(format) {}

  tl::expected<void, std::string> open() {
    av_log_set_level(AV_LOG_ERROR);  // show errors only
    AVFormatContext* file = nullptr;
    if (const int e = avformat_alloc_output_context2(&file, nullptr, nullptr, path_.c_str()); e < 0) return failed(e);
    file_.reset(file);
    file_->flags |= AVFMT_FLAG_BITEXACT;
    if (const int e = open_encoder(); e < 0) return failed(e);
    stream_ = avformat_new_stream(file_.get(), nullptr);
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    if (stream_ == nullptr || !frame_ || !packet_) return failed(AVERROR(ENOMEM));
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = encoder_->framerate;
    if (const int e = avcodec_parameters_from_context(stream_->codecpar, encoder_.get()); e < 0) return failed(e);
    if (const int e = avio_open(&file_->pb, path_.c_str(), AVIO_FLAG_WRITE); e < 0) return failed(e);
    AVDictionary* words = nullptr;
    if (format_.faststart) av_dict_set(&words, "movflags", "faststart", 0);
    const int begun = avformat_write_header(file_.get(), &words);
    av_dict_free(&words);
    if (begun < 0) return failed(begun);
    return {};
  }

  tl::expected<void, std::string> add(const LumaView& picture, double time_s) override {
    if (const int e = new_frame(); e < 0) return failed(e);
    std::visit([&](const auto& view) { copy(view); }, picture);
    frame_->pts = std::llround(time_s * kTicksPerSecond) - first_tick(time_s);
    frame_->quality = encoder_->global_quality;
    if (const int e = avcodec_send_frame(encoder_.get(), frame_.get()); e < 0) return failed(e);
    return write_packets();
  }

  tl::expected<void, std::string> finish() override {
    if (const int e = avcodec_send_frame(encoder_.get(), nullptr); e < 0) return failed(e);
    if (auto written = write_packets(); !written) return written;
    if (const int e = av_write_trailer(file_.get()); e < 0) return failed(e);
    if (const int e = avio_closep(&file_->pb); e < 0) return failed(e);
    return {};
  }

 private:
  [[nodiscard]] tl::expected<void, std::string> failed(int error) const {
    return tl::unexpected(fmt::format("{}: {}", path_, words_of(error)));
  }

  int open_encoder() {
    const AVCodec* codec = encoder_of(format_.codec);
    if (codec == nullptr) return AVERROR_ENCODER_NOT_FOUND;
    encoder_.reset(avcodec_alloc_context3(codec));
    if (!encoder_) return AVERROR(ENOMEM);
    encoder_->width = format_.width;
    encoder_->height = format_.height;
    encoder_->pix_fmt = layout_of(format_);
    encoder_->time_base = {1, kTicksPerSecond};
    encoder_->framerate = av_d2q(format_.fps, 1000000);
    encoder_->gop_size = format_.gop;
    if (format_.is_linear) encoder_->color_trc = AVCOL_TRC_LINEAR;
    encoder_->thread_count = 1;  // files must be reproducible: x264's decisions depend on its threads
    encoder_->flags |= AV_CODEC_FLAG_BITEXACT;
    encoder_->log_level_offset = AV_LOG_INFO - AV_LOG_ERROR;  // show errors only: x264 reports success as well
    if ((file_->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    choose_quality();
    return avcodec_open2(encoder_.get(), codec, nullptr);
  }

  void choose_quality() {
    if (format_.codec == VideoCodec::kX264) {
      av_opt_set(encoder_->priv_data, "preset", "medium", 0);
      av_opt_set_double(encoder_->priv_data, "crf", format_.quality.value_or(23), 0);
    }
    if (format_.codec == VideoCodec::kFfv1) {
      encoder_->level = 3;
      av_opt_set_int(encoder_->priv_data, "slicecrc", 1, 0);
    }
    if (format_.codec != VideoCodec::kMjpeg) return;
    const int q = format_.quality.value_or(3);
    encoder_->flags |= AV_CODEC_FLAG_QSCALE;
    encoder_->global_quality = q * FF_QP2LAMBDA;
    encoder_->qmin = encoder_->qmax = q;
  }

  // The encoder may keep a reference to the last frame's buffer, so each frame has its own.
  int new_frame() {
    av_frame_unref(frame_.get());
    frame_->format = encoder_->pix_fmt;
    frame_->width = format_.width;
    frame_->height = format_.height;
    if (const int e = av_frame_get_buffer(frame_.get(), 0); e < 0) return e;
    for (int plane = 1; plane < 3; ++plane) {
      if (frame_->data[plane] == nullptr) break;
      const auto size =
          static_cast<std::size_t>(frame_->linesize[plane]) * static_cast<std::size_t>(format_.height / 2);
      std::memset(frame_->data[plane], 128, size);
    }
    return 0;
  }

  template <typename Grey>
  void copy(const ImageView<Grey>& view) {
    for (int y = 0; y < view.height; ++y) {
      const auto row = view.row(y);
      std::memcpy(frame_->data[0] + static_cast<std::ptrdiff_t>(y) * frame_->linesize[0], row.data(), row.size_bytes());
    }
  }

  // Returns the first frame's time in ticks. It is subtracted, so that no time stamp in the file is negative.
  std::int64_t first_tick(double time_s) {
    if (!first_tick_) first_tick_ = std::llround(time_s * kTicksPerSecond);
    return *first_tick_;
  }

  tl::expected<void, std::string> write_packets() {
    while (true) {
      const int e = avcodec_receive_packet(encoder_.get(), packet_.get());
      if (e == AVERROR(EAGAIN) || e == AVERROR_EOF) return {};
      if (e < 0) return failed(e);
      // FFmpeg 7's MP4 would otherwise end at the beginning of the last frame.
      if (format_.codec == VideoCodec::kX264 && packet_->duration == 0)
        packet_->duration = std::llround(kTicksPerSecond / format_.fps);
      av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      if (const int w = av_interleaved_write_frame(file_.get(), packet_.get()); w < 0) return failed(w);
    }
  }

  std::string path_;
  VideoFormat format_;
  Owned<AVFormatContext> file_;
  Owned<AVCodecContext> encoder_;
  Owned<AVFrame> frame_;
  Owned<AVPacket> packet_;
  AVStream* stream_ = nullptr;
  std::optional<std::int64_t> first_tick_;
};

}  // namespace

tl::expected<std::unique_ptr<VideoWriter>, std::string> VideoWriter::create(const std::string& path,
                                                                            const VideoFormat& format) {
  if (const auto problem = problem_with(format)) return tl::unexpected(fmt::format("{}: {}", path, *problem));
  auto writer = std::make_unique<LibavWriter>(path, format);
  if (auto opened = writer->open(); !opened) return tl::unexpected(std::move(opened.error()));
  return writer;
}

}  // namespace moiregauge::internal
