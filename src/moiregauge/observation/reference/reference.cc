// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "moiregauge/geometry/conic.h"
#include "moiregauge/observation/print/outline.h"
#include "moiregauge/observation/reference/site_check.h"
#include "moiregauge/observation/reference/site_layout.h"

namespace moiregauge::internal {
namespace {

constexpr double kSamePlace = 0.25;  // diameters, between a circle and its site position; chosen

double diameter_mm(const Circle& circle, const DetectedCircle& seen, const IdealFromBoard& h) {
  if (circle.diameter_mm > 0.0) return circle.diameter_mm;
  return seen.diameter_px * View{h, {}}.mm_per_px(circle.centre);
}

// Distance from which on the window moves to its grating, pitches. At a smaller one the window contains enough of it.
// Chosen.
constexpr double kMaxOffset = 0.35;

// Radius of a circle's mask, in radii. Next to a soft grating its circle would count as more grating. Chosen.
constexpr double kCircleAndRim = 1.1;

// Mask of a circle, on the board.
struct CircleMask {
  BoardPoint centre;
  double radius_mm = 0.0;
};

std::vector<CircleMask> circle_masks(const Reference& reference) {
  std::vector<CircleMask> masks;
  for (const MarkerObservation& m : reference.seen.markers) {
    if (!m.circle) continue;
    const BoardPoint centre = reference.view.board(m.circle->centre);
    masks.push_back({centre, kCircleAndRim * (0.5 * m.circle->diameter_px * reference.view.mm_per_px(centre))});
  }
  return masks;
}

// Returns the standard uncertainty of a grating's position in the view through the circles, mm. Its own position and
// those of all circles are known to position_mm. Far from short spacings the view magnifies these errors.
double u_of_place(const Reference& reference, BoardPoint place) {
  const double u = reference.site.known_to.position_mm;
  const IdealPoint seen = reference.view.ideal_from_board(place);
  double sum = u * u;
  for (std::size_t k = 0; k < reference.circles.size(); ++k) {
    for (const Extent<frame::Board> off : {Extent<frame::Board>{u, 0.0}, Extent<frame::Board>{0.0, u}}) {
      std::vector<CirclePoint> points = reference.circles;
      points[k].board = points[k].board + off;
      const auto h = fit_circles(points);
      if (!h) continue;
      const auto moved = h->inverse()(seen) - place;
      sum += length(moved) * length(moved);
    }
  }
  return std::sqrt(sum);
}

// Largest search distance. Chosen.
constexpr int kMaxPitchesOff = 8;

// Returns half the distance to the nearest other grating. A grating found beyond it would be the other one.
double half_way_mm(const Site& site, std::size_t own) {
  double nearest = 1e30;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (i == own || !site.markers[i].grating) continue;
    nearest = std::min(nearest, length(site.markers[i].grating->centre - site.markers[own].grating->centre));
  }
  return 0.5 * nearest;
}

void centre_windows(Reference& reference, const LumaView& luma) {
  if (!(reference.site.known_to.position_mm > 0.0)) return;
  const Site as_stated = reference.site;
  const std::vector<CircleMask> masks = circle_masks(reference);
  const auto is_circle = [&](ImagePoint p) {
    const BoardPoint at = reference.view.board(p);
    return std::ranges::any_of(masks, [at](const CircleMask& m) { return length(at - m.centre) < m.radius_mm; });
  };
  for (std::size_t i = 0; i < as_stated.markers.size(); ++i) {
    Marker& marker = reference.site.markers[i];
    if (!marker.grating) continue;
    const double may_be_off = 3.0 * u_of_place(reference, marker.grating->centre) / marker.grating->pitch_mm;
    if (may_be_off <= kMaxOffset) continue;
    const double room = half_way_mm(as_stated, i) / marker.grating->pitch_mm;
    const int pitches = static_cast<int>(std::ceil(std::min({may_be_off, room, double{kMaxPitchesOff}})));
    const auto found = find_print(luma, reference.view, *marker.grating, pitches, is_circle);
    if (found && length(*found) > kMaxOffset * marker.grating->pitch_mm)
      marker.grating->centre = marker.grating->centre + *found;
  }
}

// Plans one raster per grating, or records why it cannot.
void plan_rasters(Reference& reference) {
  for (const Marker& marker : reference.site.markers) {
    RasterPlan plan;
    Loss loss = Loss::kNone;
    if (marker.grating) {
      const auto planned = plan_raster(*marker.grating, reference.view.finest_mm_per_px(marker.grating->centre),
                                       reference.options.raster);
      if (planned)
        plan = *planned;
      else
        loss = planned.error() == RasterFailure::kTooCoarse ? Loss::kTooCoarse : Loss::kNoModulation;
    }
    reference.plans.push_back(plan);
    reference.plan_loss.push_back(loss);
  }
}

std::string coarse_message(const Reference& reference, std::size_t i) {
  const Marker& marker = reference.site.markers[i];
  const double px = fundamental_pitch_mm(*marker.grating) / reference.view.mm_per_px(marker.grating->centre);
  char text[200];
  std::snprintf(text, sizeof text, "the pitch of marker '%s' is %.2f px in the image, and at least %.1f px are needed",
                marker.name.c_str(), px, kMinPitchPx);
  return text;
}

void read_patches(Reference& reference, const GreyPicture& picture) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    MarkerObservation& seen = reference.seen.markers[i];
    seen.loss = reference.plan_loss[i];
    if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) continue;
    seen.patch = read_patch(picture.luma, picture.bits, reference.view, reference.plans[i], {});
    if (!seen.patch.valid) seen.loss = Loss::kNoModulation;
  }
}

