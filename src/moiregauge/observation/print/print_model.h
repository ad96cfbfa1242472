// SPDX-License-Identifier: Apache-2.0
// A marker's print as it is demodulated by `precise`: its template, learned from the footage, and the pixels that
// count.
#pragma once

#include <optional>
#include <string_view>

#include "moiregauge/geometry/view.h"
#include "moiregauge/observation/print/outline.h"
#include "moiregauge/observation/print/template_residuals.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Which harmonics of a print are used. Off: the fundamentals alone, in a window of whole pitches; what the harmonics
// leave is then taken for noise, on a binary print ten times the pixels', and u is wide. Auto: the template where it
// leaves less than the fundamentals do.
enum class TemplateUse { kAuto, kOn, kOff };
[[nodiscard]] std::string_view word_for(TemplateUse use);
[[nodiscard]] std::optional<TemplateUse> template_use_named(std::string_view word);

struct PrintModel {
  PrintTemplate print = PrintTemplate::cosine(0.0, 0.0);
  PatchWindow window;                  // pitches
  PatchFitOptions options;             // axes, and the rows that the first passes look at
  std::optional<PatchAtRest> at_rest;  // as it was learned
  std::optional<Outline> outline;
  // From the print coordinates that the site gives through a view to those found: where the site's places are off by
  // millimetres the view is stretched by per cents, the same in every frame, and a fit should not begin there.
  PrintFromPrint correction;
  PrintMisses misses;     // in the reference frame
  double u_origin = 0.0;  // pitches: of the template's origin against the symmetry point that the site means
};

// Kept clear of the print's edge: three sigma of a PSF with its pixel box, as the rasters do.
inline constexpr double kPrintEdgePx = 2.4;

// The print's own pitches at a board point, the grating standing `moved` away from where the site has it.
[[nodiscard]] Homography<frame::Print, frame::Board> print_from_board(const Grating& grating,
                                                                      Extent<frame::Board> moved);

// The map of a marker's raw pixels to its print, as `view` has it at the print's corners: a homography of its own for
// every marker, so that the lens needs no attention inside a patch (over 100 px of a -2 % lens it stays below 0.001 px).
[[nodiscard]] std::optional<PrintFromImage> local_map(const View& view, const Grating& grating,
                                                      Extent<frame::Board> moved);

// Learns the template of the grating from one picture: harmonics up to pitch / 2.2 px, the fundamental first; template
// and map in turn, beginning with the map as `view` or the phases have it, until the map stands still; or the
// fundamental alone, as `use` says. Zero displacement is where the site puts the print. With a positive `origin_within`
// (pitches) it is the print's own symmetry point next to there, and `u_origin` is how well that is known. If no such
// point is so near, the origin stays, and `u_origin` is how far off the nearest one is. Grey levels that are `in_light` already
// need no width of lines: there more blur moves no edge.
[[nodiscard]] tl::expected<PrintModel, PatchFitFailure> learn_print(const LumaView& luma, const View& view,
                                                                    const Grating& grating, TemplateUse use,
                                                                    double origin_within = 0.0, bool in_light = true);

// The nine points of the marker in a picture; `moved` to within a tenth of a pitch.
[[nodiscard]] tl::expected<PatchFit, PatchFitFailure> read_points(const LumaView& luma, const View& view,
                                                                  const Grating& grating, Extent<frame::Board> moved,
                                                                  const PrintModel& model, Rows rows = Rows::kAll);

// Scale and shear of a lattice farther off than this are something else's. (The first round sees too much of a
// stretch.)
inline constexpr double kMaxStretched = 0.6;

}  // namespace moiregauge::internal
