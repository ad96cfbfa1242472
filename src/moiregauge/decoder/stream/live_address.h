// SPDX-License-Identifier: Apache-2.0
// Address of a live stream. The child receives it as text through a descriptor. The command line is visible to other
// users, and the address may contain a password.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace moiregauge::internal {

struct LiveAddress {
  std::string url;                            // rtsp://, rtsps://, http://, https://, or v4l2:/dev/videoN
  std::chrono::milliseconds timeout{10'000};  // silence after which the stream is lost
  std::optional<double> fps{};                // frames/s to set a V4L2 camera to
};

[[nodiscard]] std::string text_of(const LiveAddress& address);
// Returns nothing if the text is none of text_of().
[[nodiscard]] std::optional<LiveAddress> live_address_of(std::string_view text);

// Point in time at which libav's blocking calls give up.
class LiveDeadline {
 public:
  explicit LiveDeadline(std::chrono::milliseconds timeout) : timeout_(timeout) { restart(); }
  void restart() { at_ = std::chrono::steady_clock::now() + timeout_; }
  [[nodiscard]] bool is_over() const { return std::chrono::steady_clock::now() >= at_; }

 private:
  std::chrono::milliseconds timeout_;
  std::chrono::steady_clock::time_point at_;
};

}  // namespace moiregauge::internal
