// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/child/decode_child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/decoder/child/confinement.h"
#include "moiregauge/decoder/child/wire.h"
#include "moiregauge/decoder/headers/stream_tone.h"
#include "moiregauge/decoder/seek/seek_plan.h"
#include "moiregauge/decoder/stream/ffmpeg_version.h"
#include "moiregauge/decoder/stream/luma_plane.h"
#include "moiregauge/decoder/stream/margin.h"
#include "moiregauge/decoder/stream/video_stream.h"
#include "moiregauge/image/quarter_turn.h"

namespace moiregauge::internal {
namespace {

using wire::Kind;
using wire::Record;

// Properties that every frame of the stream must have.
struct Shape {
  int width = 0;  // px, as stored
  int height = 0;
  int format = -1;
  LumaLayout layout;
  int rotation_deg = 0;
  Tone tone;
};

class Child {
 public:
  explicit Child(std::int64_t max_pixels) : max_pixels_(max_pixels) {}
  int run(const std::optional<std::string>& unfiltered, long first_frame);
  int run_live();

 private:
  void send(const Record& record) const {
    if (::send(wire::kSocket, &record, sizeof record, MSG_NOSIGNAL) != sizeof record) ::_exit(0);  // no parent
  }
  int fail(const VideoProblem& problem);
  void warn(const std::string& text) const;
  [[nodiscard]] tl::expected<void, VideoProblem> settle_shape(const VideoStream& stream);
  [[nodiscard]] bool make_slots(const VideoStream& stream);
  [[nodiscard]] int free_slot();
  void write_picture(const AVFrame& frame, std::byte* out);
  void send_frame(const VideoStream& stream, bool lost);
  void write_quantiser(const StreamQuantiser& quantiser, std::byte* out, Record& record);
  void send_frame(Record record, bool spoilt) const;
  void send_rest();
  [[nodiscard]] std::optional<VideoProblem> begin(const VideoStream& stream,
                                                  const std::optional<std::string>& unfiltered);
  [[nodiscard]] std::optional<SeekPlan> plan_for(long first_frame) const;
  [[nodiscard]] std::optional<VideoProblem> skip(VideoStream& stream, const SeekPlan& plan,
                                                 const std::optional<std::string>& unfiltered);
  void warn_about_fields(const AVFrame& frame);
  void send_live_frame(const VideoStream& stream);

  std::int64_t max_pixels_;
  Shape shape_;
  std::byte* memory_ = nullptr;
  std::size_t slot_bytes_ = 0;
  std::deque<int> free_;
  std::vector<std::byte> upright_;  // the stored image before rotation
  std::int64_t number_ = 0;
  double start_s_ = 0.0;
  std::optional<std::int64_t> first_time_;  // after a skip: earlier frames are not shown
  DamageMargin<Record> margin_;
  bool warned_fields_ = false;
  bool is_live_ = false;
  std::int64_t queue_full_ = 0;  // live frames without a free slot
  std::int64_t undecoded_ = 0;
};

int Child::fail(const VideoProblem& problem) {
  send_rest();
  Record record;
  record.kind = Kind::kFailed;
  record.error = static_cast<std::int32_t>(problem.kind);
  wire::put(record.what, problem.what);
  wire::put(record.advice, problem.advice);
  send(record);
  return 0;
}

void Child::warn(const std::string& text) const {
  Record record;
  record.kind = Kind::kWarning;
  wire::put(record.what, text);
  send(record);
}

tl::expected<void, VideoProblem> Child::settle_shape(const VideoStream& stream) {
  const AVFrame& frame = stream.frame();
  const auto layout = luma_layout(static_cast<AVPixelFormat>(frame.format));
  const auto rotation = stream.rotation_deg();
  if (!rotation) return tl::unexpected(rotation.error());
  if (!layout) {
    const char* name = av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame.format));
    return tl::unexpected(VideoProblem{InputErrorKind::kUnsupported,
                                       fmt::format("pixels of the format {} have no luma", name ? name : "?"),
                                       "convert the video to grey or YUV"});
  }
  if (frame.width <= 0 || frame.height <= 0 || frame.width > max_pixels_ / frame.height)
    return tl::unexpected(too_many_pixels(frame.width, frame.height, max_pixels_));
  shape_ = {frame.width, frame.height, frame.format, *layout, *rotation, tone_of(frame)};
  return {};
}

