// SPDX-License-Identifier: Apache-2.0
// Opens live streams: RTSP over TCP, HTTP and V4L2.
#include <dlfcn.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

extern "C" {
#include <libavdevice/avdevice.h>
#include <libavutil/opt.h>
}

#include "moiregauge/decoder/stream/live_address.h"
#include "moiregauge/decoder/stream/video_stream.h"

namespace moiregauge::internal {
namespace {

constexpr std::string_view kV4l2 = "v4l2:";
// Containers that HTTP cameras send. `mpjpeg` is what most browsers show as a moving image.
constexpr const char* kHttpContainers = "mpegts,matroska,mov,mpjpeg,mjpeg,h264,hevc,yuv4mpegpipe,avi";
constexpr const char* kHttpProtocols = "http,https,tcp,tls,crypto";
constexpr const char* kRtspProtocols = "rtsp,rtp,tcp,tls,crypto";
constexpr const char* kProbe_us = "2000000";  // chosen: a camera sends a key frame every second or two

class Options {
 public:
  Options() = default;
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;
  ~Options() { av_dict_free(&all_); }
  void set(const char* key, const std::string& value) { av_dict_set(&all_, key, value.c_str(), 0); }
  [[nodiscard]] AVDictionary** get() { return &all_; }

 private:
  AVDictionary* all_ = nullptr;
};

int is_late(void* deadline) { return static_cast<const LiveDeadline*>(deadline)->is_over() ? 1 : 0; }

int open_nothing(AVFormatContext* /*container*/, AVIOContext** /*bytes*/, const char* /*url*/, int /*flags*/,
                 AVDictionary** /*options*/) {
  return AVERROR(EPERM);
}

VideoProblem no_answer(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, text, sizeof text);
  const bool is_late_answer = error == AVERROR_EXIT;
  return {InputErrorKind::kUnreadable,
          fmt::format("the stream cannot be opened ({})", is_late_answer ? "no answer" : text),
          "check its address, user and password"};
}

// Registers libav's devices. The library is loaded here only, because it needs 60 others that no other run needs.
bool register_devices() {
  const std::string name = fmt::format("libavdevice.so.{}", LIBAVDEVICE_VERSION_MAJOR);
  void* library = ::dlopen(name.c_str(), RTLD_NOW);
  if (library == nullptr) return false;
  const auto start = reinterpret_cast<void (*)()>(::dlsym(library, "avdevice_register_all"));
  if (start != nullptr) start();
  return start != nullptr;
}

int open_rtsp(AVFormatContext*& container, const LiveAddress& address) {
  Options options;
  options.set("rtsp_transport", "tcp");
  options.set("allowed_media_types", "video");
  options.set("timeout", std::to_string(std::chrono::microseconds(address.timeout).count()));
  container->protocol_whitelist = av_strdup(kRtspProtocols);
  return avformat_open_input(&container, address.url.c_str(), av_find_input_format("rtsp"), options.get());
}

// Opens the connection only. The container is read by begin_live().
int open_http(AVFormatContext*& container, const LiveAddress& address) {
  Options options;
  options.set("protocol_whitelist", kHttpProtocols);
  options.set("timeout", std::to_string(std::chrono::microseconds(address.timeout).count()));
  options.set("seekable", "0");  // a seek would open another connection
  options.set("multiple_requests", "0");
  const int opened =
      avio_open2(&container->pb, address.url.c_str(), AVIO_FLAG_READ, &container->interrupt_callback, options.get());
  if (opened < 0) return opened;
  container->flags |= AVFMT_FLAG_CUSTOM_IO;
  container->format_whitelist = av_strdup(kHttpContainers);
  container->protocol_whitelist = av_strdup("");
  return 0;
}

int open_v4l2(AVFormatContext*& container, const LiveAddress& address) {
  const AVInputFormat* format = av_find_input_format("video4linux2");
  if (format == nullptr) return AVERROR_DEMUXER_NOT_FOUND;
  Options options;
  if (address.fps) options.set("framerate", fmt::format("{}", *address.fps));
  const std::string device = address.url.substr(kV4l2.size());
  return avformat_open_input(&container, device.c_str(), format, options.get());
}

}  // namespace

