// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/outline.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "moiregauge/observation/print/print_model.h"
#include "moiregauge/observation/print/visibility.h"
#include "moiregauge/observation/raster/raster.h"

namespace moiregauge::internal {
namespace {

// All limits are chosen (docs/methods/precise/fringe-order.md).
constexpr int kNear = 3;  // pitches around the position from the phase, at first
constexpr int kFar = 24;  // at last
// Share of the reference frame's loss by which the score must fall from the best position to the next. Half a strip of
// the edge may therefore be hidden, but no more.
constexpr double kClear = 0.5;
// Limits of a grating that was found: share of its cells that show it, and visibility relative to the reference frame.
constexpr double kWhole = 0.5;
constexpr double kFaint = 0.1;
// Smallest share of a strip of the inside that must be lost one pitch away.
constexpr double kMinProminence = 0.4;

struct Place {
  int i = 0, j = 0;  // half pitches
  double score = -1.0;
};

// Returns true if a displacement maps the lattice onto itself: whole pitches, and for a checkerboard half of both.
bool is_whole(const Grating& grating, int i, int j) {
  const bool diagonal = fundamental_pitch_mm(grating) < 0.9 * grating.pitch_mm;
  return diagonal ? (i + j) % 2 == 0 : i % 2 == 0 && j % 2 == 0;
}

// Returns true if the window, displaced to this position, contains half of a grating or more.
bool is_print(const VisibilityMap& map, const Outline& outline, const Place& p) {
  auto cells = map.cells(outline.window, p.i, p.j);
  if (cells.empty()) return false;
  const auto high = cells.begin() + static_cast<std::ptrdiff_t>(cells.size() * 4 / 5);
  std::nth_element(cells.begin(), high, cells.end());
  const double full = *high;
  if (full < kFaint * outline.present) return false;
  const auto there = std::count_if(cells.begin(), cells.end(), [full](double c) { return c > 0.5 * full; });
  return static_cast<double>(there) >= kWhole * static_cast<double>(cells.size());
}

Extent<frame::Board> on_board(const Grating& grating, const Place& p) {
  const double c = std::cos(grating.angle_rad), s = std::sin(grating.angle_rad);
  const double x = 0.5 * p.i * grating.pitch_mm, y = 0.5 * p.j * grating.pitch_mm;
  return {c * x - s * y, s * x + c * y};
}

struct Ranked {
  Place best, next;
};

// Returns the best position, and the best other one along an axis that the grating shows.
Ranked rank(const VisibilityMap& map, const Grating& grating, const Outline& outline, int pitches,
            const std::function<bool(const Place&)>& is_taken) {
  Ranked r;
  std::vector<Place> all;
  for (int j = -2 * pitches; j <= 2 * pitches; ++j) {
    for (int i = -2 * pitches; i <= 2 * pitches; ++i) {
      if (!is_whole(grating, i, j) || is_taken({i, j, 0.0})) continue;
      all.push_back({i, j, map.sum(outline.window, i, j)});
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

// Returns the map from raw pixels to the grating's own coordinates.
std::optional<PrintFromImage> own_map(const View& view, const MovedGrating& at, const PrintFromPrint& correction) {
  const auto map = local_map(view, at.grating, at.moved);
  if (!map) return std::nullopt;
  return correction * *map;
}

}  // namespace

std::optional<Outline> learn_outline(const LumaView& luma, const View& view, const Grating& grating,
                                     const PatchWindow& window, const PrintFromPrint& correction) {
  Outline outline;
  outline.window = window;
  outline.correction = correction;
  const auto print_from_image = own_map(view, {grating}, correction);
  if (!print_from_image) return std::nullopt;
  const VisibilityMap map = presence_round(luma, grating, *print_from_image, with_margin(window, 1));
  const double here = map.sum(window, 0, 0);
  const auto cells = map.cells(window, 0, 0);
  if (!(here > 0.0)) return std::nullopt;
  outline.present = here / static_cast<double>(cells.size());
  const Axes axes = axes_of(grating);
  for (const std::size_t axis : {0u, 1u}) {
    if (!(axis == 0 ? axes.x : axes.y)) continue;
    double best = 0.0;
    for (const int side : {-2, 2}) best = std::max(best, map.sum(window, axis == 0 ? side : 0, axis == 0 ? 0 : side));
    outline.step[axis] = 1.0 - best / here;
    const double strip = 0.5 / (axis == 0 ? window.half_x : window.half_y);  // one pitch of the whole
    if (outline.step[axis] < kMinProminence * strip) return std::nullopt;
  }
  return outline;
}

OrderVerdict verify_fringe_order(const LumaView& luma, const View& view, const MovedGrating& by_phase,
                                 const Outline& outline, const IsTaken& is_taken) {
  const Grating& grating = by_phase.grating;
  const Extent<frame::Board> moved = by_phase.moved;
  const Axes axes = axes_of(grating);
  const auto print_from_image = own_map(view, by_phase, outline.correction);
  if (!print_from_image) return {Order::kContradicted, moved};
  for (const int pitches : {kNear, kFar}) {
    const VisibilityMap map = presence_round(luma, grating, *print_from_image, with_margin(outline.window, pitches));
    const Ranked r =
        rank(map, grating, outline, pitches, [&](const Place& p) { return is_taken(moved + on_board(grating, p)); });
    const bool at_the_end = std::abs(r.best.i) == 2 * pitches || std::abs(r.best.j) == 2 * pitches;
    if (at_the_end || !is_print(map, outline, r.best)) continue;
    double step = 1e30;
    if (axes.x) step = std::min(step, outline.step[0]);
    if (axes.y) step = std::min(step, outline.step[1]);
    if (r.best.score - r.next.score < kClear * step * r.best.score) return {Order::kContradicted, moved};
    return {Order::kProven, moved + on_board(grating, r.best)};
  }
  return {Order::kContradicted, moved};
}

std::optional<Extent<frame::Board>> search_print(const LumaView& luma, const View& view, const MovedGrating& from,
                                                 const Outline& outline, const SearchLimits& limits) {
  const auto print_from_image = own_map(view, from, outline.correction);
  if (!print_from_image) return std::nullopt;
  const int pitches = limits.pitches;
  const VisibilityMap map = presence_round(luma, from.grating, *print_from_image, with_margin(outline.window, pitches));
  Place best;
  for (int j = -2 * pitches; j <= 2 * pitches; ++j) {
    for (int i = -2 * pitches; i <= 2 * pitches; ++i) {
      const Place p{i, j, map.sum(outline.window, i, j)};
      if (p.score > best.score && !limits.is_taken(from.moved + on_board(from.grating, p))) best = p;
    }
  }
  if (!is_print(map, outline, best)) return std::nullopt;
  return from.moved + on_board(from.grating, best);
}

namespace {

// Returns the position at which the window has the greatest total visibility.
Place best_place(const VisibilityMap& map, const PatchWindow& window, int pitches) {
  Place best;
  for (int j = -2 * pitches; j <= 2 * pitches; ++j) {
    for (int i = -2 * pitches; i <= 2 * pitches; ++i) {
      const Place p{i, j, map.sum(window, i, j)};
      if (p.score > best.score) best = p;
    }
  }
  return best;
}

// Losses of a grating whose window is displaced by one pitch, to the low and to the high side.
struct Neighbours {
  double low, high;
  [[nodiscard]] double middle() const { return low + high > 0.0 ? 0.5 * (low - high) / (low + high) : 0.0; }  // pitches
};

Neighbours neighbours_of(const VisibilityMap& map, const PatchWindow& window, const Place& best, bool along_x) {
  const int x = along_x ? 2 : 0, y = along_x ? 0 : 2;
  return {best.score - map.sum(window, best.i - x, best.j - y), best.score - map.sum(window, best.i + x, best.j + y)};
}

// Returns true if the losses show an outline. Half a pitch off the middle of its cells, a grating loses little on one
// side and twice that on the other.
bool is_prominent(const Neighbours& b, double score, double half) {
  const double strip = kMinProminence * score * 0.5 / half;
  return 0.5 * (b.low + b.high) > strip && std::min(b.low, b.high) > 0.3 * strip;
}

bool is_plausible(const PrintFromPrint& lattice) {
  return (lattice.matrix().topLeftCorner<2, 2>() - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() < kMaxStretched;
}

constexpr double kRim = 0.25;  // pitches: cells at the edge are half paper
constexpr int kLatticeRounds = 2;

}  // namespace

std::optional<Extent<frame::Board>> find_print(const LumaView& luma, const View& view, const Grating& grating,
                                               int pitches, const IsHidden& is_hidden) {
  Outline outline;
  outline.window = {
      {0, 0}, 0.5 * grating.width_mm / grating.pitch_mm - kRim, 0.5 * grating.height_mm / grating.pitch_mm - kRim};
  const PatchWindow& window = outline.window;
  const Axes axes = axes_of(grating);
  PrintFromPrint correction;
  for (int round = 0; round <= kLatticeRounds; ++round) {
    const auto print_from_image = own_map(view, {grating}, correction);
    if (!print_from_image) return std::nullopt;
    const VisibilityMap map =
        presence_round(luma, grating, *print_from_image, with_margin(window, pitches + 1), is_hidden);
    const Place best = best_place(map, window, pitches);
    outline.present = best.score / static_cast<double>(map.cells(window, 0, 0).size());
    if (!is_print(map, outline, best)) return std::nullopt;
    if (round < kLatticeRounds) {
      correction = map.lattice(window, best.i, best.j, axes) * correction;
      if (!is_plausible(correction)) return std::nullopt;
      continue;
    }
    const Neighbours x = neighbours_of(map, window, best, true), y = neighbours_of(map, window, best, false);
    if ((axes.x && !is_prominent(x, best.score, window.half_x)) ||
        (axes.y && !is_prominent(y, best.score, window.half_y)))
      return std::nullopt;
    const PrintPoint own{0.5 * best.i + x.middle(), 0.5 * best.j + y.middle()};
    const PrintPoint p = correction.inverse()(own);
    const auto board = print_from_board(grating, {}).inverse();
    return board(p) - board({0, 0});
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