std::optional<ReferenceFailure> problem_of(const Reference& reference) {
  bool any_target = false, any_axis = false;
  std::string askew;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    if (!marker.grating) continue;
    const Loss loss = reference.seen.markers[i].loss;
    if (loss == Loss::kTooCoarse)
      return ReferenceFailure{ReferenceProblem::kTooCoarse, coarse_message(reference, i), reference.search};
    if (loss != Loss::kNone && marker.role == Role::kReference)
      return ReferenceFailure{
          ReferenceProblem::kNoGrating,
          "there is no grating of the stated pitch at the position of reference '" + marker.name + "'",
          reference.search};
    if (marker.role != Role::kTarget || loss != Loss::kNone) continue;
    any_target = true;
    if (shows_an_axis(reference.plans[i]))
      any_axis = true;
    else
      askew = marker.name;
  }
  if (!any_target)
    return ReferenceFailure{ReferenceProblem::kNoGrating,
                            "there is no grating of the stated pitch at the positions of the targets",
                            reference.search};
  if (!any_axis)
    return ReferenceFailure{
        ReferenceProblem::kNoGrating,
        "the lines of target '" + askew + "' are oblique to the board's axes and show neither dx nor dy",
        reference.search};
  if (const auto disagreement = site_disagreement(reference))
    return ReferenceFailure{ReferenceProblem::kSiteDisagrees, *disagreement, reference.search};
  return std::nullopt;
}

}  // namespace

CircleSearch search_circles(const LumaView& image, const ObserveOptions& options) {
  CircleSearch search = find_circles(image, options.circles);
  std::erase_if(search.circles, [&](const DetectedCircle& circle) { return !options.area.holds(circle.centre); });
  std::erase_if(search.rejected, [&](const RejectedOutline& outline) { return !options.area.holds(outline.centre); });
  return search;
}

std::vector<CirclePoint> circle_points(const Site& site, const Camera& lens, const CircleSearch& search,
                                       const Identified& who) {
  std::vector<CirclePoint> points;
  std::vector<double> diameters;
  const IdealFromBoard rough(who.image_from_board.matrix());
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const int found = who.circle_of_marker[i];
    if (found < 0 || site.markers[i].role != Role::kReference) continue;
    const DetectedCircle& seen = search.circles[static_cast<std::size_t>(found)];
    points.push_back({i, site.markers[i].circle->centre, lens.undistort(seen.centre), seen.u_centre_px});
    diameters.push_back(diameter_mm(*site.markers[i].circle, seen, rough));
  }
  // The offset hardly depends on the homography. The first pass uses the approximate one, the second pass a better one.
  const std::vector<CirclePoint> raw = points;
  for (int pass = 0; pass < 2; ++pass) {
    const IdealFromBoard h = fit_circles(points).value_or(rough);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto offset = ellipse_centre(h, raw[k].board, diameters[k]) - h(raw[k].board);
      points[k].ideal = raw[k].ideal + (-1.0) * offset;
    }
  }
  return points;
}

