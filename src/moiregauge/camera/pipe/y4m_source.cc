// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/camera/pipe/y4m_source.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/camera/common/host_time.h"
#include "moiregauge/camera/pipe/y4m_header.h"

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

enum class Arrival { kBytes, kNothing, kEnd };

// Reads the bytes of a pipe without blocking longer than agreed.
class PipeReader {
 public:
  explicit PipeReader(int file) : file_(file) {
    constexpr int kPipeBytes = 1 << 20;  // fewer wake-ups per frame; refused for other files than pipes
    ::fcntl(file, F_SETPIPE_SZ, kPipeBytes);
  }

  // Reads at most out.size() bytes, and sets `count`.
  [[nodiscard]] Arrival read(std::span<std::uint8_t> out, steady_clock::time_point until, std::size_t& count) const {
    count = 0;
    while (true) {
      const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now()).count();
      pollfd waiting{file_, POLLIN, 0};
      const int ready = ::poll(&waiting, 1, static_cast<int>(std::max<std::int64_t>(left, 0)));
      if (ready == 0) return Arrival::kNothing;
      const ssize_t got = ready > 0 ? ::read(file_, out.data(), out.size()) : -1;
      if (got < 0 && errno == EINTR && left > 0) continue;
      if (got < 0 && (errno == EINTR || errno == EAGAIN)) return Arrival::kNothing;
      if (got <= 0) return Arrival::kEnd;
      count = static_cast<std::size_t>(got);
      return Arrival::kBytes;
    }
  }

 private:
  int file_;
};

class Y4mSource final : public LiveSource {
 public:
  Y4mSource(PipeReader pipe, const Y4mHeader& header, const PipeOptions& options)
      : pipe_(pipe), header_(header), frame_(header.frame_bytes) {
    info_.path = "-";
    info_.width = header.width;
    info_.height = header.height;
    info_.bits = header.bits;
    info_.fps = options.fps.value_or(header.fps);
    info_.codec = "rawvideo";
    info_.tone = header.tone;
    info_.time_source = options.fps ? "fps-option" : std::isnan(info_.fps) ? "host" : "stream";
    if (header.is_interlaced)
      info_.warnings.emplace_back(
          "moving targets are less certain: the video is interlaced (odd and even image rows at different times). "
          "Record progressive video");
  }

  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] LostFrames lost() const override { return lost_; }

  [[nodiscard]] tl::expected<std::optional<LiveFrame>, SourceEnd> next(milliseconds timeout) override {
    const auto until = steady_clock::now() + timeout;
    while (!end_) {
      std::size_t count = 0;
      const Arrival arrival = fill(until, count);
      if (arrival == Arrival::kNothing) return std::nullopt;
      if (arrival == Arrival::kEnd) {
        finish();
      } else if (is_complete()) {
        return frame();
      }
    }
    return tl::unexpected(*end_);
  }

 private:
  // Reads into the frame line or into the pixels, whichever is incomplete.
  [[nodiscard]] Arrival fill(steady_clock::time_point until, std::size_t& count) {
    if (has_line_) {
      const Arrival arrival = pipe_.read(std::span(frame_).subspan(filled_), until, count);
      filled_ += count;
      return arrival;
    }
    std::uint8_t letter = 0;
    const Arrival arrival = pipe_.read(std::span(&letter, 1), until, count);
    if (arrival != Arrival::kBytes) return arrival;
    if (letter != '\n') {
      line_.push_back(static_cast<char>(letter));
      if (line_.size() < kMaxY4mLine) return arrival;
    }
    if (!is_y4m_frame_line(line_)) {
      end_ = SourceEnd{
          SourceEnd::Kind::kLost,
          fmt::format("the stream is damaged: stdin after frame {}: check the program that writes it", number_)};
      return arrival;
    }
    has_line_ = true;
    line_.clear();
    return arrival;
  }

  [[nodiscard]] bool is_complete() const { return has_line_ && filled_ == frame_.size(); }

  void finish() {
    if (has_line_ || !line_.empty()) ++lost_.incomplete;
    end_ = SourceEnd{SourceEnd::Kind::kFinished, {}};
  }

  [[nodiscard]] LiveFrame frame() {
    LiveFrame out;
    out.host_ns = host_ns();
    if (number_ == 0) {
      first_host_ns_ = out.host_ns;
      info_.start_utc = utc_now_text();
    }
    out.frame.number = number_++;
    out.frame.time_s = std::isnan(info_.fps) ? static_cast<double>(out.host_ns - first_host_ns_) * 1e-9
                                             : static_cast<double>(out.frame.number) / info_.fps;
    if (header_.bits == 8)
      out.frame.luma = ImageView<std::uint8_t>{frame_.data(), header_.width, header_.height, header_.width};
    else
      out.frame.luma = words();
    has_line_ = false;
    filled_ = 0;
    return out;
  }

  [[nodiscard]] ImageView<std::uint16_t> words() {
    words_.resize(header_.luma_bytes / 2);
    std::memcpy(words_.data(), frame_.data(), header_.luma_bytes);
    return {words_.data(), header_.width, header_.height, header_.width};
  }

  PipeReader pipe_;
  Y4mHeader header_;
  InputInfo info_;
  LostFrames lost_;
  std::vector<std::uint8_t> frame_;
  std::vector<std::uint16_t> words_;
  std::string line_;
  bool has_line_ = false;
  std::size_t filled_ = 0;
  long number_ = 0;
  std::int64_t first_host_ns_ = 0;
  std::optional<SourceEnd> end_;
};

InputError pipe_error(InputErrorKind kind, const std::string& what, const std::string& advice) {
  return {kind, fmt::format("{}: stdin: {}", what, advice)};
}

}  // namespace

tl::expected<std::unique_ptr<LiveSource>, InputError> open_y4m_pipe(int file, const PipeOptions& options) {
  const PipeReader pipe(file);
  const auto until = steady_clock::now() + options.patience;
  std::string line;
  while (true) {
    std::uint8_t letter = 0;
    std::size_t count = 0;
    const Arrival arrival = pipe.read(std::span(&letter, 1), until, count);
    if (arrival == Arrival::kNothing)
      return tl::unexpected(pipe_error(InputErrorKind::kUnreadable,
                                       fmt::format("no stream arrived within {} s", options.patience.count() / 1000),
                                       "start the program that writes it"));
    if (arrival == Arrival::kEnd && line.empty())
      return tl::unexpected(
          pipe_error(InputErrorKind::kUnreadable, "the stream is empty", "check the program that writes it"));
    if (arrival == Arrival::kEnd || letter == '\n' || line.size() == kMaxY4mLine) break;
    line.push_back(static_cast<char>(letter));
  }
  const auto header = read_y4m_header(line, options.max_pixels);
  if (!header) {
    const std::size_t colon = header.error().find(": ");
    return tl::unexpected(
        pipe_error(InputErrorKind::kUnsupported, header.error().substr(0, colon), header.error().substr(colon + 2)));
  }
  return std::unique_ptr<LiveSource>(std::make_unique<Y4mSource>(pipe, *header, options));
}

}  // namespace moiregauge::internal
