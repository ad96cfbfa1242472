// SPDX-License-Identifier: Apache-2.0
// Everything that is seen in one picture before anything is measured: circles, gratings, lattices, and who is taken for
// what.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/observation/raster/noise.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/observation/reference/site_from_picture.h"

namespace moiregauge::internal {

struct InspectOptions {
  std::optional<Site> site = std::nullopt;
  std::optional<double> pitch_mm = std::nullopt;  // no site file: markers are told apart as `measure --pitch` does
  BoardAxes axes = BoardAxes::kPrint;
  Camera lens = {};
  ObserveOptions observe = {};
};

inline constexpr int kNobody = -1;  // seen, and taken for no marker

struct InspectedCircle {
  DetectedCircle seen;
  int marker = kNobody;   // index in the reference's site
  int lattice = kNobody;  // index in the inspection's lattices: one of its dots
};

struct InspectedPatch {
  DetectedPatch seen;   // modulation and noise in grey levels as stored
  PixelNoise noise;     // of the raw pixels in and round the outline
  double pixels = 0.0;  // picture pixels inside the outline
  int marker = kNobody;
};

// What a length on the board is counted in.
enum class BoardUnit { kMillimetre, kPitch };
[[nodiscard]] const char* word_for(BoardUnit unit);  // "mm", "pitches"

struct Inspection {
  int width = 0;  // px
  int height = 0;
  std::vector<InspectedCircle> circles;
  std::vector<RejectedOutline> rejected;  // by falling W
  std::vector<InspectedPatch> patches;    // strongest first
  std::vector<IndexedLattice> lattices;   // dots, then checkers, each largest first
  std::optional<Reference> reference;     // empty: a measurement cannot begin with this picture
  std::string missing;                    // why not, in words; empty otherwise
  std::vector<std::string> notes;         // what a user should know about who was taken for what
  BoardUnit unit = BoardUnit::kMillimetre;
  double pitch_of_unit = 1.0;  // the reference's board lengths / this = lengths in `unit`
};

[[nodiscard]] Inspection inspect_picture(const GreyPicture& picture, const InspectOptions& options);

// One pitch along the print's own axes in the picture, px: along x (rightwards) and along y (upwards). Of lines, only
// the axis along which grey varies; the other is zero.
struct PatchAxes {
  ImageExtent x, y;
};
[[nodiscard]] PatchAxes axes_of(const DetectedPatch& patch);

// Standard uncertainty (k = 1) of a displacement read in this patch alone by a camera that stands still, along the
// print's axes, px: the Cramer-Rao bound of the fundamentals over every pixel of the outline, twice, for both frames
// count. NaN along an axis that the print cannot show.
struct PatchBound {
  double along_x_px = 0.0;
  double along_y_px = 0.0;
};
[[nodiscard]] PatchBound displacement_bound(const InspectedPatch& patch);

}  // namespace moiregauge::internal