// Sets the size once and seals it, so that the memory cannot shrink while the parent reads it.
bool Child::make_slots(const VideoStream& stream) {
  const bool lies = shape_.rotation_deg % 180 != 0;
  Record opened;
  opened.kind = Kind::kOpened;
  opened.width = lies ? shape_.height : shape_.width;
  opened.height = lies ? shape_.width : shape_.height;
  opened.bits = shape_.layout.bits;
  opened.rotation_deg = shape_.rotation_deg;
  opened.tone_kind = static_cast<std::int32_t>(shape_.tone.curve.kind);
  opened.tone_gamma = shape_.tone.curve.gamma;
  opened.tone_is_tagged = shape_.tone.source == ToneSource::kTag ? 1 : 0;
  opened.is_full_range = shape_.tone.curve.is_full_range ? 1 : 0;
  opened.frames = stream.frames();
  opened.fps = stream.fps();
  opened.has_camera_times = is_live_ && stream.has_camera_times() ? 1 : 0;
  wire::put(opened.what, stream.codec());
  wire::put(opened.advice, stream.stated_start());
  slot_bytes_ = wire::slot_bytes(opened.width, opened.height, opened.bits);
  opened.slots = wire::slots_for(slot_bytes_);
  const std::size_t bytes = slot_bytes_ * static_cast<std::size_t>(opened.slots);
  if (::ftruncate(wire::kMemoryFile, static_cast<off_t>(bytes)) != 0) return false;
  if (::fcntl(wire::kMemoryFile, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) return false;
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, wire::kMemoryFile, 0);
  if (memory == MAP_FAILED) return false;
  memory_ = static_cast<std::byte*>(memory);
  for (int slot = 0; slot < opened.slots; ++slot) free_.push_back(slot);
  send(opened);
  return true;
}

int Child::free_slot() {
  if (free_.empty()) {
    wire::Release release;
    if (::recv(wire::kSocket, &release, sizeof release, 0) != sizeof release) ::_exit(0);  // the parent has ended
    return release.slot;
  }
  const int slot = free_.front();
  free_.pop_front();
  return slot;
}

void Child::write_picture(const AVFrame& frame, std::byte* out) {
  if (shape_.rotation_deg == 0) return copy_luma(frame, shape_.layout, out);
  upright_.resize(slot_bytes_);
  copy_luma(frame, shape_.layout, upright_.data());
  const auto turned = [&]<typename Grey>(Grey* to) {
    const ImageView<Grey> stored{reinterpret_cast<const Grey*>(upright_.data()), shape_.width, shape_.height,
                                 shape_.width};
    turn_clockwise(stored, shape_.rotation_deg, to);
  };
  if (shape_.layout.bits == 8)
    turned(reinterpret_cast<std::uint8_t*>(out));
  else
    turned(reinterpret_cast<std::uint16_t*>(out));
}

// Writes the block quantisers after the pixels. They are rotated with the image, exact to one block if the image size
// is no multiple of a block.
void Child::write_quantiser(const StreamQuantiser& quantiser, std::byte* out, Record& record) {
  record.quantiser_step = quantiser.whole().step;
  record.predicted = quantiser.whole().predicted ? 1 : 0;
  record.has_blocks = quantiser.blocks().empty() ? 0 : 1;
  if (record.has_blocks == 0) return;
  const int across = blocks_across(shape_.width), down = blocks_across(shape_.height);
  auto* to =
      reinterpret_cast<std::uint8_t*>(out + wire::picture_bytes(shape_.width, shape_.height, shape_.layout.bits));
  turn_clockwise(ImageView<std::uint8_t>{quantiser.blocks().data(), across, down, across}, shape_.rotation_deg, to);
}

