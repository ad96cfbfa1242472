// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/identity/identify_markers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "moiregauge/detection/identity/assignments.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using markers_detail::Assignment;
using markers_detail::AssignmentSearch;
using markers_detail::find_assignments;
using markers_detail::ReferenceCircle;

constexpr double kDecisive = 12.0;  // difference of misfit that decides: a likelihood ratio of exp(6) = 400
constexpr double kSameRoll = 0.05;  // rad: two rotations of one layout with a smaller difference of |roll| are a tie
constexpr double kOtherTurn = 0.3;  // rad of roll: a smaller difference is the same rotation, by other outlines
constexpr double kSamePlaceShare = 0.25;  // in diameters: concentric outlines (disc in a ring) have one position
constexpr std::size_t kCrowd = 40;        // circles of one size: more are a printed pattern of dots (chosen)
constexpr double kCrowdSize = 0.15;       // relative difference of diameters within one size
constexpr double kTargetReach = 0.1;      // in layout sizes in the image: largest distance from the stated position
constexpr double kTargetSize = 0.2;       // relative difference from the stated diameter
constexpr double kTravelShare = 0.05;  // relative to the layout's size: movement that counts as one standard deviation

struct References {
  std::vector<std::size_t> marker;
  std::vector<ReferenceCircle> circles;
};

References references_of(const Site& site) {
  References out;
  for (std::size_t m = 0; m < site.markers.size(); ++m) {
    const Marker& marker = site.markers[m];
    if (marker.role != Role::kReference || !marker.circle) continue;
    out.marker.push_back(m);
    out.circles.push_back({marker.circle->centre, marker.circle->diameter_mm});
  }
  return out;
}

template <typename... Values>
std::string text_of(const char* format, Values... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// Returns a flag per circle: true if more than kCrowd circles have its size.
std::vector<bool> crowd_of(const std::vector<DetectedCircle>& circles) {
  std::vector<double> sizes;
  sizes.reserve(circles.size());
  for (const DetectedCircle& c : circles) sizes.push_back(c.diameter_px);
  std::sort(sizes.begin(), sizes.end());
  std::vector<bool> out;
  for (const DetectedCircle& c : circles) {
    const auto low = std::lower_bound(sizes.begin(), sizes.end(), c.diameter_px * (1.0 - kCrowdSize));
    const auto high = std::upper_bound(sizes.begin(), sizes.end(), c.diameter_px * (1.0 + kCrowdSize));
    out.push_back(static_cast<std::size_t>(high - low) > kCrowd);
  }
  return out;
}

bool same_places(const Assignment& a, const Assignment& b, const std::vector<DetectedCircle>& seen) {
  // Compares sets of positions, without regard to which reference a circle is assigned to.
  const auto at_a_place_of = [&](int i, const Assignment& other) {
    return std::any_of(other.circle_of_reference.begin(), other.circle_of_reference.end(), [&](int k) {
      if (k < 0) return false;
      const DetectedCircle &p = seen[static_cast<std::size_t>(i)], &q = seen[static_cast<std::size_t>(k)];
      return length(p.centre - q.centre) < kSamePlaceShare * std::max(p.diameter_px, q.diameter_px);
    });
  };
  return std::all_of(a.circle_of_reference.begin(), a.circle_of_reference.end(),
                     [&](int i) { return i < 0 || at_a_place_of(i, b); });
}

bool other_turn(const Assignment& a, const Assignment& b) {
  return std::abs(std::remainder(a.roll_rad - b.roll_rad, kTwoPi)) > kOtherTurn;
}

struct Ranked {
  const Assignment* assignment = nullptr;
  double cost = 0.0;      // misfit, plus movement in later frames
  double distance = 0.0;  // from upright (rad) or from the previous frame (px): decides between rotations of one set
};

// Returns the best set of circles in its nearest rotation. Null, with the reason, if two solutions are equally good.
const Assignment* decide(std::vector<Ranked> ranked, const std::vector<DetectedCircle>& seen, double same_distance,
                         const char* nearest_to, std::string& reason) {
  std::stable_sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.cost < b.cost; });
  const Ranked& best = ranked.front();
  const Ranked* chosen = &best;
  const Ranked* next = nullptr;
  for (const Ranked& r : ranked) {
    if (r.cost > best.cost + kDecisive) break;
    if (!same_places(*r.assignment, *best.assignment, seen)) {
      reason =
          text_of("two sets of circles fit the layout equally well (residuals %.1f and %.1f, minimum difference %.0f)",
                  best.cost, r.cost, kDecisive);
      return nullptr;
    }
    // Only another rotation competes by its distance. A concentric outline at the same position must fit better.
    if (other_turn(*r.assignment, *chosen->assignment) && r.distance < chosen->distance) chosen = &r;
  }
  for (const Ranked& r : ranked) {
    if (r.cost > best.cost + kDecisive || !other_turn(*r.assignment, *chosen->assignment)) continue;
    if (next == nullptr || r.distance < next->distance) next = &r;
  }
  if (next != nullptr && next->distance - chosen->distance < same_distance) {
    reason = text_of("two rotations of the layout are equally close to %s", nearest_to);
    return nullptr;
  }
  return chosen->assignment;
}

