// SPDX-License-Identifier: Apache-2.0
// A simulated recording of the paper's rig in memory, with known truth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::bench {

struct Size {
  int width = 0;
  int height = 0;
  [[nodiscard]] std::string name() const { return std::to_string(width) + "x" + std::to_string(height); }
};
inline constexpr std::array kSizes{Size{4104, 1012}, Size{4096, 2168}};  // px: the paper's recording, its whole sensor

// State of the caches before a frame is read.
enum class Memory {
  kHot,   // one frame, repeated
  kRing,  // 24 frames in turn: the markers' windows fit into the last-level cache, the whole frames do not
  kCold,  // copies of the frames, whose windows together do not fit into the last-level cache
};
[[nodiscard]] const char* word_for(Memory memory);

struct Shot {
  ImageView<std::uint8_t> picture;
  long frame = 0;  // number in the scenario
};

using Error = std::array<double, 2>;  // measured minus true, along x and y

class Recording {
 public:
  // Returns the recording, which is rendered at the first call.
  [[nodiscard]] static const Recording& of(const Size& size);

  [[nodiscard]] const simulator::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const Reference& reference() const { return reference_; }
  [[nodiscard]] const Image<std::uint8_t>& reference_frame() const { return frames_.front(); }
  // Returns the frames forwards and then backwards, so that the camera moves by one step only, also from the last to
  // the first. The first frames() of the ring are all different.
  [[nodiscard]] const std::vector<Shot>& shots(Memory memory) const;
  [[nodiscard]] std::size_t frames() const { return frames_.size() - 1; }
  [[nodiscard]] std::size_t frame_bytes() const {
    return static_cast<std::size_t>(scenario_.camera.width) * static_cast<std::size_t>(scenario_.camera.height);
  }
  // Returns the bytes of the markers' windows in one frame. Each row of a window counts one cache line more than its
  // width.
  [[nodiscard]] std::size_t window_bytes() const;
  // Returns the error in mm of a marker's displacement.
  [[nodiscard]] Error error(std::size_t marker, Extent<frame::Board> measured, long frame) const;
  // Returns the error in px of the detected circle nearest to that of the first reference. The others have the same
  // noise.
  [[nodiscard]] Error circle_error(const std::vector<ImagePoint>& found, long frame) const;

 private:
  explicit Recording(const Size& size);
  [[nodiscard]] std::vector<Shot> cold_copies() const;

  simulator::Scenario scenario_;
  std::vector<Image<std::uint8_t>> frames_;  // the first one is the reference frame
  Reference reference_;
  std::vector<Shot> ring_, hot_;
  mutable std::vector<Shot> cold_;  // made at the first use, because it is large
  mutable std::vector<std::unique_ptr<std::uint8_t[]>> copies_;
};

[[nodiscard]] std::size_t last_level_cache_bytes();

}  // namespace moiregauge::internal::bench
