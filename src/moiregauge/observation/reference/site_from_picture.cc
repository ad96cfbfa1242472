// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/site_from_picture.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <optional>
#include <span>

#include "moiregauge/detection/identity/matching_sheets.h"
#include "moiregauge/detection/identity/select_references.h"
#include "moiregauge/geometry/conic.h"
#include "moiregauge/observation/reference/board_from_gratings.h"
#include "moiregauge/observation/reference/site_check.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kEnough = 4;  // circles that determine a view
// Limits for one grating of another pitch. A lens of -3 % changes pitches by at most 6 %, and not at one position only.
// Chosen.
constexpr double kForeign = 0.05;  // largest relative difference of a pitch
// Largest relative difference of the others' pitches.
constexpr double kAgreeing = 0.02;

struct Parts {
  std::vector<DetectedCircle> circles;
  std::vector<std::optional<DetectedPatch>> of_circle;  // the grating of each
  std::vector<DetectedPatch> targets;
  std::vector<std::string> notes;
  [[nodiscard]] std::vector<DetectedPatch> reference_patches() const {
    std::vector<DetectedPatch> out;
    for (const auto& p : of_circle) {
      if (p) out.push_back(*p);
    }
    return out;
  }
};

template <typename... Values>
std::string text_of(const char* format, Values... values) {
  char text[280];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string counted(std::size_t n, const char* what) {
  return (n == 0 ? std::string("no") : std::to_string(n)) + " " + what + (n == 1 ? "" : "s");
}

// Returns the circle nearest to the patch's edge if it is within reach, otherwise circles.size().
std::size_t circle_of(const DetectedPatch& patch, const std::vector<DetectedCircle>& circles) {
  std::size_t nearest = circles.size();
  double least = 0.0;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const double away = distance_px(patch, circles[i].centre);
    if (nearest < circles.size() && away >= least) continue;
    nearest = i;
    least = away;
  }
  return nearest < circles.size() && least <= kGratingReach * circles[nearest].diameter_px ? nearest : circles.size();
}

Parts sorted_out(std::vector<DetectedCircle> circles, const std::vector<DetectedPatch>& patches) {
  Parts parts{std::move(circles), {}, {}, {}};
  parts.of_circle.resize(parts.circles.size());
  for (const DetectedPatch& patch : patches) {
    const std::size_t i = circle_of(patch, parts.circles);
    if (i == parts.circles.size()) {
      parts.targets.push_back(patch);
      continue;
    }
    // One of two gratings at a circle may be a target nearby. As a target, a fixed grating does no harm. As a
    // reference's grating, a moving one would.
    auto& own = parts.of_circle[i];
    const auto away = [&](const DetectedPatch& p) { return distance_px(p, parts.circles[i].centre); };
    DetectedPatch spare = patch;
    if (!own) {
      own = patch;
      continue;
    }
    if (away(patch) < away(*own)) std::swap(*own, spare);
    parts.targets.push_back(spare);
    parts.notes.push_back(
        text_of("note: the grating at (%.0f, %.0f) px is used as a target, because its reference circle has a nearer "
                "grating",
                spare.centre.x, spare.centre.y));
  }
  return parts;
}

// Fewer than four circles determine no view. Only those with a grating are useful, because it shows whether the camera
// moved.
void drop_bare_circles(Parts& parts) {
  Parts kept{{}, {}, std::move(parts.targets), std::move(parts.notes)};
  for (std::size_t i = 0; i < parts.circles.size(); ++i) {
    if (!parts.of_circle[i]) continue;
    kept.circles.push_back(parts.circles[i]);
    kept.of_circle.push_back(parts.of_circle[i]);
  }
  parts = std::move(kept);
}

// Returns the largest relative deviation of the patches' pitches on the board from the stated one.
double lattice_disagreement(std::span<const DetectedPatch> patches, const BoardFromIdeal& board, const Camera& lens,
                            double pitch_mm) {
  double worst = 0.0;
  for (const DetectedPatch& p : patches)
    worst = std::max(worst, std::abs(std::log(pitch_on(p, board, lens) / pitch_mm)));
  return worst;
}

// Removes a circle's grating whose pitch differs from all others. It would bend the scale of all.
void drop_foreign_reference(Parts& parts, const Camera& lens, double pitch_mm) {
  const std::vector<DetectedPatch> all = parts.reference_patches();
  if (all.size() < 4) return;
  const double before = lattice_disagreement(all, board_from_gratings(all, lens, pitch_mm), lens, pitch_mm);
  if (before < kForeign) return;
  double least = before;
  std::size_t foreign = all.size();
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<DetectedPatch> others = all;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double now = lattice_disagreement(others, board_from_gratings(others, lens, pitch_mm), lens, pitch_mm);
    if (now >= least) continue;
    least = now;
    foreign = i;
  }
  if (foreign == all.size() || least > kAgreeing) return;
  for (auto& own : parts.of_circle) {
    if (!own || length(own->centre - all[foreign].centre) > 0.0) continue;
    parts.notes.push_back(text_of(
        "note: the grating at (%.0f, %.0f) px next to a reference circle is not used, because its pitch differs "
        "from the others'",
        own->centre.x, own->centre.y));
    own.reset();
  }
}

