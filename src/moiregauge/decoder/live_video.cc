// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/live_video.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/decoder/child/child_process.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;
using wire::Kind;
using wire::Record;

// The child gives up after the timeout of the address. A child that does not is dead (chosen).
constexpr auto kGrace = std::chrono::seconds(5);

class LiveConnection final : public LiveVideo {
 public:
  LiveConnection(ChildProcess child, const LiveAddress& address)
      : child_(std::move(child)), silence_(address.timeout + kGrace) {
    info_.path = without_password(address.url);
  }

  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] bool has_camera_times() const override { return has_camera_times_; }

  [[nodiscard]] tl::expected<void, InputError> open() {
    // Connecting and probing have the timeout each.
    const auto record = child_.receive(2 * silence_);
    if (!record)
      return tl::unexpected(error(InputErrorKind::kUnreadable, record.error(), "check the stream's address"));
    if (record->kind == Kind::kFailed) {
      const bool is_known = record->error >= 0 && record->error <= static_cast<int>(InputErrorKind::kDamaged);
      const auto kind = is_known ? static_cast<InputErrorKind>(record->error) : InputErrorKind::kUnreadable;
      return tl::unexpected(error(kind, wire::get(record->what), wire::get(record->advice)));
    }
    if (!is_plausible(*record) || !set_up(*record))
      return tl::unexpected(
          error(InputErrorKind::kUnsupported, "the video decoder failed", "check the camera's settings"));
    last_record_ = std::chrono::steady_clock::now();
    return {};
  }

  [[nodiscard]] tl::expected<std::optional<LiveVideoFrame>, std::string> next(milliseconds timeout) override {
    if (held_slot_ >= 0) child_.release(std::exchange(held_slot_, -1));
    const auto until = std::chrono::steady_clock::now() + timeout;
    while (true) {
      const auto left = std::chrono::ceil<milliseconds>(until - std::chrono::steady_clock::now());
      if (!child_.has_record(std::max(left, milliseconds(0)))) {
        if (std::chrono::steady_clock::now() - last_record_ > silence_)
          return tl::unexpected(std::string("the stream is silent"));
        return std::nullopt;
      }
      const auto record = child_.receive(silence_);
      if (!record) return tl::unexpected(record.error());
      last_record_ = std::chrono::steady_clock::now();
      if (record->kind == Kind::kFailed) return tl::unexpected(wire::get(record->what));
      if (record->kind == Kind::kWarning) {
        if (info_.warnings.size() < 100) info_.warnings.push_back(wire::get(record->what));
        continue;
      }
      if (record->kind != Kind::kFrame || record->slot < 0 || record->slot >= slots_ || record->number < number_)
        return tl::unexpected(std::string("the video decoder failed"));
      return frame_in(*record);
    }
  }

 private:
  [[nodiscard]] InputError error(InputErrorKind kind, const std::string& what, const std::string& advice) const {
    return {kind, fmt::format("{}: {}: {}", what, info_.path, advice)};
  }
  [[nodiscard]] static bool is_plausible(const Record& record) {
    return record.kind == Kind::kOpened && record.width > 0 && record.height > 0 &&
           record.width <= wire::kMaxPixels / record.height && record.bits >= 8 && record.bits <= 16 &&
           record.tone_kind >= 0 && record.tone_kind <= static_cast<std::int32_t>(ToneCurve::Kind::kGamma) &&
           record.tone_gamma > 0.0 && record.slots > 0 && record.slots <= wire::kMaxSlots;
  }
  [[nodiscard]] bool set_up(const Record& record) {
    info_.width = record.width;
    info_.height = record.height;
    info_.bits = record.bits;
    info_.rotation_deg = record.rotation_deg;
    info_.tone = {{static_cast<ToneCurve::Kind>(record.tone_kind), record.tone_gamma, record.is_full_range != 0},
                  record.tone_is_tagged != 0 ? ToneSource::kTag : ToneSource::kAssumed};
    info_.codec = wire::get(record.what);
    info_.fps = record.fps;
    has_camera_times_ = record.has_camera_times != 0;
    slots_ = record.slots;
    slot_bytes_ = wire::slot_bytes(info_.width, info_.height, info_.bits);
    memory_ = child_.map(slot_bytes_ * static_cast<std::size_t>(slots_));
    return memory_ != nullptr;
  }
  [[nodiscard]] LiveVideoFrame frame_in(const Record& record) {
    held_slot_ = record.slot;
    number_ = record.number + 1;
    const std::byte* pixels = memory_ + static_cast<std::size_t>(record.slot) * slot_bytes_;
    LiveVideoFrame out;
    out.host_ns = record.host_ns;
    out.queue_full = record.queue_full;
    out.undecoded = record.undecoded;
    out.frame.number = record.number;
    out.frame.time_s = record.time_s;
    out.frame.damaged = record.damaged != wire::kSound;
    const bool is_step = record.quantiser_step >= 0.0 && record.quantiser_step < 65536.0;
    out.frame.quantiser.whole = {is_step ? record.quantiser_step : kUnknownStep, record.predicted != 0};
    if (record.has_blocks != 0) {
      const int across = blocks_across(info_.width);
      const std::byte* blocks = pixels + wire::picture_bytes(info_.width, info_.height, info_.bits);
      out.frame.quantiser.blocks = {reinterpret_cast<const std::uint8_t*>(blocks), across, blocks_across(info_.height),
                                    across};
    }
    if (info_.bits == 8)
      out.frame.luma = ImageView<std::uint8_t>{reinterpret_cast<const std::uint8_t*>(pixels), info_.width, info_.height,
                                               info_.width};
    else
      out.frame.luma = ImageView<std::uint16_t>{reinterpret_cast<const std::uint16_t*>(pixels), info_.width,
                                                info_.height, info_.width};
    return out;
  }

  ChildProcess child_;
  milliseconds silence_;
  InputInfo info_;
  bool has_camera_times_ = false;
  const std::byte* memory_ = nullptr;
  std::size_t slot_bytes_ = 0;
  int slots_ = 0;
  int held_slot_ = -1;
  std::int64_t number_ = 0;
  std::chrono::steady_clock::time_point last_record_;
};

}  // namespace

