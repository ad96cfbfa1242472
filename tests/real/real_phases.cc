// SPDX-License-Identifier: Apache-2.0
// Phase of a lattice in two views. One step of the lattice counts as 1 mm on the board.
#include <algorithm>
#include <vector>

#include "moiregauge/observation/raster/patch.h"
#include "real/real_lattices.h"

namespace moiregauge::internal::test {
namespace {

BoardPoint on_board(const Place& place) {
  return {static_cast<double>(place.first), -static_cast<double>(place.second)};
}

View view_of_lattice(const Places& places) {
  std::vector<BoardPoint> from;
  std::vector<IdealPoint> to;
  for (const auto& [place, at] : places) {
    from.push_back(on_board(place));
    to.push_back({at.x, at.y});
  }
  View view;
  if (const auto h = fit_homography<frame::Ideal, frame::Board>(from, to)) view.ideal_from_board = *h;
  return view;
}

bool whole_round(const Places& places, const Place& place, int reach) {
  for (int r = -reach; r <= reach; ++r) {
    for (int c = -reach; c <= reach; ++c) {
      if (!places.contains({place.first + c, place.second + r})) return false;
    }
  }
  return true;
}

}  // namespace

PhasePlaces phase_places(const LatticeView& first, const LatticeView& second, LatticeKind kind) {
  constexpr int kReach = 2;  // points to either side
  PhasePlaces out;
  const View first_view = view_of_lattice(first.places), second_view = view_of_lattice(second.places);
  for (const auto& [place, at] : first.places) {
    if (!whole_round(first.places, place, kReach) || !whole_round(second.places, place, kReach)) continue;
    Grating print;
    print.centre = on_board(place);
    print.width_mm = print.height_mm = 2.0 * kReach + 1.0;
    print.pattern = kind == LatticeKind::kDots ? Pattern::kDots : Pattern::kCheckerboard;
    print.pitch_mm = kind == LatticeKind::kDots ? 1.0 : 2.0;
    const double finest =
        std::min(first_view.finest_mm_per_px(print.centre), second_view.finest_mm_per_px(print.centre));
    const auto plan = plan_raster(print, finest, {});
    if (!plan) continue;
    const auto then = read_patch(view_of(first.picture), first.picture.bits, first_view, *plan, {});
    const auto now = read_patch(view_of(second.picture), second.picture.bits, second_view, *plan, {});
    if (!then.valid || !now.valid) continue;
    const auto moved = displacement_between(*plan, then, now);
    out.first[place] = first_view(print.centre);
    out.second[place] = second_view(print.centre + moved);
  }
  return out;
}

}  // namespace moiregauge::internal::test
