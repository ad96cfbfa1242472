// SPDX-License-Identifier: Apache-2.0
// Which frames to distrust. The flags of libav cover a quarter of the frames that really differ; what it complains
// about in its log, carried on to the next key frame, covers nearly all. (Bit flips inside MJPEG stay silent: nothing
// here sees them.)
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace moiregauge::internal {

// Error lines libav has logged in this process so far. Counted by the log callback, which any thread may call.
[[nodiscard]] long errors_logged();
// Where in the file the reader of the container stood at each of its own error lines, in order; takes them. Its lines
// come while the container is probed, long before the packets there are handed out. Of the thread that reads only.
[[nodiscard]] std::vector<std::int64_t> places_of_complaints();
// Makes libav count instead of print.
void count_log_errors();

// Packets in the order of decoding, numbered from 1. A frame leans on the packets since its last key packet.
class Damage {
 public:
  void key_packet(std::int64_t packet) { keys_.push_back(packet); }
  void complaint(std::int64_t packet) {
    if (complaints_.empty() || complaints_.back() != packet) complaints_.push_back(packet);
  }
  [[nodiscard]] bool touches(std::int64_t packet) const {
    const auto after = std::upper_bound(keys_.begin(), keys_.end(), packet);
    const std::int64_t key = after == keys_.begin() ? 0 : *std::prev(after);
    return std::any_of(complaints_.begin(), complaints_.end(),
                       [&](std::int64_t at) { return at >= key && at <= packet; });
  }

 private:
  std::vector<std::int64_t> keys_;  // ascending
  std::vector<std::int64_t> complaints_;
};

}  // namespace moiregauge::internal
