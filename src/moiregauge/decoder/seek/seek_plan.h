// SPDX-License-Identifier: Apache-2.0
// Chooses the packet with which decoding starts, so that one frame of a video is reached without decoding all before it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace moiregauge::internal {

// A packet of the video, in the order of the file. Times are in the stream's own count.
struct PacketNote {
  std::optional<std::int64_t> shown;    // when its frame is shown
  std::optional<std::int64_t> decoded;  // when it is decoded: never falls
  bool is_key = false;
  bool is_hidden = false;  // its frame is decoded but not shown
};

struct SeekPlan {
  std::int64_t packet = 0;      // the first to decode; 0 is the first of the file
  std::int64_t first_time = 0;  // time of the first frame to show. Frames before it may be wrong
  long first_frame = 0;         // its number
  std::int64_t begin_time = 0;  // time of frame 0. Only with this time do the numbers hold
};

// Returns true if later packets cannot change the plan for frame `wanted`.
[[nodiscard]] bool is_enough(const std::vector<PacketNote>& packets, long wanted);

// Returns the plan with the last possible start for frame `wanted` and the `margin` frames before it. All shown frames
// have the pixels that decoding from the start gives. In an open group of pictures, frames after a key frame are shown
// before it and refer to frames before it. Such a key frame is reached from the one before.
// Returns nothing where the frames' times do not determine their numbers, or if there is nothing to skip.
[[nodiscard]] std::optional<SeekPlan> plan_seek(const std::vector<PacketNote>& packets, long wanted, long margin);

}  // namespace moiregauge::internal