// Assigns to each target the nearest circle of its size within reach_px of its stated position. The reach is wide,
// because targets move.
void add_targets(const Site& site, const std::vector<DetectedCircle>& seen, double reach_px, Identified& out) {
  for (std::size_t m = 0; m < site.markers.size(); ++m) {
    const Marker& marker = site.markers[m];
    if (marker.role != Role::kTarget || !marker.circle) continue;
    const ImagePoint expected = out.image_from_board(marker.circle->centre);
    const double scale = std::sqrt(std::abs(out.image_from_board.jacobian(marker.circle->centre).determinant()));
    const double size = scale * marker.circle->diameter_mm;
    double nearest = reach_px;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double away = length(seen[i].centre - expected);
      const bool taken = std::find(out.circle_of_marker.begin(), out.circle_of_marker.end(), static_cast<int>(i)) !=
                         out.circle_of_marker.end();
      if (away >= nearest || taken) continue;
      if (size > 0.0 && std::abs(std::log(seen[i].diameter_px / size)) > kTargetSize) continue;
      nearest = away;
      out.circle_of_marker[m] = static_cast<int>(i);
    }
  }
}

double layout_px(const References& references, const Homography<frame::Image, frame::Board>& image_from_board) {
  double size = 0.0;
  for (const auto& r : references.circles) {
    for (const auto& q : references.circles) {
      size = std::max(size, length(image_from_board(r.centre) - image_from_board(q.centre)));
    }
  }
  return size;
}

using Distance = std::function<double(const Assignment&)>;

struct Preference {
  std::function<bool(std::size_t, std::size_t)> may_be;
  Distance distance;         // from upright or from the previous frame
  double distance_unit = 0;  // 0: distance does not add to the cost
  double same_distance = 0;  // a difference below this is a tie
  const char* nearest_to = "";
};

