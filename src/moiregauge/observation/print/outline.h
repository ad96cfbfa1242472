// SPDX-License-Identifier: Apache-2.0
// Determines the fringe order of a grating from its outline (docs/methods/precise/fringe-order.md). A phase repeats
// with every pitch, but the edges of the grating do not. Cells of half a pitch around the position from the phase show
// the fringe visibility, which does not depend on light. Every displacement by whole pitches is scored by the total
// visibility inside the outline.
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

// Outline of a grating in its own pitches, and its contrast to the surroundings in the reference frame.
struct Outline {
  PatchWindow window;  // extent of the grating, pitches
  // Map from the grating coordinates by site and view to the grating's own.
  PrintFromPrint correction;
  double present = 0.0;          // mean fringe visibility of a cell inside
  std::array<double, 2> step{};  // share of the score lost one pitch away, along x and y
};

enum class Order {
  // Not tested, or not decided by anything in the image. Continuity alone has determined it.
  kUnproven,
  kProven,  // outline or circle agree with the phase
  // They contradict the phase, or cannot decide between two orders.
  kContradicted,
};

struct OrderVerdict {
  Order order = Order::kUnproven;
  // mm: the displacement given, plus the whole pitches found.
  Extent<frame::Board> moved;
};

// Learns the outline of a grating from the reference frame.
// Fails (nothing): no outline is visible. The grating continues beyond the window, or similar patterns surround it.
[[nodiscard]] std::optional<Outline> learn_outline(const LumaView& luma, const View& view, const Grating& grating,
                                                   const PatchWindow& window, const PrintFromPrint& correction);

// Grating displaced by `moved` (mm) from its site position.
struct MovedGrating {
  const Grating& grating;
  Extent<frame::Board> moved{};
};

// Returns true if a displacement (mm, from the site's position) belongs to another marker.
using IsTaken = std::function<bool(Extent<frame::Board>)>;

// Verifies the fringe order in a frame. The displacement `by_phase` is right except for whole pitches. Searches three
// pitches around it, and 24 if that does not show the whole grating.
[[nodiscard]] OrderVerdict verify_fringe_order(const LumaView& luma, const View& view, const MovedGrating& by_phase,
                                               const Outline& outline, const IsTaken& is_taken);

// Limits of the search for a lost grating.
struct SearchLimits {
  int pitches;  // to each side of the start
  const IsTaken& is_taken;
};

// Searches a grating around its position in `from`. Returns the displacement of greatest total visibility, mm, to half
// a pitch.
// Fails (nothing): less than half of the grating is visible anywhere.
[[nodiscard]] std::optional<Extent<frame::Board>> search_print(const LumaView& luma, const View& view,
                                                               const MovedGrating& from, const Outline& outline,
                                                               const SearchLimits& limits);

// Returns the displacement (mm, to a quarter pitch) of a grating whose site position is uncertain. The site's scale and
// shear may be wrong by a quarter there. Searches within `pitches`. `is_hidden` marks pixels that show something else,
// such as the marker's circle.
// Fails (nothing): the grating has no visible outline.
[[nodiscard]] std::optional<Extent<frame::Board>> find_print(const LumaView& luma, const View& view,
                                                             const Grating& grating, int pitches,
                                                             const IsHidden& is_hidden);

}  // namespace moiregauge::internal
