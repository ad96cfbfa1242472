// SPDX-License-Identifier: Apache-2.0
// Regular targets on photographs: the same point has the same column and row in every view of a set, and four points of
// a rigid board say where all the others must be.
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
  kColours,   // a checkerboard's own: an odd and an even side
  kLargeDot,  // in a corner of the lattice
  kRings,     // dots with a hole
  kDiscs      // round the lattice, known to site.toml
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
  CircleSearch circles;                  // what the circle test accepts, whatever the lattice says
  std::vector<IndexedLattice> lattices;  // as found, largest first
  Discs discs;                           // round the lattice, in the order of the site; empty where there are none
  Places places;  // the largest, its columns and rows as in the first view; empty where landmarks are not in sight
};

// Every view of a set, in natural order. `data`: the folder that holds the sets.
[[nodiscard]] std::vector<LatticeView> lattice_views(const std::string& data, const PhotoSet& set);

// The difference between a view and the first one mapped by the homography of four references.
struct LatticeNull {
  int targets = 0;
  double rms_px = 0.0;
};
// References: the four outermost common points; targets: all the others.
[[nodiscard]] LatticeNull null_between(const Places& first, const Places& view);
// References: the discs; targets: all common points.
[[nodiscard]] LatticeNull null_by_discs(const Places& first, const Places& view, const Discs& discs_then,
                                        const Discs& discs_now);

// The same print points in two views, as the lattice's phase sees them: a patch of five by five points round each.
struct PhasePlaces {
  Places first, second;
};
[[nodiscard]] PhasePlaces phase_places(const LatticeView& first, const LatticeView& second, LatticeKind kind);

// The circle test against what the lattice says is there (its neighbours, never the dot itself).
struct Acceptance {
  int there = 0;
  int accepted = 0;
  double median_diameter_px = 0.0;
  [[nodiscard]] double share() const { return there == 0 ? 0.0 : static_cast<double>(accepted) / there; }
};
[[nodiscard]] Acceptance dots_accepted(const std::vector<LatticeView>& views);
[[nodiscard]] Acceptance squares_accepted(const std::vector<LatticeView>& views);

}  // namespace moiregauge::internal::test
