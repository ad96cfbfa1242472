// SPDX-License-Identifier: Apache-2.0
// Learns the template of a marker's grating, and fits it to later frames, for `precise`
// (docs/methods/precise/template.md).
#pragma once

#include <optional>
#include <string_view>

#include "moiregauge/geometry/view.h"
#include "moiregauge/observation/print/outline.h"
#include "moiregauge/observation/print/template_residuals.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Harmonics of a grating that are used. `kOff`: the fundamentals alone, in a window of whole pitches. The residual of
// the harmonics then counts as noise, on a binary grating ten times that of the pixels, and u is large. `kAuto`: the
// template, if its residual is smaller than that of the fundamentals. `kOn`: the template.
enum class TemplateUse { kAuto, kOn, kOff };
[[nodiscard]] std::string_view word_for(TemplateUse use);
[[nodiscard]] std::optional<TemplateUse> template_use_named(std::string_view word);

struct PrintModel {
  PrintTemplate print = PrintTemplate::cosine(0.0, 0.0);
  PatchWindow window;                  // pitches
  PatchFitOptions options;             // axes, and the rows of the first passes
  std::optional<PatchAtRest> at_rest;  // as learned from the reference frame
  std::optional<Outline> outline;
  // Map from the grating coordinates by site and view to those found. Where the site's positions are wrong by
  // millimetres, the view is stretched by several per cent, the same in every frame. So fits start from this map.
  PrintFromPrint correction;
  PrintMisses misses;  // residuals in the reference frame
  // Pitches. Standard uncertainty (k = 1) of the template's origin relative to the symmetry point of the site.
  double u_origin = 0.0;
};

// Clearance from the grating's edge: three sigma of a PSF with its pixel box, as for rasters.
inline constexpr double kPrintEdgePx = 2.4;

// Returns the map from the board to the coordinates of a grating that is displaced by `moved` from its site position.
[[nodiscard]] Homography<frame::Print, frame::Board> print_from_board(const Grating& grating,
                                                                      Extent<frame::Board> moved);

// Returns the map from raw pixels to grating coordinates, by the grating's corners in `view`. Every marker has a
// homography of its own, so the lens needs no attention inside a patch.
// Fails (nothing): the corners determine no homography.
// Error: below 0.001 px over 100 px of a -2 % lens.
[[nodiscard]] std::optional<PrintFromImage> local_map(const View& view, const Grating& grating,
                                                      Extent<frame::Board> moved);

struct LearnOptions {
  TemplateUse use = TemplateUse::kAuto;
  // Pitches. If positive, the origin is the grating's own symmetry point within that distance. `u_origin` is then its
  // uncertainty. If there is no such point, the origin remains, and `u_origin` is the distance of the nearest one.
  double origin_within = 0.0;
  // Grey levels are proportional to light. They need no width of lines, because more blur moves no edge there.
  bool in_light = true;
};

// Learns the template of a grating from one image, with harmonics up to pitch / 2.2 px, or the fundamentals alone by
// `use`. Template and map are fitted alternately, from the map by `view` or by the phases, until the map is constant.
// Displacement is zero where the site has the grating.
// Fails: PatchFitFailure names the reason.
[[nodiscard]] tl::expected<PrintModel, PatchFitFailure> learn_print(const LumaView& luma, const View& view,
                                                                    const Grating& grating,
                                                                    const LearnOptions& options);

// Fits the nine points of a marker in an image. Its displacement must be right to a tenth of a pitch.
// Fails: PatchFitFailure names the reason.
// Error: the information matrix of the fit.
[[nodiscard]] tl::expected<PatchFit, PatchFitFailure> read_points(const LumaView& luma, const View& view,
                                                                  const MovedGrating& at, const PrintModel& model,
                                                                  Rows rows = Rows::kAll);

// Largest change of scale or shear of a lattice. A larger one belongs to another pattern. The first round finds
// stretches too large. Chosen.
inline constexpr double kMaxStretched = 0.6;

}  // namespace moiregauge::internal
