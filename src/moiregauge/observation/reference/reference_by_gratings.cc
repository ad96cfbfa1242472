// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/reference_by_gratings.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "moiregauge/observation/reference/site_from_picture.h"

namespace moiregauge::internal {
namespace {

constexpr std::ptrdiff_t kCirclesOfAView = 4;  // circles that a homography needs
constexpr double kSamePrint = 0.5;             // relative to a grating's shorter side: two gratings cannot be nearer

std::vector<Grating> gratings_of(const Site& site) {
  std::vector<Grating> gratings;
  for (const Marker& marker : site.markers) {
    if (marker.grating) gratings.push_back(*marker.grating);
  }
  return gratings;
}

// Detected grating for each of the site's, if the site is displaced by `shift` on the detected board.
struct GratingAssignment {
  Extent<frame::Board> shift;
  std::vector<std::optional<BoardPoint>> centres;
  std::size_t found = 0;
};

GratingAssignment assignment_of(const std::vector<Grating>& stated, const std::vector<Grating>& seen,
                                Extent<frame::Board> shift) {
  GratingAssignment out{shift, {}, 0};
  for (const Grating& grating : stated) {
    std::optional<BoardPoint> best;
    double least = kSamePrint * std::min(grating.width_mm, grating.height_mm);
    for (const Grating& candidate : seen) {
      const double away = length(candidate.centre - (grating.centre + shift));
      if (away > least) continue;
      least = away;
      best = candidate.centre;
    }
    out.found += best ? 1 : 0;
    out.centres.push_back(best);
  }
  return out;
}

bool is_same(const GratingAssignment& a, const GratingAssignment& b) {
  for (std::size_t i = 0; i < a.centres.size(); ++i) {
    if (a.centres[i].has_value() != b.centres[i].has_value()) return false;
    if (a.centres[i] && length(*a.centres[i] - *b.centres[i]) > 0.0) return false;
  }
  return true;
}

// Returns the shift that finds most of the site's gratings. Returns nothing if two different shifts find as many.
std::optional<GratingAssignment> best_assignment(const std::vector<Grating>& stated, const std::vector<Grating>& seen) {
  std::optional<GratingAssignment> best;
  bool is_ambiguous = false;
  for (const Grating& a : stated) {
    for (const Grating& b : seen) {
      GratingAssignment now = assignment_of(stated, seen, b.centre - a.centre);
      if (best && (now.found < best->found || is_same(now, *best))) continue;
      is_ambiguous = best && now.found == best->found;
      best = std::move(now);
    }
  }
  return is_ambiguous ? std::nullopt : best;
}

// Returns the site with every detected grating at its detected position.
Site placed_site(Site site, const GratingAssignment& assignment) {
  std::size_t i = 0;
  for (Marker& marker : site.markers) {
    if (!marker.grating) continue;
    const auto& centre = assignment.centres[i++];
    if (centre) marker.grating->centre = *centre + (-1.0) * assignment.shift;
  }
  return site;
}

}  // namespace

bool lacks_circles(const Site& site) {
  return std::count_if(site.markers.begin(), site.markers.end(), [](const Marker& marker) {
           return marker.role == Role::kReference && marker.circle.has_value();
         }) < kCirclesOfAView;
}

tl::expected<Reference, ReferenceFailure> make_reference_by_gratings(const GreyPicture& picture, const Site& site,
                                                                     const Camera& lens,
                                                                     const ObserveOptions& options) {
  const auto target = std::find_if(site.markers.begin(), site.markers.end(),
                                   [](const Marker& m) { return m.role == Role::kTarget && m.grating; });
  if (target == site.markers.end())
    return tl::unexpected(
        ReferenceFailure{ReferenceProblem::kNoGrating, "the site has no target with a grating", CircleSearch{}});
  auto found = detect_site(picture, lens, {target->grating->pitch_mm, BoardAxes::kPrint, options, {}, false});
  if (!found) return tl::unexpected(std::move(found.error()));
  const auto assignment = best_assignment(gratings_of(site), gratings_of(found->site));
  if (!assignment)
    return tl::unexpected(ReferenceFailure{
        ReferenceProblem::kNotFound,
        "the site fits the gratings in several ways, so state every grating in the site file", found->search});
  Matrix3 shift = Matrix3::Identity();
  shift(0, 2) = assignment->shift.x;
  shift(1, 2) = assignment->shift.y;
  const IdealFromBoard view(found->view.matrix() * shift);
  return make_reference_in_view(picture, placed_site(site, *assignment), {view, lens}, std::move(found->search),
                                options);
}

}  // namespace moiregauge::internal
