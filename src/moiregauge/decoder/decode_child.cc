// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/decode_child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <deque>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/decoder/luma_plane.h"
#include "moiregauge/decoder/video_stream.h"
#include "moiregauge/decoder/wire.h"
#include "moiregauge/image/quarter_turn.h"

namespace moiregauge {
namespace {

using wire::Kind;
using wire::Record;

// What every frame of the stream must look like.
struct Shape {
  int width = 0;  // as stored
  int height = 0;
  int format = -1;
  LumaLayout layout;
  int rotation_deg = 0;
};

class Child {
 public:
  int run();

 private:
  void send(const Record& record) const {
    if (::send(wire::kSocket, &record, sizeof record, MSG_NOSIGNAL) != sizeof record) ::_exit(0);  // nobody listens
  }
  int fail(const VideoProblem& problem) const;
  void warn_once(bool& warned, const std::string& text) const;
  [[nodiscard]] tl::expected<void, VideoProblem> settle_shape(const VideoStream& stream);
  [[nodiscard]] bool make_slots(const VideoStream& stream);
  [[nodiscard]] int free_slot();
  void write_picture(const AVFrame& frame, std::byte* out);
  void send_frame(const VideoStream& stream, bool lost);
  void watch(const VideoStream& stream);

  Shape shape_;
  std::byte* memory_ = nullptr;
  std::size_t slot_bytes_ = 0;
  std::deque<int> free_;
  std::vector<std::byte> upright_;  // the stored picture before it is turned
  std::int64_t number_ = 0;
  double start_s_ = 0.0;
  double last_s_ = -1.0;
  bool warned_time_ = false;
  bool warned_fields_ = false;
};

int Child::fail(const VideoProblem& problem) const {
  Record record;
  record.kind = Kind::kFailed;
  record.error = static_cast<std::int32_t>(problem.kind);
  wire::put(record.what, problem.what);
  wire::put(record.advice, problem.advice);
  send(record);
  return 0;
}

void Child::warn_once(bool& warned, const std::string& text) const {
  if (warned) return;
  warned = true;
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
                                       fmt::format("no luma in pixels of kind {}", name ? name : "?"),
                                       "convert the video to grey or YUV"});
  }
  if (frame.width <= 0 || frame.height <= 0 || frame.width > wire::kMostPixels / frame.height) {
    return tl::unexpected(
        VideoProblem{InputErrorKind::kUnsupported, "the picture has more than 2^28 pixels", "crop it"});
  }
  shape_ = {frame.width, frame.height, frame.format, *layout, *rotation};
  return {};
}

// Sized once and sealed, so that the parent can read it without fearing that it shrinks under its eyes.
bool Child::make_slots(const VideoStream& stream) {
  const bool lies = shape_.rotation_deg % 180 != 0;
  Record opened;
  opened.kind = Kind::kOpened;
  opened.width = lies ? shape_.height : shape_.width;
  opened.height = lies ? shape_.width : shape_.height;
  opened.bits = shape_.layout.bits;
  opened.rotation_deg = shape_.rotation_deg;
  opened.frames = stream.frames();
  opened.fps = stream.fps();
  wire::put(opened.what, stream.codec());
  slot_bytes_ = wire::slot_bytes(opened.width, opened.height, opened.bits);
  constexpr std::size_t kEnoughBytes = std::size_t{256} << 20;  // large pictures get fewer slots, never below two
  opened.slots = static_cast<int>(std::clamp<std::size_t>(kEnoughBytes / slot_bytes_, 2, wire::kMostSlots));
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
    if (::recv(wire::kSocket, &release, sizeof release, 0) != sizeof release) ::_exit(0);  // the parent has closed
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

void Child::watch(const VideoStream& stream) {
  const double time_s = stream.time_s();
  if (number_ > 0 && !(time_s > last_s_)) {
    warn_once(warned_time_, fmt::format("the time stamps do not grow at frame {}", number_));
  }
  last_s_ = time_s;
  if (stream.frame().interlaced_frame != 0) {
    warn_once(warned_fields_,
              "the video is interlaced: the odd and even lines of a frame were seen at different times");
  }
}

void Child::send_frame(const VideoStream& stream, bool lost) {
  if (number_ == 0) start_s_ = stream.time_s();
  watch(stream);
  Record record;
  record.kind = Kind::kFrame;
  record.slot = free_slot();
  std::byte* out = memory_ + static_cast<std::size_t>(record.slot) * slot_bytes_;
  if (lost)
    std::memset(out, 0, slot_bytes_);  // nothing of an older frame may pass for this one
  else
    write_picture(stream.frame(), out);
  record.damaged = lost || stream.damaged() ? 1 : 0;
  record.number = number_++;
  record.time_s = stream.time_s() - start_s_;
  send(record);
}

int Child::run() {
  auto opened = VideoStream::open(wire::kInputFile);
  if (!opened) return fail(opened.error());
  VideoStream& stream = **opened;
  while (true) {
    const Decoded decoded = stream.next();
    if (decoded == Decoded::kEnd && memory_ != nullptr) break;
    if (decoded == Decoded::kEnd || (decoded == Decoded::kEndedEarly && memory_ == nullptr)) {
      return fail({InputErrorKind::kDamaged, "no frame can be decoded", "record or copy the video again"});
    }
    if (decoded == Decoded::kEndedEarly) {
      return fail(
          {InputErrorKind::kDamaged, fmt::format("the file ends early, after {} frames", number_), "copy it again"});
    }
    if (decoded == Decoded::kLost) {
      if (memory_ != nullptr) send_frame(stream, true);
      continue;
    }
    const AVFrame& frame = stream.frame();
    if (memory_ == nullptr) {
      if (const auto settled = settle_shape(stream); !settled) return fail(settled.error());
      if (!make_slots(stream))
        return fail({InputErrorKind::kUnreadable, "no memory for the pictures", "free some memory"});
    } else if (frame.width != shape_.width || frame.height != shape_.height || frame.format != shape_.format) {
      return fail({InputErrorKind::kDamaged,
                   fmt::format("the picture changes to {} x {} at frame {}", frame.width, frame.height, number_),
                   "measure the parts one by one"});
    }
    send_frame(stream, false);
  }
  send(Record{});
  return 0;
}

// What the child holds is all it will ever hold: no file can be opened, whatever a decoder is talked into.
void close_the_doors() {
  const rlimit files{wire::kFirstUnusedFile, wire::kFirstUnusedFile};
  ::setrlimit(RLIMIT_NOFILE, &files);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
}

}  // namespace

int decode_child() {
  close_the_doors();
  count_log_errors();
  return Child().run();
}

}  // namespace moiregauge
