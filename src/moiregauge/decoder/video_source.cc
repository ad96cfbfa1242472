// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/video_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/base/utc_text.h"
#include "moiregauge/decoder/child/child_process.h"
#include "moiregauge/decoder/stored/stored_source.h"

namespace moiregauge::internal {
namespace {

using wire::Kind;
using wire::Record;

constexpr const char* kDecoderAdvice = "convert the video with ffmpeg and measure again (earlier frames are valid)";

class OpenFile {
 public:
  explicit OpenFile(const std::string& path) : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (file_ >= 0) ::close(file_);
  }
  [[nodiscard]] int number() const { return file_; }

 private:
  int file_;
};

InputError error_of(InputErrorKind kind, const std::string& what, const std::string& where, const std::string& advice) {
  return {kind, fmt::format("{}: {}: {}", what, where, advice)};
}

// Converts a record to an error. An unknown error kind becomes kDamaged.
InputError error_in(const Record& record, const std::string& path) {
  const bool known = record.error >= 0 && record.error <= static_cast<int>(InputErrorKind::kDamaged);
  const auto kind = known ? static_cast<InputErrorKind>(record.error) : InputErrorKind::kDamaged;
  return error_of(kind, wire::get(record.what), path, wire::get(record.advice));
}

class VideoSource final : public FrameSource {
 public:
  VideoSource(ChildProcess child, InputInfo info, const InputOptions& options, const DecoderOptions& decoder)
      : child_(std::move(child)),
        info_(std::move(info)),
        fps_(options.fps),
        watchdog_(decoder.watchdog),
        skippable_(decoder.first_frame) {}

  [[nodiscard]] const InputInfo& info() const override { return info_; }

  // Waits for the child's first record, which completes info().
  [[nodiscard]] tl::expected<void, InputError> open() {
    const auto record = child_.receive(watchdog_);
    if (!record) return tl::unexpected(error_of(InputErrorKind::kDamaged, record.error(), info_.path, kDecoderAdvice));
    if (record->kind == Kind::kFailed) return tl::unexpected(error_in(*record, info_.path));
    if (!is_sane(*record)) return tl::unexpected(nonsense());
    info_.frames = record->frames;
    info_.width = record->width;
    info_.height = record->height;
    info_.bits = record->bits;
    info_.rotation_deg = record->rotation_deg;
    const bool is_tagged = record->tone_is_tagged != 0;
    info_.tone = {{static_cast<ToneCurve::Kind>(record->tone_kind), record->tone_gamma, record->is_full_range != 0},
                  is_tagged ? ToneSource::kTag : ToneSource::kAssumed};
    info_.codec = wire::get(record->what);
    info_.start_utc = utc_text(wire::get(record->advice));
    info_.fps = fps_.value_or(record->fps);
    info_.time_source = fps_ ? "fps-option" : "stream";
    slots_ = record->slots;
    slot_bytes_ = wire::slot_bytes(info_.width, info_.height, info_.bits);
    memory_ = child_.map(slot_bytes_ * static_cast<std::size_t>(slots_));
    if (memory_ == nullptr) return tl::unexpected(nonsense());
    return {};
  }

  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    if (ended_) return std::optional<Frame>();
    if (broken_off_) return tl::unexpected(*broken_off_);
    if (held_slot_ >= 0) child_.release(std::exchange(held_slot_, -1));
    while (true) {
      const auto record = child_.receive(watchdog_);
      if (!record)
        return break_off(error_of(InputErrorKind::kDamaged, lost_decoder(record.error()), info_.path, kDecoderAdvice));
      if (record->kind == Kind::kFailed) return break_off(error_in(*record, info_.path));
      if (record->kind == Kind::kWarning) {
        if (info_.warnings.size() < 100) info_.warnings.push_back(wire::get(record->what));
        continue;
      }
      ended_ = record->kind == Kind::kEnd;
      if (ended_) return std::optional<Frame>();
      const bool is_next = record->number == number_ || (skippable_ > 0 && is_first_after_skip(record->number));
      if (record->kind != Kind::kFrame || record->slot < 0 || record->slot >= slots_ || !is_next)
        return break_off(nonsense());
      skippable_ = 0;
      number_ = record->number;
      if (!fps_ && runs_backwards(*record)) {
        return break_off(error_of(
            InputErrorKind::kDamaged,
            fmt::format("the times run backwards at frame {} ({:.2f} to {:.2f} s)", number_, last_s_, record->time_s),
            info_.path, "split the video, or give --fps (earlier frames are valid)"));
      }
      return frame_in(*record);
    }
  }

 private:
  [[nodiscard]] static bool is_sane(const Record& record) {
    return record.kind == Kind::kOpened && record.width > 0 && record.height > 0 &&
           record.width <= wire::kMaxPixels / record.height && record.bits >= 8 && record.bits <= 16 &&
           record.tone_kind >= 0 && record.tone_kind <= static_cast<std::int32_t>(ToneCurve::Kind::kGamma) &&
           record.tone_gamma > 0.0 && record.slots > 0 && record.slots <= wire::kMaxSlots;
  }

  [[nodiscard]] bool is_first_after_skip(std::int64_t number) const { return number >= 0 && number <= skippable_; }

  [[nodiscard]] std::string place() const { return fmt::format("{} at frame {}", info_.path, number_); }
  [[nodiscard]] InputError nonsense() const {
    return error_of(InputErrorKind::kDamaged, "the video decoder failed", place(), kDecoderAdvice);
  }
  [[nodiscard]] std::string lost_decoder(const std::string& how) const {
    return fmt::format("{} at frame {} ({} frames kept)", how, number_, number_);
  }

