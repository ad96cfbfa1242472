// SPDX-License-Identifier: Apache-2.0
// Detects everything in one image before a measurement: circles, gratings, lattices, and their identification.
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
  // Without a site file. The markers are then identified as by `measure --pitch`.
  std::optional<double> pitch_mm = std::nullopt;
  BoardAxes axes = BoardAxes::kPrint;
  Camera lens = {};
  ObserveOptions observe = {};
  // Among the markers found; `site` already follows it.
  MarkerChoice choice = {};
};

inline constexpr int kUnidentified = -1;  // detected, but identified as no marker

struct InspectedCircle {
  DetectedCircle seen;
  int marker = kUnidentified;  // index in the reference's site
  // Index in the inspection's lattices, if the circle is a dot of one.
  int lattice = kUnidentified;
};

struct InspectedPatch {
  DetectedPatch seen;   // modulation and noise in grey levels as stored
  PixelNoise noise;     // raw pixels in and around the outline
  double pixels = 0.0;  // image pixels inside the outline
  int marker = kUnidentified;
};

// Unit of lengths on the board.
enum class BoardUnit { kMillimetre, kPitch };
// Returns "mm" or "pitches".
[[nodiscard]] const char* word_for(BoardUnit unit);

struct Inspection {
  int width = 0;  // px
  int height = 0;
  std::vector<InspectedCircle> circles;
  std::vector<RejectedOutline> rejected;  // highest W first
  std::vector<InspectedPatch> patches;    // strongest first
  std::vector<IndexedLattice> lattices;   // dots, then checkers, each largest first
  std::optional<Reference> reference;     // empty: no measurement can start with this image
  std::string missing;                    // reason, if `reference` is empty
  bool is_choice_unknown = false;         // the reason is a chosen marker that was not found
  std::vector<std::string> notes;         // identifications that the user should check
  BoardUnit unit = BoardUnit::kMillimetre;
  // Length on the board of one `unit`.
  double pitch_of_unit = 1.0;
};

// Returns everything detected in an image. `reference` is empty if the markers cannot be identified.
[[nodiscard]] Inspection inspect_picture(const GreyPicture& picture, const InspectOptions& options);

// One pitch along the grating's own axes in the image, px: along x (rightwards) and along y (upwards). For lines, only
// the axis along which the grey level varies is given, and the other is zero.
struct PatchAxes {
  ImageExtent x, y;
};
// Returns the axes of a detected grating.
[[nodiscard]] PatchAxes axes_of(const DetectedPatch& patch);

// Standard uncertainty (k = 1) of a displacement read in this patch alone with a fixed camera, along the grating's
// axes, px. It is the Cramér-Rao bound of the fundamentals over all pixels of the outline. Its variance counts twice,
// once for each of the two frames. NaN for an axis that the grating does not show.
struct PatchBound {
  double along_x_px = 0.0;
  double along_y_px = 0.0;
};
// Returns that bound for a detected grating.
[[nodiscard]] PatchBound displacement_bound(const InspectedPatch& patch);

}  // namespace moiregauge::internal
