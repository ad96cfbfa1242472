// SPDX-License-Identifier: Apache-2.0
// A recording of the paper's rig, rendered into memory; its truth is known.
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
inline constexpr std::array kSizes{Size{4104, 1012}, Size{4096, 2168}};  // the paper's recording, its whole sensor

// How far away the pixels are when a frame's turn comes.
enum class Memory {
  kHot,   // the same frame again and again
  kRing,  // a few frames in turn: the markers' windows fit into the last-level cache, the frames as a whole do not
  kCold,  // so many copies that not even the windows fit
};
[[nodiscard]] const char* word_for(Memory memory);

struct Shot {
  ImageView<std::uint8_t> picture;
  long frame = 0;  // in the scenario
};

using Error = std::array<double, 2>;  // measured minus true, along x and y

class Recording {
 public:
  // Rendered when first asked for, and kept.
  [[nodiscard]] static const Recording& of(const Size& size);

  [[nodiscard]] const simulator::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const Reference& reference() const { return reference_; }
  [[nodiscard]] const Image<std::uint8_t>& reference_frame() const { return frames_.front(); }
  // In an order in which the camera never moves further than between neighbouring frames, at the wrap too. Every frame
  // of the ring is among its first frames().
  [[nodiscard]] const std::vector<Shot>& shots(Memory memory) const;
  [[nodiscard]] std::size_t frames() const { return frames_.size() - 1; }
  [[nodiscard]] std::size_t frame_bytes() const {
    return static_cast<std::size_t>(scenario_.camera.width) * static_cast<std::size_t>(scenario_.camera.height);
  }
  // Of the markers' prints in one frame, in whole cache lines: a row of a window takes one more than it fills.
  [[nodiscard]] std::size_t window_bytes() const;
  // Of a site marker's displacement, mm.
  [[nodiscard]] Error error(std::size_t marker, Extent<frame::Board> measured, long frame) const;
  // Of the circle that was found nearest to the first reference's, px; the others have the same noise.
  [[nodiscard]] Error circle_error(const std::vector<ImagePoint>& found, long frame) const;

 private:
  explicit Recording(const Size& size);
  [[nodiscard]] std::vector<Shot> cold_copies() const;

  simulator::Scenario scenario_;
  std::vector<Image<std::uint8_t>> frames_;  // the reference frame first
  Reference reference_;
  std::vector<Shot> ring_, hot_;
  mutable std::vector<Shot> cold_;  // large, so made when first asked for
  mutable std::vector<std::unique_ptr<std::uint8_t[]>> copies_;
};

[[nodiscard]] std::size_t last_level_cache_bytes();

}  // namespace moiregauge::internal::bench
