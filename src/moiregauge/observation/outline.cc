// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/outline.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "moiregauge/observation/presence.h"
#include "moiregauge/observation/raster.h"

namespace moiregauge {
namespace {

constexpr int kNear = 3;  // pitches looked round where the phase puts a print, at first
constexpr int kFar = 24;  // and at most
// A cell counts as print from half of what a cell inside shows.
constexpr double kShare = 0.5;
// The score must fall by this part of what a clean picture shows from the best place to the next: a strip of the
// print's edge may be half hidden or smeared, no more.
constexpr double kClear = 0.5;
// And the print found must be this whole, or the best place is a guess.
constexpr double kWhole = 0.5;
// In the reference frame an outline stands out if the cells beyond it, one pitch on, show less than this of the inside.
constexpr double kNothingBeyond = 0.6;

struct Place {
  int i = 0, j = 0;  // half pitches
  double score = -1e30;
};

// Places by which a lattice is displaced onto itself: whole pitches, and for a checkerboard half of both.
bool is_whole(const Grating& grating, int i, int j) {
  const bool diagonal = fundamental_pitch_mm(grating) < 0.9 * grating.pitch_mm;
  return diagonal ? (i + j) % 2 == 0 : i % 2 == 0 && j % 2 == 0;
}

double ideal(const Outline& o) { return 4.0 * (2.0 * o.window.half_x) * (2.0 * o.window.half_y) * o.present * kShare; }

struct Ranked {
  Place best, next;
};

// The best place and the best of those that lie beside it along an axis the print shows.
Ranked rank(const PresenceMap& map, const Grating& grating, const Outline& outline, int pitches) {
  Ranked r;
  std::vector<Place> all;
  for (int j = -2 * pitches; j <= 2 * pitches; ++j) {
    for (int i = -2 * pitches; i <= 2 * pitches; ++i) {
      if (!is_whole(grating, i, j)) continue;
      all.push_back({i, j, map.score(outline.window, i, j, kShare * outline.present)});
      if (all.back().score > r.best.score) r.best = all.back();
    }
  }
  const Axes axes = axes_of(grating);
  for (const Place& p : all) {
    const bool other = (axes.x && p.i != r.best.i) || (axes.y && p.j != r.best.j);
    if (other && p.score > r.next.score) r.next = p;
  }
  return r;
}

Extent<frame::Board> on_board(const Grating& grating, const Place& p) {
  const double c = std::cos(grating.angle_rad), s = std::sin(grating.angle_rad);
  const double x = 0.5 * p.i * grating.pitch_mm, y = 0.5 * p.j * grating.pitch_mm;
  return {c * x - s * y, s * x + c * y};
}

}  // namespace

std::optional<Outline> learn_outline(const LumaView& luma, const View& view, const Grating& grating,
                                     const PatchWindow& window) {
  Outline outline;
  outline.window = window;
  const auto map = presence_round(luma, view, grating, window, {}, 1);
  if (!map) return std::nullopt;
  outline.present = map->mean(window, 0, 0);
  const double here = map->score(window, 0, 0, kShare * outline.present);
  const Axes axes = axes_of(grating);
  for (const std::size_t axis : {0u, 1u}) {
    if (!(axis == 0 ? axes.x : axes.y)) continue;
    double least = 1e30;
    for (const int side : {-2, 2})
      least = std::min(least,
                       here - map->score(window, axis == 0 ? side : 0, axis == 0 ? 0 : side, kShare * outline.present));
    outline.step[axis] = least;
    // One pitch aside a strip of the inside is lost and one of the outside gained.
    const double across = axis == 0 ? window.half_y : window.half_x;
    const double strip = 4.0 * 2.0 * across * outline.present;
    if (least < (1.0 - kNothingBeyond) * strip) return std::nullopt;
  }
  return outline;
}

OrderVerdict prove_order(const LumaView& luma, const View& view, const Grating& grating, const Outline& outline,
                         Extent<frame::Board> moved) {
  const Axes axes = axes_of(grating);
  for (const int pitches : {kNear, kFar}) {
    const auto map = presence_round(luma, view, grating, outline.window, moved, pitches);
    if (!map) break;
    const Ranked r = rank(*map, grating, outline, pitches);
    const bool at_the_end = std::abs(r.best.i) == 2 * pitches || std::abs(r.best.j) == 2 * pitches;
    if (at_the_end || r.best.score < kWhole * ideal(outline)) continue;
    double step = 1e30;
    if (axes.x) step = std::min(step, outline.step[0]);
    if (axes.y) step = std::min(step, outline.step[1]);
    if (r.best.score - r.next.score < kClear * step) return {Order::kContradicted, moved};
    return {Order::kProven, moved + on_board(grating, r.best)};
  }
  return {Order::kContradicted, moved};
}

std::optional<Extent<frame::Board>> search_print(const LumaView& luma, const View& view, const Grating& grating,
                                                 const Outline& outline, Extent<frame::Board> from, int pitches) {
  const auto map = presence_round(luma, view, grating, outline.window, from, pitches);
  if (!map) return std::nullopt;
  Place best;
  for (int j = -2 * pitches; j <= 2 * pitches; ++j) {
    for (int i = -2 * pitches; i <= 2 * pitches; ++i) {
      const Place p{i, j, map->score(outline.window, i, j, kShare * outline.present)};
      if (p.score > best.score) best = p;
    }
  }
  if (best.score < kWhole * ideal(outline)) return std::nullopt;
  return from + on_board(grating, best);
}

}  // namespace moiregauge
