// SPDX-License-Identifier: Apache-2.0
// A recording in memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal::test {

// Frames of 4 x 4 pixels that state their number, 100 per second. A message ends it early.
class TinyRecording final : public FrameSource {
 public:
  explicit TinyRecording(long frames, std::string message = {})
      : frames_(frames), message_(std::move(message)), pixels_(4, 4) {
    info_.width = info_.height = 4;
    info_.fps = kFps;
  }
  [[nodiscard]] const InputInfo& info() const override { return info_; }
  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    if (next_ == frames_) {
      info_.frames = frames_;
      if (!message_.empty()) return input_failure(InputErrorKind::kDamaged, message_);
      return std::nullopt;
    }
    pixels_.at(0, 0) = static_cast<std::uint8_t>(next_);
    Frame frame;
    frame.number = next_;
    frame.time_s = static_cast<double>(next_++) / kFps;
    frame.luma = pixels_.view();
    return frame;
  }
  static constexpr double kFps = 100.0;

 private:
  long frames_;
  std::string message_;
  long next_ = 0;
  InputInfo info_;
  Image<std::uint8_t> pixels_;
};

}  // namespace moiregauge::internal::test