tl::expected<Identified, IdentityFailure> identify(const Site& site, const CircleSearch& search,
                                                   const Preference& prefer) {
  const References references = references_of(site);
  const std::vector<DetectedCircle>& seen = search.circles;
  const auto n = static_cast<int>(references.circles.size());
  const double best_rejected = search.best_rejected_circularity();
  const auto fail = [&](int found, std::string reason) {
    return tl::unexpected(IdentityFailure{found, std::max(4, n), best_rejected, std::move(reason)});
  };
  if (n < 4) return fail(n, text_of("the site has %d reference circles instead of 4 or more", n));
  if (seen.size() < 4) {
    const auto found = static_cast<int>(seen.size());
    return fail(found, text_of("only %d of %d reference circles were found (%s)", found, n,
                               best_rejected_outline(search).c_str()));
  }
  const std::vector<bool> crowd = crowd_of(seen);
  AssignmentSearch options =
      find_assignments(references.circles, seen, site.known_to.position_mm,
                       [&](std::size_t r, std::size_t i) { return !crowd[i] && prefer.may_be(r, i); });
  if (options.assignments.empty() && !options.gave_up) {
    options = find_assignments(references.circles, seen, site.known_to.position_mm, prefer.may_be);
  }
  if (options.gave_up)
    return fail(
        4, text_of("the references cannot be identified, because too many of %zu circles look alike", seen.size()));
  if (options.assignments.empty()) {
    return fail(std::min(static_cast<int>(seen.size()), n - 1),
                text_of("no four of the %zu circles found fit the layout of the site (%s)", seen.size(),
                        best_rejected_outline(search).c_str()));
  }
  std::vector<Ranked> ranked;
  for (const Assignment& a : options.assignments) {
    const double distance = prefer.distance(a);
    const double cost = a.misfit + (prefer.distance_unit > 0.0 ? std::pow(distance / prefer.distance_unit, 2) : 0.0);
    ranked.push_back({&a, cost, distance});
  }
  std::string reason;
  const Assignment* chosen = decide(ranked, seen, prefer.same_distance, prefer.nearest_to, reason);
  if (chosen == nullptr) return fail(n, std::move(reason));
  Identified out;
  out.image_from_board = chosen->image_from_board;
  out.circle_of_marker.assign(site.markers.size(), -1);
  for (std::size_t r = 0; r < references.marker.size(); ++r)
    out.circle_of_marker[references.marker[r]] = chosen->circle_of_reference[r];
  add_targets(site, seen, kTargetReach * layout_px(references, out.image_from_board), out);
  return out;
}

}  // namespace

std::string best_rejected_outline(const CircleSearch& search) {
  const auto best = std::max_element(search.rejected.begin(), search.rejected.end(),
                                     [](const auto& a, const auto& b) { return a.circularity < b.circularity; });
  if (best == search.rejected.end()) return "no other outline is almost a circle";
  return "best rejected outline " + best->why;
}

tl::expected<Identified, IdentityFailure> identify_first(const Site& site, const CircleSearch& search) {
  Preference prefer;
  prefer.may_be = [](std::size_t, std::size_t) { return true; };
  prefer.distance = [](const Assignment& a) { return std::abs(a.roll_rad); };
  prefer.same_distance = kSameRoll;
  prefer.nearest_to = "upright";
  return identify(site, search, prefer);
}

tl::expected<Identified, IdentityFailure> identify_next(const Site& site, const CircleSearch& search,
                                                        const PreviousCircles& previous) {
  const References references = references_of(site);
  const auto travel = [&](std::size_t r, std::size_t circle) {
    return length(search.circles[circle].centre - previous.image_from_board(references.circles[r].centre));
  };
  Preference prefer;
  prefer.may_be = [&](std::size_t r, std::size_t i) {
    return previous.max_travel_px <= 0.0 || travel(r, i) <= previous.max_travel_px;
  };
  prefer.distance = [&](const Assignment& a) {
    double squares = 0.0, circles = 0.0;
    for (std::size_t r = 0; r < references.circles.size(); ++r) {
      if (a.circle_of_reference[r] < 0) continue;
      squares += std::pow(travel(r, static_cast<std::size_t>(a.circle_of_reference[r])), 2);
      circles += 1.0;
    }
    return std::sqrt(squares / circles);
  };
  const double size = layout_px(references, previous.image_from_board);
  prefer.distance_unit = previous.max_travel_px > 0.0 ? previous.max_travel_px : kTravelShare * size;
  prefer.same_distance = 0.1 * kTravelShare * size;
  prefer.nearest_to = "the previous frame";
  return identify(site, search, prefer);
}

}  // namespace moiregauge::internal
