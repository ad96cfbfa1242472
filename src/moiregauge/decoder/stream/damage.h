// SPDX-License-Identifier: Apache-2.0
// Determines which frames are damaged. libav's flags cover only a quarter of the frames that differ. Errors in its log,
// extended to the next key frame, cover nearly all. Bit errors inside MJPEG images remain undetected here.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

namespace moiregauge::internal {

// Returns the number of error lines logged by libav in this process. Any thread may log.
[[nodiscard]] long errors_logged();
// Returns the file positions of the container reader at each of its own error lines, in order, and clears them. It logs
// them while probing, long before the packets there are delivered. Call it in the reading thread only.
[[nodiscard]] std::vector<std::int64_t> places_of_complaints();
// Makes libav count errors instead of printing them.
void count_log_errors();

// Packets in decoding order, numbered from 1. A frame depends on all packets since its last key packet.
class Damage {
 public:
  void key_packet(std::int64_t packet) { keys_.push_back(packet); }
  void complaint(std::int64_t packet) {
    if (complaints_.empty() || complaints_.back() != packet) complaints_.push_back(packet);
  }
  // Forgets what concerns packets before the last key packet. Frames must leave the decoder in the order of packets.
  void forget() {
    if (keys_.empty()) return;
    keys_.erase(keys_.begin(), keys_.end() - 1);
    complaints_.erase(complaints_.begin(), std::lower_bound(complaints_.begin(), complaints_.end(), keys_.front()));
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