void Child::send_frame(Record record, bool spoilt) const {
  if (spoilt && record.damaged == wire::kSound) record.damaged = wire::kSpoilt;
  send(record);
}

void Child::send_rest() {
  for (const auto& [record, spoilt] : margin_.rest()) send_frame(record, spoilt);
}

void Child::send_frame(const VideoStream& stream, bool lost) {
  if (number_ == 0) start_s_ = stream.time_s();
  if (!lost) warn_about_fields(stream.frame());
  Record record;
  record.kind = Kind::kFrame;
  record.slot = free_slot();
  std::byte* out = memory_ + static_cast<std::size_t>(record.slot) * slot_bytes_;
  if (lost) {
    std::memset(out, 0, slot_bytes_);  // must not show an older frame
  } else {
    write_picture(stream.frame(), out);
    write_quantiser(stream.quantiser(), out, record);
  }
  record.number = number_++;
  record.time_s = stream.time_s() - start_s_;
  // A frame without a time has lost its header, if other frames have times.
  const bool timeless = std::isnan(record.time_s) && !std::isnan(start_s_);
  record.damaged = lost || stream.damaged() || timeless ? wire::kDamaged : wire::kSound;
  if (const auto old = margin_.put(record, record.damaged != wire::kSound)) send_frame(old->first, old->second);
}

void Child::warn_about_fields(const AVFrame& frame) {
  if (warned_fields_ || !is_interlaced(frame)) return;
  warned_fields_ = true;
  warn(
      "moving targets are less certain: the video is interlaced (odd and even image rows at different times). "
      "Record progressive video");
}

// Starts with the first frame. Fails if a later frame has another shape.
std::optional<VideoProblem> Child::begin(const VideoStream& stream, const std::optional<std::string>& unfiltered) {
  const AVFrame& frame = stream.frame();
  if (memory_ != nullptr) {
    if (frame.width == shape_.width && frame.height == shape_.height && frame.format == shape_.format)
      return std::nullopt;
    return VideoProblem{InputErrorKind::kDamaged,
                        fmt::format("the frame size changes from {}x{} to {}x{} at frame {}", shape_.width,
                                    shape_.height, frame.width, frame.height, number_),
                        "split the video (earlier frames are valid)"};
  }
  if (const auto settled = settle_shape(stream); !settled) return settled.error();
  if (!make_slots(stream))
    return VideoProblem{InputErrorKind::kUnreadable, "there is not enough memory for the frames", "free memory"};
  if (unfiltered)
    warn(fmt::format("note: the decoder runs without its system call filter, which this system lacks ({})",
                     *unfiltered));
  return std::nullopt;
}

// Sends a live frame, or counts it if the parent has not released any slot.
void Child::send_live_frame(const VideoStream& stream) {
  warn_about_fields(stream.frame());
  wire::Release release;
  while (::recv(wire::kSocket, &release, sizeof release, MSG_DONTWAIT) == sizeof release) free_.push_back(release.slot);
  Record record;
  record.kind = Kind::kFrame;
  record.number = number_++;
  if (free_.empty()) {
    ++queue_full_;
    return;
  }
  record.slot = free_.front();
  free_.pop_front();
  std::byte* out = memory_ + static_cast<std::size_t>(record.slot) * slot_bytes_;
  write_picture(stream.frame(), out);
  write_quantiser(stream.quantiser(), out, record);
  record.time_s = stream.time_s();
  record.damaged = stream.damaged() ? wire::kDamaged : wire::kSound;
  record.host_ns = std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
  record.queue_full = queue_full_;
  record.undecoded = undecoded_;
  if (stream.is_place_known()) return send(record);
  // Frames are reordered, so an error may concern a neighbour.
  if (const auto old = margin_.put(record, record.damaged != wire::kSound)) send_frame(old->first, old->second);
}