void drop_foreign_targets(Parts& parts, const BoardFromIdeal& board, const Camera& lens, double pitch_mm) {
  std::erase_if(parts.targets, [&](const DetectedPatch& p) {
    const double pitch = pitch_on(p, board, lens);
    if (std::abs(std::log(pitch / pitch_mm)) <= kTargetTolerance) return false;
    parts.notes.push_back(
        text_of("note: the grating at (%.0f, %.0f) px is not used, because its pitch is %.3g mm, not %.4g mm",
                p.centre.x, p.centre.y, pitch, pitch_mm));
    return true;
  });
}

// Returns the map after a rotation to the requested x with y up. Its origin is the references' centroid.
BoardFromIdeal placed(const BoardFromIdeal& rough, const Parts& parts, const Camera& lens, BoardAxes axes) {
  std::vector<ImagePoint> places;
  for (const DetectedCircle& c : parts.circles) places.push_back(c.centre);
  if (places.empty()) {
    for (const DetectedPatch& patch : parts.targets) places.push_back(patch.centre);
  }
  BoardPoint centroid;
  const auto share = 1.0 / static_cast<double>(places.size());
  for (const ImagePoint place : places) {
    const BoardPoint p = rough(lens.undistort(place));
    centroid = {centroid.x + share * p.x, centroid.y + share * p.y};
  }
  const IdealPoint middle = rough.inverse()(centroid);
  const Matrix2 j = rough.jacobian(middle);
  const double horizontal = std::atan2(j(1, 0), j(0, 0));
  double angle = horizontal;
  if (axes == BoardAxes::kPrint) {
    std::vector<DetectedPatch> prints = parts.reference_patches();
    if (prints.empty()) prints = parts.targets;
    std::complex<double> mean;  // gratings repeat under quarter turns
    for (const DetectedPatch& p : prints) mean += std::polar(1.0, 4.0 * print_angle(p, rough, lens));
    angle = 0.25 * std::arg(mean);
    angle += 0.5 * kPi * std::round((horizontal - angle) / (0.5 * kPi));
  }
  return turned(rough, angle, centroid);
}

Circle circle_on(const BoardFromIdeal& board, const Camera& lens, const DetectedCircle& seen) {
  const IdealPoint ideal = lens.undistort(seen.centre);
  const IdealFromBoard back = board.inverse();
  const BoardPoint about = board(ideal);
  const double diameter = seen.diameter_px * View{back, {}}.mm_per_px(about);
  const auto offset = ellipse_centre(back, about, diameter) - back(about);
  return {board(ideal + (-1.0) * offset), diameter};
}

Grating grating_on(const BoardFromIdeal& board, const Camera& lens, const DetectedPatch& seen, double pitch_mm) {
  Grating grating;
  grating.centre = board(lens.undistort(seen.centre));
  grating.pitch_mm = pitch_mm;
  grating.angle_rad = print_angle(seen, board, lens);
  grating.pattern = seen.pattern;
  grating.width_mm = seen.periods_x * pitch_mm;
  grating.height_mm = seen.periods_y * pitch_mm;
  return grating;
}

BoardPoint place_of(const Marker& m) { return m.circle ? m.circle->centre : m.grating->centre; }
double size_of(const Marker& m) { return m.circle ? m.circle->diameter_mm : m.grating->height_mm; }

// Names markers in reading order: rows from the top, each from the left. A marker less than half its size lower is in
// the same row.
void name_in_order(std::vector<Marker>& markers, char letter) {
  std::stable_sort(markers.begin(), markers.end(),
                   [](const Marker& a, const Marker& b) { return place_of(a).y > place_of(b).y; });
  for (auto row = markers.begin(); row != markers.end();) {
    const double lowest = place_of(*row).y - 0.5 * size_of(*row);
    const auto end = std::find_if(row, markers.end(), [&](const Marker& m) { return place_of(m).y < lowest; });
    std::stable_sort(row, end, [](const Marker& a, const Marker& b) { return place_of(a).x < place_of(b).x; });
    row = end;
  }
  for (std::size_t i = 0; i < markers.size(); ++i) markers[i].name = letter + std::to_string(i + 1);
}

