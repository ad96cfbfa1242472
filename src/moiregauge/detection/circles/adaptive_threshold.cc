// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/circles/adaptive_threshold.h"

#include <algorithm>
#include <cstring>

namespace moiregauge::internal::markers_detail {
namespace {

constexpr int kBlockTiles = 4;  // tiles per side of a block; the image is cut into parts along blocks

// Flag per block: 1 if one of its tiles has a threshold above 0.
struct BusyBlocks {
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> busy;

  BusyBlocks(int tile_columns, int tile_rows)
      : columns(tile_columns / kBlockTiles),
        rows((tile_rows + kBlockTiles - 1) / kBlockTiles),
        busy(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), std::uint8_t{0}) {}
  [[nodiscard]] bool at(int x, int y) const { return busy[static_cast<std::size_t>(y * columns + x)] != 0; }

  void add(const std::uint8_t* thresholds, int tile_y) {
    for (int x = 0; x < columns; ++x) {
      std::uint32_t tiles = 0;
      static_assert(sizeof tiles == kBlockTiles);
      std::memcpy(&tiles, thresholds + x * kBlockTiles, sizeof tiles);
      if (tiles != 0) busy[static_cast<std::size_t>(tile_y / kBlockTiles * columns + x)] = 1;
    }
  }
};

struct Run {
  int begin = 0, end = 0;
};

// Returns the intervals within [from, to) on which is_busy is true.
template <typename IsBusy>
std::vector<Run> runs(int from, int to, IsBusy is_busy) {
  std::vector<Run> out;
  for (int i = from; i < to; ++i) {
    if (!is_busy(i)) continue;
    if (out.empty() || out.back().end < i) out.push_back({i, i});
    out.back().end = i + 1;
  }
  return out;
}

// Splits `box` (in blocks) along empty rows and columns of blocks until none is left.
void cut(const BusyBlocks& blocks, const PicturePart& box, std::vector<PicturePart>& out) {
  const auto row_is_busy = [&](int y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (blocks.at(x, y)) return true;
    }
    return false;
  };
  const auto rows = runs(box.y, box.y + box.height, row_is_busy);
  for (const Run& row : rows) {
    const auto column_is_busy = [&](int x) {
      for (int y = row.begin; y < row.end; ++y) {
        if (blocks.at(x, y)) return true;
      }
      return false;
    };
    const auto columns = runs(box.x, box.x + box.width, column_is_busy);
    for (const Run& column : columns) {
      const PicturePart part{column.begin, row.begin, column.end - column.begin, row.end - row.begin};
      if (rows.size() == 1 && columns.size() == 1) {
        out.push_back(part);
      } else {
        cut(blocks, part, out);
      }
    }
  }
}

std::vector<PicturePart> parts_of(const BusyBlocks& blocks, const GreyView& picture) {
  std::vector<PicturePart> parts;
  cut(blocks, {0, 0, blocks.columns, blocks.rows}, parts);
  constexpr int kSide = kBlockTiles * kTilePx;
  for (PicturePart& part : parts) {
    const int x = part.x * kSide, y = part.y * kSide;
    part = {x, y, std::min(part.width * kSide, picture.width - x), std::min(part.height * kSide, picture.height - y)};
  }
  return parts;
}

// Ring buffer of the extremes of three tile rows: above, current, below.
class RowsInHand {
 public:
  explicit RowsInHand(int strips) : stride_(static_cast<std::size_t>(strips * kStripTiles) + 2 * kMargin) {
    low_.assign(3 * stride_, 255);
    high_.assign(3 * stride_, 0);
  }
  [[nodiscard]] std::uint8_t* low(int tile_y) { return at(low_, tile_y); }
  [[nodiscard]] std::uint8_t* high(int tile_y) { return at(high_, tile_y); }
  void forget(int tile_y, int strips) {
    std::fill_n(low(tile_y), strips * kStripTiles, std::uint8_t{255});
    std::fill_n(high(tile_y), strips * kStripTiles, std::uint8_t{0});
  }
  [[nodiscard]] ThreeTileRows round(int tile_y) {
    return {{low(tile_y - 1), low(tile_y), low(tile_y + 1)}, {high(tile_y - 1), high(tile_y), high(tile_y + 1)}};
  }

 private:
  static constexpr std::size_t kMargin = 1;  // tiles to either side with neutral extremes (255, 0)
  [[nodiscard]] std::uint8_t* at(std::vector<std::uint8_t>& rows, int tile_y) const {
    return rows.data() + static_cast<std::size_t>((tile_y + 3) % 3) * stride_ + kMargin;
  }
  std::size_t stride_;
  std::vector<std::uint8_t> low_, high_;
};

void halve_rows(const GreyView& picture, int from, int to, Image<std::uint8_t>& half) {
  for (int y = from; y < std::min(to, half.height()); ++y)
    halve_row(picture.row(2 * y).data(), picture.row(2 * y + 1).data(), half.width(), half.row(y).data());
}

}  // namespace

Image<std::uint8_t> halved(const GreyView& picture) {
  Image<std::uint8_t> half(picture.width / 2, picture.height / 2);
  halve_rows(picture, 0, half.height(), half);
  return half;
}

TileThresholds tile_thresholds(const GreyView& picture, int min_contrast, Image<std::uint8_t>* half) {
  const int rows = tiles_in(picture.height), strips = strips_in(picture.width);
  TileThresholds out;
  out.stride = (strips + 1) * kStripTiles;
  out.tiles.resize(static_cast<std::size_t>(out.stride) * static_cast<std::size_t>(rows));
  BusyBlocks blocks(strips * kStripTiles, rows);
  RowsInHand in_hand(strips);
  if (half != nullptr) *half = Image<std::uint8_t>(picture.width / 2, picture.height / 2);
  for (int y = 0; y <= rows; ++y) {
    if (y < rows) {
      tile_row_extremes(picture, y, in_hand.low(y), in_hand.high(y));
      if (half != nullptr) halve_rows(picture, y * kTilePx / 2, (y + 1) * kTilePx / 2, *half);
    } else {
      in_hand.forget(y, strips);
    }
    if (y == 0) continue;
    std::uint8_t* const thresholds = out.tiles.data() + (y - 1) * out.stride;
    tile_row_threshold(in_hand.round(y - 1), strips, min_contrast, thresholds);
    blocks.add(thresholds, y - 1);
  }
  out.parts = parts_of(blocks, picture);
  return out;
}

GreyView dark_part(const GreyView& picture, const TileThresholds& thresholds, const PicturePart& part,
                   std::vector<std::uint8_t>& memory) {
  const int strips = strips_in(part.width);
  const std::ptrdiff_t stride = strips * kStripPx;
  const auto needed = static_cast<std::size_t>(stride) * static_cast<std::size_t>(part.height);
  if (memory.size() < needed) memory.resize(needed);
  for (int y = 0; y < part.height; y += kTilePx) {
    for (int strip = 0; strip < strips; ++strip) {
      const Tile first{part.x / kTilePx + strip * kStripTiles, (part.y + y) / kTilePx};
      dark_strip(picture, first, thresholds.from(first), memory.data() + y * stride + strip * kStripPx, stride);
    }
  }
  return {memory.data(), part.width, part.height, stride};
}

}  // namespace moiregauge::internal::markers_detail