int Child::run_live() {
  is_live_ = true;
  char text[4096];
  const ssize_t got = ::pread(wire::kInputFile, text, sizeof text, 0);
  const auto address = live_address_of({text, static_cast<std::size_t>(got > 0 ? got : 0)});
  if (!address) return fail({InputErrorKind::kUnreadable, "the address is too long", "shorten it"});
  auto connected = VideoStream::connect(*address, max_pixels_);
  if (!connected) return fail(connected.error());
  VideoStream& stream = **connected;
  limit_resources(max_pixels_);
  const auto unfiltered = filter_system_calls(InputAccess::kConnection);
  if (const auto begun = stream.begin_live(); !begun) return fail(begun.error());
  while (true) {
    const Decoded decoded = stream.next();
    if (decoded == Decoded::kEnd) return fail({InputErrorKind::kDamaged, "the stream ended", "check the camera"});
    if (decoded == Decoded::kLost) {
      ++undecoded_;
      continue;
    }
    if (const auto problem = begin(stream, unfiltered)) return fail(*problem);
    send_live_frame(stream);
  }
}

// The margin of frames is that of damaged neighbours, so that their marks are the same as without a skip.
std::optional<SeekPlan> Child::plan_for(long first_frame) const {
  if (first_frame == 0) return std::nullopt;
  auto packets = VideoStream::open(wire::kInputFile, max_pixels_);
  if (!packets) return std::nullopt;  // the same problem comes again
  return plan_seek((*packets)->note_packets(first_frame), first_frame, DamageMargin<Record>::kFrames);
}

// Decodes frame 0, which determines the shape and the start of time, and then skips.
std::optional<VideoProblem> Child::skip(VideoStream& stream, const SeekPlan& plan,
                                        const std::optional<std::string>& unfiltered) {
  if (stream.next() != Decoded::kFrame || stream.timestamp() != plan.begin_time)
    return VideoProblem{InputErrorKind::kDamaged, "frames cannot be skipped", "decode from the start"};
  if (auto problem = begin(stream, unfiltered)) return problem;
  start_s_ = stream.time_s();
  if (!stream.skip_to(plan.packet))
    return VideoProblem{InputErrorKind::kDamaged, "frames cannot be skipped", "decode from the start"};
  number_ = plan.first_frame;
  first_time_ = plan.first_time;
  return std::nullopt;
}

int Child::run(const std::optional<std::string>& unfiltered, long first_frame) {
  const auto plan = plan_for(first_frame);
  auto opened = VideoStream::open(wire::kInputFile, max_pixels_);
  if (!opened) return fail(opened.error());
  VideoStream& stream = **opened;
  if (plan) {
    if (const auto problem = skip(stream, *plan, unfiltered)) return fail(*problem);
  }
  while (true) {
    const Decoded decoded = stream.next();
    if (decoded == Decoded::kEnd && memory_ == nullptr)
      return fail({InputErrorKind::kDamaged, "no frame can be decoded", "copy the video again from the camera"});
    if (decoded == Decoded::kEnd) {
      if (const auto problem = stream.end_problem(number_)) {
        margin_.spoil_around();  // a truncated file may end within a frame
        return fail(*problem);
      }
      break;
    }
    if (decoded == Decoded::kLost) {
      if (stream.is_place_known() && memory_ != nullptr && !first_time_)
        send_frame(stream, true);
      else
        margin_.spoil_around();
      continue;
    }
    if (const auto problem = begin(stream, unfiltered)) return fail(*problem);
    if (!first_time_ || stream.timestamp() >= *first_time_) send_frame(stream, false);
  }
  send_rest();
  send(Record{});
  return 0;
}

}  // namespace

int decode_child(std::int64_t max_pixels, long first_frame) {
  limit_resources(max_pixels);
  const auto unfiltered = filter_system_calls();
  count_log_errors();
  return Child(max_pixels).run(unfiltered, first_frame);
}

int decode_live_child(std::int64_t max_pixels) {
  count_log_errors();
  return Child(max_pixels).run_live();
}

}  // namespace moiregauge::internal
