// SPDX-License-Identifier: Apache-2.0
// Which whole pitch a print stands in, told from its outline. A phase repeats with every pitch; the print's own edges
// do not. Round the place where the phase puts it, cells of half a pitch say whether they show its lattice
// (fundamentals against the mean grey level, so light does not count), and every displacement by whole pitches is
// scored by how much of the lattice the print's outline then holds.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "moiregauge/geometry/view.h"
#include "moiregauge/image/image.h"
#include "moiregauge/observation/print/visibility.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// A print's outline in its own pitches, and how clearly it stands out in the reference frame.
struct Outline {
  PatchWindow window;            // where the print is
  PrintFromPrint correction;     // to its own coordinates from those that the site gives it through a view
  double present = 0.0;          // of a cell inside
  std::array<double, 2> step{};  // the part of the score lost one pitch beside, along x and y
};

enum class Order {
  kUnproven,      // nobody looked, or nothing in sight could tell: continuity alone has it
  kProven,        // outline or circle agree with the phase
  kContradicted,  // they do not, or cannot choose between two
};

struct OrderVerdict {
  Order order = Order::kUnproven;
  Extent<frame::Board> moved;  // mm, by whole pitches where the print was found to stand
};

// Empty where the print has no outline in sight: it goes on beyond the window, or like things surround it.
[[nodiscard]] std::optional<Outline> learn_outline(const LumaView& luma, const View& view, const Grating& grating,
                                                   const PatchWindow& window, const PrintFromPrint& correction);

// Is this place (mm from where the site has the print) another marker's?
using IsTaken = std::function<bool(Extent<frame::Board>)>;

// `moved`: where the phase puts the print, right but for whole pitches. Looks three pitches round it, and further when
// what it finds there is not the whole print.
[[nodiscard]] OrderVerdict verify_fringe_order(const LumaView& luma, const View& view, const Grating& grating,
                                               const Outline& outline, Extent<frame::Board> moved,
                                               const IsTaken& is_taken);

// Where the print may stand when nothing is known but that it is not at `from`: the place, to half a pitch, within
// `pitches` of it that shows most of its lattice. Nothing when half of it is nowhere seen.
[[nodiscard]] std::optional<Extent<frame::Board>> search_print(const LumaView& luma, const View& view,
                                                               const Grating& grating, const Outline& outline,
                                                               Extent<frame::Board> from, int pitches,
                                                               const IsTaken& is_taken);

// How far (mm, to a quarter pitch) a print hangs from where the site, which knows it but roughly, has it; the site's
// scale and shear there may be wrong by a quarter. Looks within `pitches`; nothing when the print has no outline in
// sight. `is_hidden`: pixels that show something else for certain, such as the marker's circle.
[[nodiscard]] std::optional<Extent<frame::Board>> find_print(const LumaView& luma, const View& view,
                                                             const Grating& grating, int pitches,
                                                             const IsHidden& is_hidden);

}  // namespace moiregauge::internal
