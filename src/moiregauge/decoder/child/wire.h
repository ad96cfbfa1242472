// SPDX-License-Identifier: Apache-2.0
// Protocol of parent and decoding child: records of fixed size over a socket that keeps them whole (SOCK_SEQPACKET),
// and pixels in slots of shared memory. The child is not trusted: the parent checks every number.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#include "moiregauge/image/quantiser.h"

namespace moiregauge::internal::wire {

// File descriptors of the child.
inline constexpr int kInputFile = 3;
inline constexpr int kMemoryFile = 4;
inline constexpr int kSocket = 5;
inline constexpr int kFirstUnusedFile = 6;

inline constexpr const char* kChildMode = "--decode-child";
inline constexpr const char* kLiveMode = "--decode-live-child";    // the input is a LiveAddress (live_stream.h)
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;  // px, upper limit of --max-pixels
inline constexpr int kMaxSlots = 8;
// Smallest number of slots: the parent reads one image, three wait in the child for later frames (margin.h), one is
// written.
inline constexpr int kFewestSlots = 5;

enum class Kind : std::int32_t { kOpened, kFrame, kWarning, kEnd, kFailed };

inline constexpr std::int32_t kSound = 0, kSpoilt = 1, kDamaged = 2;

using Text = std::array<char, 192>;

inline void put(Text& text, const std::string& value) {
  text.fill('\0');
  std::copy_n(value.begin(), std::min(value.size(), text.size() - 1), text.begin());
}
inline std::string get(const Text& text) { return {text.begin(), std::find(text.begin(), text.end(), '\0')}; }

// A message from child to parent.
struct Record {
  Kind kind = Kind::kEnd;
  // kOpened
  std::int32_t width = 0;  // px, as displayed
  std::int32_t height = 0;
  std::int32_t bits = 8;
  std::int32_t rotation_deg = 0;
  std::int32_t slots = 0;
  std::int64_t frames = -1;
  double fps = 0.0;  // frames/s; NaN: unknown
  // kFrame
  std::int32_t slot = 0;
  std::int32_t damaged = 0;  // kSound, kSpoilt (near a damaged frame) or kDamaged
  std::int64_t number = 0;
  double time_s = 0.0;
  double quantiser_step = 0.0;  // grey levels; 0: lossless, NaN: unknown
  std::int32_t predicted = 0;
  std::int32_t has_blocks = 0;  // the slot holds block quantisers after its pixels
  // kFrame of a live stream:
  std::int64_t host_ns = 0;     // CLOCK_MONOTONIC when the frame was decoded
  std::int64_t queue_full = 0;  // frames dropped so far because no slot was free
  std::int64_t undecoded = 0;   // packets so far that gave no frame
  // kFailed
  std::int32_t error = 0;  // an InputErrorKind
  // kOpened, live stream: times come from the camera's clock
  std::int32_t has_camera_times = 0;
  // kOpened: tone curve of the grey levels
  std::int32_t tone_kind = 0;  // a ToneCurve::Kind
  std::int32_t tone_is_tagged = 0;
  std::int32_t is_full_range = 1;
  double tone_gamma = 1.0;
  Text what{};    // kOpened: codec; kWarning, kFailed: problem
  Text advice{};  // kFailed: remedy; kOpened: start time as stated in the file
};
static_assert(std::is_trivially_copyable_v<Record>);

// A message from parent to child: this slot may be written again.
struct Release {
  std::int32_t slot = 0;
};

[[nodiscard]] inline std::size_t word_bytes(int bits) { return bits > 8 ? 2 : 1; }

// Returns the bytes of an image's pixels. The quantisers of its blocks follow in the slot.
[[nodiscard]] inline std::size_t picture_bytes(int width, int height, int bits) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * word_bytes(bits);
}

// Returns the bytes of one slot, rounded up to whole pages.
[[nodiscard]] inline std::size_t slot_bytes(int width, int height, int bits) {
  const auto blocks = static_cast<std::size_t>(blocks_across(width)) * static_cast<std::size_t>(blocks_across(height));
  return (picture_bytes(width, height, bits) + blocks + 4095) / 4096 * 4096;
}

// Memory for all slots, unless the smallest number of slots needs more (chosen).
inline constexpr std::size_t kEnoughBytes = std::size_t{256} << 20;

// Returns the number of slots: large images have fewer.
[[nodiscard]] inline int slots_for(std::size_t bytes_of_one) {
  return static_cast<int>(std::clamp<std::size_t>(kEnoughBytes / bytes_of_one, kFewestSlots, kMaxSlots));
}

// Returns the largest memory of all slots for images of `max_pixels`.
[[nodiscard]] inline std::uint64_t memory_limit(std::int64_t max_pixels) {
  return std::max<std::uint64_t>(kEnoughBytes, kFewestSlots * (2 * static_cast<std::uint64_t>(max_pixels) + 4096));
}

}  // namespace moiregauge::internal::wire
