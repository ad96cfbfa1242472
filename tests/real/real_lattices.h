// SPDX-License-Identifier: Apache-2.0
// Lattices on photographs of rigid boards. A point has the same column and row in all views of a set. Four points
// determine the positions of all others.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal::test {

enum class Landmarks {
  kColours,   // colours of a checkerboard with an odd and an even side
  kLargeDot,  // a large dot in a corner of the lattice
  kRings,     // dots with a hole
  kDiscs      // discs around the lattice, stated in site.toml
};

struct PhotoSet {
  std::string name;
  LatticeKind kind = LatticeKind::kDots;
  Landmarks landmarks = Landmarks::kDiscs;
};

inline const std::vector<PhotoSet> kPhotoSets{{"handheld-chess", LatticeKind::kCheckerCorners, Landmarks::kColours},
                                              {"board-checker", LatticeKind::kCheckerCorners, Landmarks::kDiscs},
                                              {"board-dots", LatticeKind::kDots, Landmarks::kDiscs},
                                              {"stereo-dots", LatticeKind::kDots, Landmarks::kRings},
                                              {"robot-circles", LatticeKind::kDots, Landmarks::kLargeDot}};
[[nodiscard]] const PhotoSet& photo_set(const std::string& name);

using Place = std::pair<int, int>;  // column, row
using Places = std::map<Place, ImagePoint>;
using Discs = std::vector<ImagePoint>;

struct LatticeView {
  std::string file;
  Picture picture;
  CircleSearch circles;                  // result of the circle test, without the lattice
  std::vector<IndexedLattice> lattices;  // largest first
  Discs discs;                           // px, in the order of the site; empty if there are none
  // Points of the largest lattice, px, with columns and rows as in the first view. Empty if landmarks are not visible.
  Places places;
};

// Returns all views of a set in natural order. `data` is the folder that contains the sets.
[[nodiscard]] std::vector<LatticeView> lattice_views(const std::string& data, const PhotoSet& set);

// Difference between a view and the first one, mapped by the homography of four references. The truth is zero.
struct LatticeNull {
  int targets = 0;      // points compared
  double rms_px = 0.0;  // px
};
// Returns the null with the four outermost common points as references and all others as targets.
[[nodiscard]] LatticeNull null_between(const Places& first, const Places& view);
// Returns the null with the discs as references and all common points as targets.
[[nodiscard]] LatticeNull null_by_discs(const Places& first, const Places& view, const Discs& discs_then,
                                        const Discs& discs_now);

// Positions of the same points in two views, px.
struct PhasePlaces {
  Places first, second;
};
// Measures the positions by the phase of the lattice, in a patch of 5 x 5 points around each point.
[[nodiscard]] PhasePlaces phase_places(const LatticeView& first, const LatticeView& second, LatticeKind kind);

// Result of the circle test at positions predicted by the lattice. A prediction uses the neighbours only.
struct Acceptance {
  int there = 0;                    // predicted dots or squares
  int accepted = 0;                 // accepted as circles
  double median_diameter_px = 0.0;  // px
  [[nodiscard]] double share() const { return there == 0 ? 0.0 : static_cast<double>(accepted) / there; }
};
// Tests the dots of all views, which must be accepted.
[[nodiscard]] Acceptance dots_accepted(const std::vector<LatticeView>& views);
// Tests the squares of all views, which must be rejected.
[[nodiscard]] Acceptance squares_accepted(const std::vector<LatticeView>& views);

}  // namespace moiregauge::internal::test