tl::expected<std::unique_ptr<LiveVideo>, InputError> LiveVideo::open(const LiveAddress& address,
                                                                     std::int64_t max_pixels,
                                                                     const DecoderOptions& decoder) {
  const std::string text = text_of(address);
  const int input = ::memfd_create("moiregauge-address", MFD_CLOEXEC);
  const bool is_written = input >= 0 && ::write(input, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  auto child = is_written ? ChildProcess::start(decoder.child_program, input, max_pixels, wire::kLiveMode)
                          : tl::expected<ChildProcess, std::string>(tl::unexpected(std::string("no memory")));
  if (input >= 0) ::close(input);
  if (!child)
    return tl::unexpected(
        InputError{InputErrorKind::kUnreadable,
                   fmt::format("the video decoder could not be started ({}): {}: free memory, processes or open files",
                               child.error(), without_password(address.url))});
  auto live = std::make_unique<LiveConnection>(std::move(*child), address);
  if (auto opened = live->open(); !opened) return tl::unexpected(opened.error());
  return std::unique_ptr<LiveVideo>(std::move(live));
}

std::string without_password(const std::string& url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string::npos) return url;
  const std::size_t slash = url.find('/', scheme + 3);
  const std::size_t at = url.substr(0, slash).rfind('@');
  const std::size_t colon = url.find(':', scheme + 3);
  if (at == std::string::npos || colon == std::string::npos || colon > at) return url;
  return url.substr(0, colon + 1) + "***" + url.substr(at);
}

}  // namespace moiregauge::internal
