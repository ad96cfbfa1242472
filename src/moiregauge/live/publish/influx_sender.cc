// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/influx_sender.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/live/publish/block_text.h"
#include "moiregauge/live/publish/http.h"

namespace moiregauge::internal {
namespace {

class FileSender final : public BlockSender {
 public:
  explicit FileSender(std::string path) : path_(std::move(path)) {}
  void start(const LiveRun& run) override { run_ = run; }
  [[nodiscard]] SendResult send(const RowBlock& block) override {
    const std::string lines = influx_lines(run_, block);
    const int file = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0644);
    std::size_t done = 0;
    const off_t before = file < 0 ? 0 : ::lseek(file, 0, SEEK_END);
    while (file >= 0 && done < lines.size()) {
      const ssize_t written = ::write(file, lines.data() + done, lines.size() - done);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) break;
      done += static_cast<std::size_t>(written);
    }
    const bool is_sent = file >= 0 && done == lines.size();
    state_ = is_sent ? "writing" : fmt::format("cannot write ({})", std::strerror(errno));
    // A block that does not fit on the disk must not remain as half of one.
    if (!is_sent && file >= 0 && before >= 0) static_cast<void>(::ftruncate(file, before) == 0);
    if (file >= 0) ::close(file);
    return is_sent ? SendResult::kSent : SendResult::kRetry;
  }
  [[nodiscard]] std::string state() const override { return state_; }

 private:
  std::string path_;
  LiveRun run_;
  std::string state_;
};

class HttpSender final : public BlockSender {
 public:
  HttpSender(OutletUrl url, std::string token) : url_(std::move(url)), token_(std::move(token)) {}
  void start(const LiveRun& run) override { run_ = run; }
  [[nodiscard]] SendResult send(const RowBlock& block) override {
    const int status = post_text(url_, token_, influx_lines(run_, block));
    constexpr int kTooMany = 429;
    state_ = status == 0 ? "reconnecting" : status < 300 ? "connected" : fmt::format("refused (HTTP {})", status);
    if (status >= 200 && status < 300) return SendResult::kSent;
    return status >= 400 && status < 500 && status != kTooMany ? SendResult::kRefused : SendResult::kRetry;
  }
  [[nodiscard]] std::string state() const override { return state_; }

 private:
  OutletUrl url_;
  std::string token_;
  LiveRun run_;
  std::string state_ = "connecting";
};

}  // namespace

std::unique_ptr<BlockSender> influx_file_sender(std::string path) {
  return std::make_unique<FileSender>(std::move(path));
}

std::unique_ptr<BlockSender> influx_http_sender(OutletUrl url, std::string token) {
  return std::make_unique<HttpSender>(std::move(url), std::move(token));
}

}  // namespace moiregauge::internal