  // Returns true if time runs backwards. A damaged frame may have lost its time, its neighbours have not.
  [[nodiscard]] bool runs_backwards(const Record& record) {
    if (record.damaged == wire::kDamaged || std::isnan(record.time_s)) return false;
    if (record.time_s < last_s_) return true;
    if (record.time_s == last_s_ && !std::exchange(time_stood_still_, true))
      info_.warnings.push_back(
          fmt::format("spectra may be wrong: frame {} has the time of the one before ({:.3f} s). Give --fps if the "
                      "frame rate is constant",
                      number_, last_s_));
    last_s_ = record.time_s;
    return false;
  }
  tl::unexpected<InputError> break_off(InputError error) {
    broken_off_ = std::move(error);
    return tl::unexpected(*broken_off_);
  }

  [[nodiscard]] Frame frame_in(const Record& record) {
    held_slot_ = record.slot;
    const std::byte* pixels = memory_ + static_cast<std::size_t>(record.slot) * slot_bytes_;
    const double time_s = fps_ ? static_cast<double>(number_) / *fps_ : record.time_s;
    Frame frame{number_++, time_s, record.damaged != 0, {}};
    const bool is_step = record.quantiser_step >= 0.0 && record.quantiser_step < 65536.0;
    frame.quantiser.whole = {is_step ? record.quantiser_step : kUnknownStep, record.predicted != 0};
    if (record.has_blocks != 0) {
      const int across = blocks_across(info_.width);
      frame.quantiser.blocks = {
          reinterpret_cast<const std::uint8_t*>(pixels + wire::picture_bytes(info_.width, info_.height, info_.bits)),
          across, blocks_across(info_.height), across};
    }
    const auto view = [&]<typename Grey>(const Grey* data) {
      frame.luma = ImageView<Grey>{data, info_.width, info_.height, info_.width};
    };
    if (info_.bits == 8)
      view(reinterpret_cast<const std::uint8_t*>(pixels));
    else
      view(reinterpret_cast<const std::uint16_t*>(pixels));
    return frame;
  }

  ChildProcess child_;
  InputInfo info_;
  std::optional<double> fps_;
  std::chrono::milliseconds watchdog_;
  long skippable_;  // before the first frame: the highest number that it may have
  const std::byte* memory_ = nullptr;
  std::size_t slot_bytes_ = 0;
  int slots_ = 0;
  int held_slot_ = -1;
  long number_ = 0;
  double last_s_ = -std::numeric_limits<double>::infinity();  // time of the last sound frame
  bool time_stood_still_ = false;
  bool ended_ = false;
  std::optional<InputError> broken_off_;
};

using Opened = tl::expected<std::unique_ptr<FrameSource>, InputError>;

Opened decoded(const std::string& path, const InputOptions& options, const DecoderOptions& decoder) {
  const auto unreadable = [&](const std::string& what, const std::string& advice) {
    return tl::unexpected(error_of(InputErrorKind::kUnreadable, what, path, advice));
  };
  const OpenFile file(path);
  struct stat about {};
  if (file.number() < 0 || ::fstat(file.number(), &about) != 0) {
    return unreadable(fmt::format("the video cannot be opened ({})", std::strerror(errno)),
                      "check its name and permissions");
  }
  if (!S_ISREG(about.st_mode)) return unreadable("the input is not a file", "give a video file");
  if (about.st_size == 0) return unreadable("the video file is empty", "copy it again from the camera");
  auto child = ChildProcess::start(decoder.child_program, file.number(), options.max_pixels, wire::kChildMode,
                                   decoder.first_frame);
  if (!child)
    return unreadable(fmt::format("the video decoder could not be started ({})", child.error()),
                      "free memory, processes or open files");
  InputInfo info;
  info.path = path;
  auto source = std::make_unique<VideoSource>(std::move(*child), std::move(info), options, decoder);
  if (auto opened = source->open(); !opened) return tl::unexpected(opened.error());
  return std::unique_ptr<FrameSource>(std::move(source));
}

bool same_pixels(const LumaView& a, const LumaView& b) {
  if (a.index() != b.index() || width_of(a) != width_of(b) || height_of(a) != height_of(b)) return false;
  return std::visit(
      [&b](const auto& mine) {
        const auto& other = std::get<std::decay_t<decltype(mine)>>(b);
        for (int y = 0; y < mine.height; ++y) {
          const auto row = mine.row(y);
          if (!std::equal(row.begin(), row.end(), other.row(y).begin())) return false;
        }
        return true;
      },
      a);
}

// Returns true if the decoder's first frame equals the one read in place. Reads that frame from the decoder.
bool agree(const MappedVideo& mapped, FrameSource& decoder) {
  const InputInfo& info = decoder.info();
  const auto counted = static_cast<long>(mapped.video.frames.size());
  if (info.rotation_deg != 0 || info.bits != mapped.video.bits || (info.frames >= 0 && info.frames != counted))
    return false;
  const auto first = decoder.next();
  return first && *first && !(*first)->damaged && info.warnings.empty() && same_pixels((*first)->luma, mapped.luma(0));
}

}  // namespace

tl::expected<std::unique_ptr<FrameSource>, InputError> open_video(const std::string& path, const InputOptions& options,
                                                                  const DecoderOptions& decoder) {
  auto source = decoded(path, options, decoder);
  if (!source || !decoder.in_place || (*source)->info().codec != "rawvideo") return source;
  if (decoder.first_frame > 0) {  // omitting frames that are read in place saves nothing
    DecoderOptions from_start = decoder;
    from_start.first_frame = 0;
    return open_video(path, options, from_start);
  }
  auto mapped = map_video(path);
  if (!mapped) return source;
  if (agree(*mapped, **source)) return stored_source(std::move(*mapped), (*source)->info(), options);
  return decoded(path, options, decoder);  // a second decoder, because the first one's first frame was read
}

}  // namespace moiregauge::internal