Site site_of(const Parts& parts, const BoardFromIdeal& board, const Camera& lens, double pitch_mm) {
  std::vector<Marker> references, targets;
  for (std::size_t i = 0; i < parts.circles.size(); ++i) {
    Marker marker;
    marker.circle = circle_on(board, lens, parts.circles[i]);
    if (parts.of_circle[i]) marker.grating = grating_on(board, lens, *parts.of_circle[i], pitch_mm);
    references.push_back(marker);
  }
  for (const DetectedPatch& patch : parts.targets) {
    Marker marker;
    marker.role = Role::kTarget;
    marker.grating = grating_on(board, lens, patch, pitch_mm);
    targets.push_back(marker);
  }
  name_in_order(references, 'R');
  name_in_order(targets, 'T');
  Site site;
  site.markers = std::move(references);
  site.markers.insert(site.markers.end(), targets.begin(), targets.end());
  return site;
}

}  // namespace

std::vector<DetectedPatch> gratings_of(const GreyPicture& picture) {
  GratingSearchOptions options;
  options.bits = picture.bits;
  return find_grating_patches(picture.luma, options);
}

tl::expected<PictureSite, ReferenceFailure> detect_site(const GreyPicture& picture, const Camera& lens,
                                                        const PictureSiteOptions& options) {
  return detect_site(picture, lens, options, gratings_of(picture));
}

tl::expected<PictureSite, ReferenceFailure> detect_site(const GreyPicture& picture, const Camera& lens,
                                                        const PictureSiteOptions& options,
                                                        std::vector<DetectedPatch> patches) {
  CircleSearch search = search_circles(picture.luma, options.observe);
  std::erase_if(patches, [&](const DetectedPatch& patch) { return !options.observe.area.holds(patch.centre); });
  auto [circles, doubtful] = outermost_circles(search.circles, patches);
  const std::size_t seen = circles.size();
  const auto fail = [&](ReferenceProblem problem, std::string text) {
    return tl::unexpected(ReferenceFailure{problem, std::move(text), std::move(search)});
  };
  if (options.needs_references && seen < kEnough)
    return fail(
        ReferenceProblem::kNotFound,
        text_of("four reference circles of one size were not found (%s and %s; %s)", counted(seen, "circle").c_str(),
                counted(patches.size(), "grating").c_str(), best_rejected_outline(search).c_str()));
  if (options.needs_references && doubtful)
    return fail(
        ReferenceProblem::kNotFound,
        text_of("three circles have gratings of one kind, and the fourth reference cannot be identified among the %zu "
                "outermost circles",
                seen));
  if (patches.empty())
    return fail(ReferenceProblem::kNoGrating,
                text_of("no grating of three pitches or more was found, only %s", counted(seen, "circle").c_str()));
  Parts parts = sorted_out(std::move(circles), patches);
  if (seen < kEnough) drop_bare_circles(parts);
  if (options.needs_references && parts.reference_patches().empty())
    return fail(ReferenceProblem::kNoGrating,
                text_of("no grating is within three diameters of a reference circle (%s and %s were found)",
                        counted(seen, "circle").c_str(), counted(patches.size(), "grating").c_str()));
  drop_foreign_reference(parts, lens, options.pitch_mm);
  // A target may be in front of or behind the references, where the same pitch looks larger or smaller. Only the
  // references determine the scale, unless they are too few to determine the perspective.
  std::vector<DetectedPatch> scale = parts.reference_patches();
  if (scale.size() < 3) scale.insert(scale.end(), parts.targets.begin(), parts.targets.end());
  const BoardFromIdeal rough = board_from_gratings(scale, lens, options.pitch_mm);
  drop_foreign_targets(parts, rough, lens, options.pitch_mm);
  if (parts.targets.empty())
    return fail(
        ReferenceProblem::kNoGrating,
        text_of("there is no target, because each of the %zu gratings is within three diameters of one of the %zu "
                "reference circles%s",
                patches.size(), seen,
                parts.notes.empty()
                    ? ""
                    : (", or " + parts.notes.back().substr(std::string_view("note: ").size())).c_str()));
  const BoardFromIdeal board = placed(rough, parts, lens, options.axes);
  auto site = choose_markers(site_of(parts, board, lens, options.pitch_mm), options.choice);
  if (!site) return fail(ReferenceProblem::kNoSuchMarker, std::move(site.error()));
  return PictureSite{*std::move(site), board.inverse(), std::move(search), std::move(parts.notes)};
}

tl::expected<Site, ReferenceFailure> site_from_picture(const GreyPicture& picture, const Camera& lens,
                                                       const PictureSiteOptions& options) {
  auto found = detect_site(picture, lens, options);
  if (!found) return tl::unexpected(std::move(found.error()));
  return std::move(found->site);
}

}  // namespace moiregauge::internal
