// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/network/network_source.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/camera/common/camera_clock.h"
#include "moiregauge/camera/common/host_time.h"
#include "moiregauge/camera/common/retry_times.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using Opened = tl::expected<std::unique_ptr<LiveVideo>, InputError>;

// Streams may begin at or before time 0, and the clock regards 0 as no time. One year is beyond that.
constexpr double kClockShift_s = 365.0 * 86400.0;

class NetworkSource final : public LiveSource {
 public:
  NetworkSource(LiveAddress address, const NetworkOptions& options, DecoderOptions decoder)
      : address_(std::move(address)), options_(options), decoder_(std::move(decoder)), retry_(options.patience) {}

  [[nodiscard]] tl::expected<void, InputError> open() {
    auto video = LiveVideo::open(address_, options_.max_pixels, decoder_);
    if (!video) return tl::unexpected(video.error());
    video_ = std::move(*video);
    info_ = video_->info();
    info_.frames = -1;
    info_.time_source = video_->has_camera_times() ? "camera" : "host";
    return {};
  }

  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] LostFrames lost() const override {
    LostFrames all = lost_;
    all.queue_full += queue_full_;
    all.incomplete += undecoded_;
    return all;
  }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings() const override {
    return {{"codec", info_.codec},
            {"timeout_s", fmt::format("{:g}", 1e-3 * static_cast<double>(address_.timeout.count()))}};
  }

  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(milliseconds timeout) override {
    const auto until = steady_clock::now() + timeout;
    do {
      if (!video_ && !reconnect(until)) {
        if (end_) break;
        return std::nullopt;
      }
      const auto left = std::max(std::chrono::ceil<milliseconds>(until - steady_clock::now()), milliseconds(0));
      auto received = video_->next(left);
      if (!received)
        disconnect();
      else if (!*received)
        return std::nullopt;
      else if (auto frame = accept(**received))
        return frame;
    } while (!end_);
    return tl::unexpected(*end_);
  }

 private:
  void disconnect() {
    lost_.queue_full += std::exchange(queue_full_, 0);
    lost_.incomplete += std::exchange(undecoded_, 0);
    video_.reset();
    first_of_connection_ = next_;
    retry_.begin();
  }

  // Connects on another thread, so that next() returns in time. Returns true once there is a connection.
  [[nodiscard]] bool reconnect(steady_clock::time_point until) {
    if (!attempt_.valid()) {
      if (!retry_.wait(until)) return false;
      attempt_ = std::async(std::launch::async, [address = address_, pixels = options_.max_pixels, decoder = decoder_] {
        return LiveVideo::open(address, pixels, decoder);
      });
    }
    if (attempt_.wait_until(until) != std::future_status::ready) return false;
    Opened video = attempt_.get();
    if (!video) {
      if (retry_.failed())
        end_ =
            SourceEnd{SourceEnd::Kind::kLost,
                      fmt::format("the stream was lost: {}: check camera and network, then use --resume", info_.path)};
      return false;
    }
    const InputInfo& now = (*video)->info();
    if (now.width != info_.width || now.height != info_.height || now.bits != info_.bits) {
      end_ = SourceEnd{SourceEnd::Kind::kLost,
                       fmt::format("the frame size changed from {}x{} to {}x{}: {}: start another run", info_.width,
                                   info_.height, now.width, now.height, info_.path)};
      return false;
    }
    video_ = std::move(*video);
    ++lost_.reconnects;
    return true;
  }

  [[nodiscard]] std::optional<LiveFrame> accept(const LiveVideoFrame& received) {
    queue_full_ = static_cast<long>(received.queue_full);
    undecoded_ = static_cast<long>(received.undecoded);
    const long number = first_of_connection_ + received.frame.number;
    next_ = number + 1;
    if (received.frame.damaged) {
      if (has_started_) ++lost_.incomplete;
      return std::nullopt;
    }
    // libav knows the time of an RTSP stream's first frame only afterwards.
    const bool has_time = !video_->has_camera_times() || std::isfinite(received.frame.time_s);
    if (!has_started_ && !has_time) return std::nullopt;
    if (!std::exchange(has_started_, true)) {
      info_.start_utc = utc_now_text();
      first_number_ = number;
      undecoded_ = 0;
    }
    LiveFrame out;
    out.host_ns = received.host_ns;
    if (video_->has_camera_times() && std::isfinite(received.frame.time_s))
      out.device_ns = std::llround(1e9 * (received.frame.time_s + kClockShift_s));
    out.frame = received.frame;
    out.frame.number = number - first_number_;
    out.frame.time_s = clock_.time_s(out.device_ns, out.host_ns);
    return out;
  }

  LiveAddress address_;
  NetworkOptions options_;
  DecoderOptions decoder_;
  RetryTimes retry_;
  std::unique_ptr<LiveVideo> video_;  // null: the stream is lost
  std::future<Opened> attempt_;
  InputInfo info_;
  CameraClock clock_;
  LostFrames lost_;
  long queue_full_ = 0;  // since the connection
  long undecoded_ = 0;
  long first_of_connection_ = 0;
  long next_ = 0;
  bool has_started_ = false;
  long first_number_ = 0;
  std::optional<SourceEnd> end_;
};

}  // namespace

tl::expected<std::unique_ptr<LiveSource>, InputError> open_network(const LiveAddress& address,
                                                                   const NetworkOptions& options,
                                                                   const DecoderOptions& decoder) {
  auto source = std::make_unique<NetworkSource>(address, options, decoder);
  if (auto opened = source->open(); !opened) return tl::unexpected(opened.error());
  return std::unique_ptr<LiveSource>(std::move(source));
}

}  // namespace moiregauge::internal