std::string text_of(const LiveAddress& address) {
  return fmt::format("{}\n{}\n{}\n", address.url, address.timeout.count(),
                     address.fps ? fmt::format("{}", *address.fps) : "");
}

std::optional<LiveAddress> live_address_of(std::string_view text) {
  LiveAddress address;
  const std::size_t first = text.find('\n');
  const std::size_t second = first == std::string_view::npos ? first : text.find('\n', first + 1);
  if (second == std::string_view::npos || !text.ends_with('\n')) return std::nullopt;
  address.url = text.substr(0, first);
  std::int64_t ms = 0;
  const auto [end, error] = std::from_chars(text.data() + first + 1, text.data() + second, ms);
  if (error != std::errc{} || end != text.data() + second || ms < 1) return std::nullopt;
  address.timeout = std::chrono::milliseconds(ms);
  const std::string_view rate = text.substr(second + 1, text.size() - second - 2);
  double fps = 0.0;
  const auto [rate_end, no_rate] = std::from_chars(rate.data(), rate.data() + rate.size(), fps);
  if (no_rate == std::errc{} && rate_end == rate.data() + rate.size()) address.fps = fps;
  return address;
}

tl::expected<std::unique_ptr<VideoStream>, VideoProblem> VideoStream::connect(const LiveAddress& address,
                                                                              std::int64_t max_pixels) {
  avformat_network_init();
  std::unique_ptr<VideoStream> stream(new VideoStream);
  stream->max_pixels_ = max_pixels;
  stream->deadline_ = std::make_unique<LiveDeadline>(address.timeout);
  stream->frame_ = av_frame_alloc();
  stream->packet_ = av_packet_alloc();
  stream->container_ = avformat_alloc_context();
  stream->container_->interrupt_callback = {&is_late, stream->deadline_.get()};
  int opened = 0;
  if (address.url.starts_with(kV4l2)) {
    if (!register_devices())
      return tl::unexpected(VideoProblem{InputErrorKind::kUnreadable, "libavdevice is not installed",
                                         fmt::format("install the package libavdevice{}", LIBAVDEVICE_VERSION_MAJOR)});
    opened = open_v4l2(stream->container_, address);
  } else if (address.url.starts_with("rtsp")) {
    opened = open_rtsp(stream->container_, address);
  } else {
    opened = open_http(stream->container_, address);
  }
  if (opened < 0) return tl::unexpected(no_answer(opened));
  stream->container_->io_open = &open_nothing;
  return stream;
}

tl::expected<void, VideoProblem> VideoStream::begin_live() {
  deadline_->restart();
  av_opt_set(container_, "analyzeduration", kProbe_us, 0);
  if ((container_->flags & AVFMT_FLAG_CUSTOM_IO) != 0) {
    if (avformat_open_input(&container_, "", nullptr, nullptr) < 0) return tl::unexpected(no_video_here());
  }
  if (auto problem = choose_stream()) return tl::unexpected(std::move(*problem));
  early_complaints_.clear();  // a stream is usually joined between two key frames
  if (!open_decoder())
    return tl::unexpected(VideoProblem{InputErrorKind::kUnsupported, "there is no decoder for " + codec(),
                                       "set the camera to H.264, H.265 or MJPEG"});
  errors_seen_ = errors_logged();
  return {};
}

bool VideoStream::has_camera_times() const {
  const std::string_view name = container_->iformat->name;
  for (const std::string_view timed : {"rtsp", "video4linux2", "mpegts", "matroska", "mov"}) {
    if (name.find(timed) != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace moiregauge::internal
