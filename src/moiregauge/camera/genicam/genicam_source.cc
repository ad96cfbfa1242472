// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/genicam/genicam_source.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/camera/common/camera_clock.h"
#include "moiregauge/camera/common/host_time.h"
#include "moiregauge/camera/common/retry_times.h"
#include "moiregauge/camera/genicam/genicam_stream.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// A free-running camera that sends nothing for this long is lost, although it may still answer (chosen).
std::chrono::duration<double> max_silence(double fps) {
  constexpr double kMin_s = 2.0, kFrames = 50.0, kUnknownRate_s = 10.0;
  return std::chrono::duration<double>(fps > 0.0 ? std::max(kMin_s, kFrames / fps) : kUnknownRate_s);
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

class GenicamSource final : public LiveSource {
 public:
  GenicamSource(std::string id, const GenicamSettings& settings)
      : id_(std::move(id)), settings_(settings), retry_(settings.patience) {}

  // Connects for the first time. Completes info().
  [[nodiscard]] tl::expected<void, InputError> open() {
    auto stream = GenicamStream::start(id_, settings_);
    if (!stream) return tl::unexpected(stream.error());
    stream_ = std::move(*stream);
    last_frame_at_ = steady_clock::now();
    if (id_.empty()) {
      GlibError error;
      id_ = text_or_empty(arv_camera_get_device_id(&stream_->camera(), error.out()));  // the same camera after a loss
    }
    describe();
    if (info_.width < 1 || info_.height < 1)
      return tl::unexpected(
          InputError{InputErrorKind::kUnsupported, "the camera states no frame size: camera: set --sensor-region"});
    return {};
  }

  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings() const override { return texts_; }
  [[nodiscard]] LostFrames lost() const override { return lost_; }

  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(milliseconds timeout) override {
    const auto until = steady_clock::now() + timeout;
    give_back();
    while (!end_) {
      if (!stream_ && !reconnect(until)) {
        if (end_) break;
        return std::nullopt;
      }
      const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now());
      const ReceivedFrame received = stream_->receive(std::clamp(left, milliseconds(0), milliseconds(100)));
      if (received.buffer != nullptr) {
        last_frame_at_ = steady_clock::now();
        if (auto frame = accept(received)) return frame;
      } else if (is_lost()) {
        disconnect();
      }
      if (steady_clock::now() >= until && !end_ && received.buffer == nullptr) return std::nullopt;
    }
    return tl::unexpected(*end_);
  }

 private:
  void describe() {
    GlibError error;
    SensorRegion region;
    arv_camera_get_region(&stream_->camera(), &region.x, &region.y, &region.width, &region.height, error.out());
    const RawLayout layout =
        raw_layout(arv_camera_get_pixel_format(&stream_->camera(), error.out())).value_or(RawLayout{});
    converter_.emplace(layout, settings_.mosaic);
    width_ = region.width;
    height_ = region.height;
    info_.path = "camera:" + id_;
    info_.width = layout.is_mosaic() ? width_ / 2 : width_;
    info_.height = layout.is_mosaic() ? height_ / 2 : height_;
    info_.bits = layout.bits;
    info_.fps = std::numeric_limits<double>::quiet_NaN();
    if (settings_.trigger.empty() && arv_camera_is_frame_rate_available(&stream_->camera(), error.out())) {
      const double rate = arv_camera_get_frame_rate(&stream_->camera(), error.out());
      if (!error && rate > 0.0) info_.fps = rate;
    }
    info_.codec = "genicam-" + lower_case(layout.name);
    info_.time_source = "camera";
    info_.tone = {{ToneCurve::Kind::kLinear, 1.0, true}, ToneSource::kAssumed};
    texts_ = settings_of(stream_->camera());
    if (layout.is_mosaic()) texts_.emplace_back("mosaic", settings_.mosaic == MosaicGrey::kGreen ? "green" : "luma");
  }

  [[nodiscard]] bool is_lost() const {
    const bool is_silent = settings_.trigger.empty() && steady_clock::now() - last_frame_at_ > max_silence(info_.fps);
    return stream_->is_control_lost() || is_silent;
  }

  void give_back() {
    if (held_ != nullptr && stream_) stream_->give_back(held_);
    held_ = nullptr;
  }

  void disconnect() {
    held_ = nullptr;
    underruns_ = 0;
    stream_->abandon();
    stream_.reset();
    retry_.begin();
  }

  // Returns true once the camera is back.
  [[nodiscard]] bool reconnect(steady_clock::time_point until) {
    if (!retry_.wait(until)) return false;
    auto stream = GenicamStream::start(id_, settings_);
    if (!stream) {
      if (retry_.failed())
        end_ = SourceEnd{SourceEnd::Kind::kLost,
                         fmt::format("the camera was lost: {}: check cable and power, then use --resume", info_.path)};
      return false;
    }
    stream_ = std::move(*stream);
    counter_.restart();
    incomplete_since_ = 0;
    last_frame_at_ = steady_clock::now();
    ++lost_.reconnects;
    return true;
  }

  // Returns the frame if it is complete. Ends the source if its size has changed.
  [[nodiscard]] std::optional<LiveFrame> accept(const ReceivedFrame& received) {
    held_ = received.buffer;
    const ArvBufferStatus status = arv_buffer_get_status(held_);
    if (status == ARV_BUFFER_STATUS_CLEARED || status == ARV_BUFFER_STATUS_ABORTED) return refuse();  // never sent
    if (!received.is_complete || arv_buffer_get_payload_type(held_) != ARV_BUFFER_PAYLOAD_TYPE_IMAGE) {
      // Its identifier may be that of an earlier frame in the same buffer, because the packet with it may be missing.
      ++lost_.incomplete;
      ++incomplete_since_;
      return refuse();
    }
    const long number = count(arv_buffer_get_frame_id(held_));
    RawPixels raw;
    std::size_t bytes = 0;
    const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_image_data(held_, &bytes));
    raw.bytes = {data, bytes};
    int x = 0, y = 0, y_padding = 0;
    arv_buffer_get_image_region(held_, &x, &y, &raw.width, &raw.height);
    arv_buffer_get_image_padding(held_, &raw.padding_bytes, &y_padding);
    if (raw.width != width_ || raw.height != height_) {
      end_ = SourceEnd{SourceEnd::Kind::kLost,
                       fmt::format("the frame size changed from {}x{} to {}x{}: {}: set --sensor-region", width_,
                                   height_, raw.width, raw.height, info_.path)};
      return refuse();
    }
    auto luma = converter_->luma(raw);
    if (!luma) {
      ++lost_.incomplete;
      return refuse();
    }
    return frame_of(number, *luma, received.host_ns);
  }

  // Returns the number of a complete frame. A gap before it that incomplete frames do not explain is a loss.
  [[nodiscard]] long count(std::uint64_t id) {
    const long missing = counter_.missing();
    const long number = counter_.number_of(id);
    const long unexplained = counter_.missing() - missing - std::exchange(incomplete_since_, 0);
    if (unexplained > 0) attribute(unexplained);
    return number;
  }

  // Counts frames that never arrived. Aravis counts the packets that found no buffer.
  void attribute(long frames) {
    const long underruns = stream_->underruns();
    (underruns > underruns_ ? lost_.queue_full : lost_.in_camera) += frames;
    underruns_ = underruns;
  }

  std::optional<LiveFrame> refuse() {
    give_back();
    return std::nullopt;
  }

  [[nodiscard]] LiveFrame frame_of(long number, const LumaView& luma, std::int64_t host_ns) {
    LiveFrame out;
    const auto device_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(held_));
    if (device_ns > 0) out.device_ns = device_ns;
    if (info_.start_utc.empty()) {
      info_.start_utc = utc_now_text();
      if (!out.device_ns) info_.time_source = "host";
      first_number_ = number;
      lost_ = {};  // earlier ones have no number
    }
    out.host_ns = host_ns;
    out.frame.number = number - first_number_;
    out.frame.time_s = clock_.time_s(out.device_ns, host_ns);
    out.frame.luma = luma;
    out.queued = stream_->queued();
    return out;
  }

  std::string id_;
  GenicamSettings settings_;
  RetryTimes retry_;
  std::unique_ptr<GenicamStream> stream_;  // null: the camera is lost
  InputInfo info_;
  std::vector<std::pair<std::string, std::string>> texts_;
  std::optional<RawToLuma> converter_;
  int width_ = 0;  // px of the sensor
  int height_ = 0;
  FrameCounter counter_;
  CameraClock clock_;
  LostFrames lost_;
  long underruns_ = 0;         // packets, when a frame was last missing
  long incomplete_since_ = 0;  // incomplete frames since the last complete one
  ArvBuffer* held_ = nullptr;  // pixels of the frame delivered last
  long first_number_ = 0;      // incomplete frames before the first complete one
  steady_clock::time_point last_frame_at_;
  std::optional<SourceEnd> end_;
};

}  // namespace

tl::expected<std::unique_ptr<LiveSource>, InputError> open_genicam(const std::string& id,
                                                                   const GenicamSettings& settings) {
  auto source = std::make_unique<GenicamSource>(id, settings);
  if (auto opened = source->open(); !opened) return tl::unexpected(opened.error());
  return std::unique_ptr<LiveSource>(std::move(source));
}

std::vector<FoundCamera> find_genicam_cameras() {
  arv_update_device_list();
  std::vector<FoundCamera> found;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    found.push_back(
        {text_or_empty(arv_get_device_id(i)),
         fmt::format("{} {} {}", text_or_empty(arv_get_device_vendor(i)), text_or_empty(arv_get_device_model(i)),
                     text_or_empty(arv_get_device_serial_nbr(i))),
         fmt::format("{} {}", text_or_empty(arv_get_device_protocol(i)), text_or_empty(arv_get_device_address(i)))});
  }
  return found;
}

}  // namespace moiregauge::internal
