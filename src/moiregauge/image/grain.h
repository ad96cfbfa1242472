// SPDX-License-Identifier: Apache-2.0
// Grain of a recording: noise of single pixels. In a sensor it is independent from frame to frame. A camera that
// averages over time reduces it, and makes it alike in successive frames.
// If the camera moves, the same holds for flat tiles. The faint texture of paper and ink also lowers the ratio; a
// Laplacian removes most of it.
//
// Model: over a small tile of a still scene, the difference of two frames is offset, contrast change, movement along
// both gradients, and grain. The first four are fitted and removed. Independent grain of variance s leaves 2 s between
// frames one apart, and 2 s between frames two apart. A recursive filter of share a leaves 1 / (1 + a) of the latter in
// the former. The mean of N frames leaves one half.
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

// Sums over tiles and frames, from three successive frames each.
struct GrainSums {
  double one_apart = 0.0;  // squared grain between frames one apart, grey levels^2
  double two_apart = 0.0;  // the same between frames two apart
  double values = 0.0;     // degrees of freedom: pixels minus fitted parameters
  // Sums over tiles and frames of a^2, a b and b^2. a and b: the tile's part of one_apart and two_apart.
  std::array<double, 3> products{};
};

// Properties of a recording at one frame.
struct GrainConditions {
  bool is_still = false;              // the scene moved by at most 0.1 px in this frame and the last two
  bool is_lossless = false;           // no codec changed the grain
  std::vector<bool> is_uniform = {};  // for each tile: it shows uniform ink in this frame. Empty: unknown
};

// Samples the grain of tiles at fixed positions in the image.
class GrainSampler {
 public:
  // `tiles`: top-left pixels of tiles that lie inside the image.
  GrainSampler() = default;
  explicit GrainSampler(std::vector<PixelPosition> tiles) : tiles_(std::move(tiles)) {}
  // Continues at other positions, with a new sequence.
  void place(std::vector<PixelPosition> tiles);
  // Adds a frame. It is evaluated together with the last two, unless the sequence was interrupted. If the scene moved,
  // only flat tiles count that show uniform ink in all three frames, in sums of their own. Tiles that touch black (0) or
  // `white` are excluded, because clipping removes grain. Without a codec, tiles are excluded that something covers or
  // uncovers.
  void add(const LumaView& luma, int white, const GrainConditions& conditions);
  // Interrupts the sequence: the next frame has no predecessors.
  void interrupt() { filled_ = 0; }
  [[nodiscard]] const std::vector<PixelPosition>& tiles() const { return tiles_; }
  [[nodiscard]] const GrainSums& still() const { return still_; }
  [[nodiscard]] const GrainSums& moving() const { return moving_; }

 private:
  std::vector<PixelPosition> tiles_;
  std::array<std::vector<std::uint16_t>, 3> frames_;  // the tiles' pixels, the newest first
  std::array<std::vector<bool>, 3> is_uniform_;       // as GrainConditions::is_uniform, the newest first
  int filled_ = 0;
  GrainSums still_, moving_;
};

}  // namespace moiregauge::internal
