// SPDX-License-Identifier: Apache-2.0
// Number and time of the frames of a camera, from the counters that it sends.
#pragma once

#include <cstdint>
#include <optional>

namespace moiregauge::internal {

// Converts the camera's clock to seconds since frame 0.
//
// The camera's clock is used as long as it increases. After a reset (the camera was unplugged) or without a clock, the
// host's clock bridges the gap, so that time never runs backwards.
class CameraClock {
 public:
  // Returns the time of a frame, s. `device_ns` is empty for a camera without a clock. Times increase strictly.
  [[nodiscard]] double time_s(std::optional<std::int64_t> device_ns, std::int64_t host_ns);

 private:
  struct Anchor {
    std::int64_t device_ns = 0;
    std::int64_t host_ns = 0;
    std::int64_t time_ns = 0;  // since frame 0
    bool has_device = false;
  };
  std::optional<Anchor> anchor_;  // the frame from which times are counted
  std::int64_t last_device_ns_ = 0;
  std::int64_t last_host_ns_ = 0;
  std::int64_t last_time_ns_ = 0;
};

// Counts frames by the camera's frame identifiers, which wrap.
class FrameCounter {
 public:
  // Returns the number of a frame: 0 for the first, and one more for every frame sent since.
  [[nodiscard]] long number_of(std::uint64_t id);
  // Continues with the next number after a new connection, whose identifiers start again.
  void restart() { last_id_.reset(); }
  // Returns the number of identifiers that never arrived.
  [[nodiscard]] long missing() const { return missing_; }

 private:
  std::optional<std::uint64_t> last_id_;
  long next_ = 0;
  long missing_ = 0;
};

}  // namespace moiregauge::internal