tl::expected<IdealFromBoard, HomographyFailure> fit_circles(const std::vector<CirclePoint>& points) {
  std::vector<BoardPoint> board;
  std::vector<IdealPoint> ideal;
  for (const CirclePoint& p : points) {
    board.push_back(p.board);
    ideal.push_back(p.ideal);
  }
  return fit_homography<frame::Ideal, frame::Board>(board, ideal);
}

namespace {

// Identifies circles without their diameters. A wrong diameter in the site can then be named instead of "not found".
// Such a fit must not be used for measuring.
tl::expected<Identified, IdentityFailure> identify_without_diameters(Site site, const CircleSearch& search) {
  for (Marker& marker : site.markers) {
    if (marker.circle) marker.circle->diameter_mm = 0.0;
  }
  return identify_first(site, search);
}

}  // namespace

tl::expected<Reference, ReferenceFailure> make_reference(const GreyPicture& picture, const Site& site,
                                                         const Camera& lens, const ObserveOptions& options) {
  Reference reference;
  reference.site = site;
  reference.lens = lens;
  reference.width = width_of(picture.luma);
  reference.height = height_of(picture.luma);
  reference.options = options;
  reference.search = search_circles(picture.luma, options);
  if (auto line = references_on_a_line(site))
    return tl::unexpected(ReferenceFailure{ReferenceProblem::kSiteDisagrees, *std::move(line), reference.search});
  const auto sized = identify_first(site, reference.search);
  const auto who = sized ? sized : identify_without_diameters(site, reference.search);
  const auto not_found = [&] {
    return tl::unexpected(ReferenceFailure{ReferenceProblem::kNotFound, sized.error().reason, reference.search});
  };
  if (!who) return not_found();
  reference.circles = circle_points(site, lens, reference.search, *who);
  const auto h = fit_circles(reference.circles);
  if (!h)
    return tl::unexpected(ReferenceFailure{
        ReferenceProblem::kNotFound, "the reference circles are on one line, so they do not determine a homography",
        reference.search});
  reference.view = {*h, lens};
  reference.seen.references_seen = true;
  reference.seen.stage1 = reference.seen.stage2 = *h;
  reference.seen.markers.resize(site.markers.size());
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const int found = who->circle_of_marker[i];
    if (found >= 0) reference.seen.markers[i].circle = reference.search.circles[static_cast<std::size_t>(found)];
  }
  centre_windows(reference, picture.luma);
  plan_rasters(reference);
  read_patches(reference, picture);
  if (auto problem = problem_of(reference)) return tl::unexpected(std::move(*problem));
  if (!sized) return not_found();
  return reference;
}

tl::expected<Reference, ReferenceFailure> make_reference_in_view(const GreyPicture& picture, const Site& site,
                                                                 const View& view, CircleSearch search,
                                                                 const ObserveOptions& options) {
  Reference reference;
  reference.site = site;
  reference.lens = view.lens;
  reference.width = width_of(picture.luma);
  reference.height = height_of(picture.luma);
  reference.options = options;
  reference.view = view;
  reference.search = std::move(search);
  reference.seen.references_seen = true;
  reference.seen.stage1 = reference.seen.stage2 = view.ideal_from_board;
  reference.seen.markers.resize(site.markers.size());
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    if (!site.markers[i].circle) continue;
    const ImagePoint there = view(site.markers[i].circle->centre);
    for (const DetectedCircle& c : reference.search.circles) {
      if (length(c.centre - there) > kSamePlace * c.diameter_px) continue;
      reference.seen.markers[i].circle = c;
      if (site.markers[i].role == Role::kReference)
        reference.circles.push_back({i, site.markers[i].circle->centre, view.lens.undistort(c.centre), c.u_centre_px});
      break;
    }
  }
  plan_rasters(reference);
  read_patches(reference, picture);
  if (auto problem = problem_of(reference)) return tl::unexpected(std::move(*problem));
  return reference;
}

}  // namespace moiregauge::internal
