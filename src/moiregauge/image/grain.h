// SPDX-License-Identifier: Apache-2.0
// The grain of a recording: noise of single pixels, which in a sensor is independent from frame to frame. A camera that averages
// over time leaves less of it, and the same in one frame as in the next. Before a camera that moves the same holds
// for flat tiles, except for the faint texture of paper and ink, which lowers the ratio too. A Laplacian removes most of it.
//
// Model: over a small tile of a still scene, the difference of two frames is offset + contrast change + movement along
// both gradients + grain. The first four are fitted and removed. Independent grain of variance s leaves 2 s between
// frames one apart and 2 s between frames two apart. A recursive filter of share a leaves 1 / (1 + a) of the latter in
// the former, the mean of N frames one half.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

struct PixelPosition {
  int x = 0, y = 0;
};

inline constexpr int kGrainTile = 8;  // px, side of a tile

// Sums over tiles and frames, each of three frames in a row.
struct GrainSums {
  double one_apart = 0.0;  // squared grain between frames one apart, grey levels squared
  double two_apart = 0.0;  // and two apart
  double values = 0.0;     // degrees of freedom: pixels less fitted parameters
};

// Samples the grain of tiles at fixed positions in the image.
class GrainSampler {
 public:
  // `tiles`: top-left pixels of tiles that lie inside the picture.
  GrainSampler() = default;
  explicit GrainSampler(std::vector<PixelPosition> tiles) : tiles_(std::move(tiles)) {}
  // Continues at other positions. The sequence begins again.
  void place(std::vector<PixelPosition> tiles);
  // Adds a frame. It is evaluated together with the last two, unless the sequence was broken. If the scene moved
  // by more than 0.1 px in these three, only flat tiles count, and apart. Tiles that touch black (0) or `white` are excluded: clipping removes grain.
  void add(const LumaView& luma, int white, bool is_still);
  // Breaks the sequence: the next frame has none before it.
  void interrupt() { filled_ = 0; }
  [[nodiscard]] const GrainSums& still() const { return still_; }
  [[nodiscard]] const GrainSums& moving() const { return moving_; }

 private:
  std::vector<PixelPosition> tiles_;
  std::array<std::vector<std::uint16_t>, 3> frames_;  // the tiles' pixels, the newest first
  int filled_ = 0;
  GrainSums still_, moving_;
};

}  // namespace moiregauge::internal
