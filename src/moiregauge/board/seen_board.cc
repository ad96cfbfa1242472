// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/board/seen_board.h"

#include <algorithm>

namespace moiregauge::internal {
namespace {

// Points of a lattice. With fewer, a larger grating may be next to it and is searched. Chosen.
constexpr std::size_t kPlenty = 25;

SeenBoard board_of(const IndexedLattice& lattice) {
  SeenBoard board;
  const bool dots = lattice.kind == LatticeKind::kDots;
  board.pattern = dots ? BoardPattern::kDots : BoardPattern::kCheckerboard;
  board.columns = lattice.columns;
  board.rows = lattice.rows;
  board.step_pitches = dots ? 1.0 : 0.5;
  board.points = lattice.points;
  if (dots && !lattice.points.empty()) {
    std::vector<double> sizes;
    for (const LatticePoint& p : lattice.points) sizes.push_back(p.size_px);
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    board.diameter_pitches = *middle / lattice.pitch_px;
  }
  return board;
}

bool is_crossed(const DetectedPatch& patch) {
  return patch.pattern != Pattern::kLinesX && patch.pattern != Pattern::kLinesY &&
         patch.pattern != Pattern::kCheckerboard;  // a checkerboard's corners are its lattice
}

}  // namespace

const char* name_of(BoardPattern pattern) {
  switch (pattern) {
    case BoardPattern::kDots:
      return "dots";
    case BoardPattern::kCheckerboard:
      return "checkerboard";
    case BoardPattern::kGrating:
      break;
  }
  return "grating";
}

std::optional<SeenBoard> find_board(const GreyPicture& picture) {
  CircleOptions circles;
  circles.min_diameter_px = DotSearchOptions{}.min_diameter_px;
  auto lattices = find_dot_lattices(picture.luma, find_circles(picture.luma, circles).circles);
  for (IndexedLattice& checker : find_checker_lattices(picture.luma, picture.bits))
    lattices.push_back(std::move(checker));
  SeenBoard best;
  for (const IndexedLattice& lattice : lattices) {
    if (lattice.points.size() > best.points.size()) best = board_of(lattice);
  }
  if (best.points.size() < kPlenty) {
    GratingSearchOptions options;
    options.bits = picture.bits;
    for (const DetectedPatch& patch : find_grating_patches(picture.luma, options)) {
      if (!is_crossed(patch) || patch.periods_x * patch.periods_y < static_cast<double>(best.points.size())) continue;
      SeenBoard grating = grating_points(picture.luma, patch);
      if (grating.points.size() > best.points.size()) best = std::move(grating);
    }
  }
  if (best.columns < kMinLatticeSide || best.rows < kMinLatticeSide) return std::nullopt;
  return best;
}

}  // namespace moiregauge::internal
