// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/site_from_picture.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <optional>

#include "moiregauge/geometry/conic.h"
#include "moiregauge/markers/outermost.h"
#include "moiregauge/observation/board_from_gratings.h"
#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

constexpr double kReach = 3.0;  // diameters from a circle to the edge of its grating

struct Parts {
  std::vector<SeenCircle> circles;
  std::vector<std::optional<SeenPatch>> of_circle;  // the grating of each
  std::vector<SeenPatch> targets;
  [[nodiscard]] std::vector<SeenPatch> reference_patches() const {
    std::vector<SeenPatch> out;
    for (const auto& p : of_circle) {
      if (p) out.push_back(*p);
    }
    return out;
  }
};

Parts sorted_out(std::vector<SeenCircle> circles, const std::vector<SeenPatch>& patches) {
  Parts parts{std::move(circles), {}, {}};
  parts.of_circle.resize(parts.circles.size());
  for (const SeenPatch& patch : patches) {
    std::size_t nearest = 0;
    const auto away = [&](const SeenPatch& p, std::size_t i) { return distance_px(p, parts.circles[i].centre); };
    for (std::size_t i = 1; i < parts.circles.size(); ++i) {
      if (away(patch, i) < away(patch, nearest)) nearest = i;
    }
    if (away(patch, nearest) > kReach * parts.circles[nearest].diameter_px) {
      parts.targets.push_back(patch);
      continue;
    }
    // A second grating at the same circle stands as still as the first; the nearer one is enough.
    auto& own = parts.of_circle[nearest];
    if (!own || away(patch, nearest) < away(*own, nearest)) own = patch;
  }
  return parts;
}

// Turned so that x is what the user asked for and y goes up, with the origin at the references' centroid.
BoardFromIdeal placed(const BoardFromIdeal& rough, const Parts& parts, const Camera& lens, BoardAxes axes) {
  BoardPoint centroid;
  const auto share = 1.0 / static_cast<double>(parts.circles.size());
  for (const SeenCircle& c : parts.circles) {
    const BoardPoint p = rough(lens.undistort(c.centre));
    centroid = {centroid.x + share * p.x, centroid.y + share * p.y};
  }
  const IdealPoint middle = rough.inverse()(centroid);
  const Matrix2 j = rough.jacobian(middle);
  const double horizontal = std::atan2(j(1, 0), j(0, 0));
  double angle = horizontal;
  if (axes == BoardAxes::kPrint) {
    std::vector<SeenPatch> prints = parts.reference_patches();
    if (prints.empty()) prints = parts.targets;
    std::complex<double> mean;  // prints repeat under quarter turns
    for (const SeenPatch& p : prints) mean += std::polar(1.0, 4.0 * print_angle(p, rough, lens));
    angle = 0.25 * std::arg(mean);
    angle += 0.5 * kPi * std::round((horizontal - angle) / (0.5 * kPi));
  }
  return turned(rough, angle, centroid);
}

Circle circle_on(const BoardFromIdeal& board, const Camera& lens, const SeenCircle& seen) {
  const IdealPoint ideal = lens.undistort(seen.centre);
  const IdealFromBoard back = board.inverse();
  const BoardPoint about = board(ideal);
  const double diameter = seen.diameter_px * View{back, {}}.mm_per_px(about);
  const auto offset = ellipse_centre(back, about, diameter) - back(about);
  return {board(ideal + (-1.0) * offset), diameter};
}

Grating grating_on(const BoardFromIdeal& board, const Camera& lens, const SeenPatch& seen, double pitch_mm) {
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

// Reading order: rows from the top, each from the left; what is less than half its size lower is in the same row.
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
  for (const SeenPatch& patch : parts.targets) {
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

template <typename... Values>
std::string text_of(const char* format, Values... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

tl::expected<Site, ReferenceFailure> site_from_picture(const GreyPicture& picture, const Camera& lens,
                                                       const PictureSiteOptions& options) {
  CircleSearch search = find_circles(picture.luma, options.circles);
  GratingSearchOptions gratings;
  gratings.bits = picture.bits;
  const std::vector<SeenPatch> patches = find_grating_patches(picture.luma, gratings);
  std::vector<SeenCircle> circles = outermost_circles(search.circles, patches);
  const auto fail = [&](ReferenceProblem problem, std::string text) {
    return tl::unexpected(ReferenceFailure{problem, std::move(text), std::move(search)});
  };
  if (circles.size() < 4)
    return fail(ReferenceProblem::kNotFound,
                text_of("without a site file, four reference circles of one size are needed: found %zu, and %zu gratings (%s)",
                        circles.size(), patches.size(), best_rejected_outline(search).c_str()));
  if (patches.empty())
    return fail(ReferenceProblem::kNoGrating,
                text_of("without a site file, a grating of three pitches or more is needed: found %zu circles and no grating",
                        circles.size()));
  const Parts parts = sorted_out(std::move(circles), patches);
  if (parts.targets.empty())
    return fail(ReferenceProblem::kNoGrating,
                text_of("no target: each of the %zu gratings found lies within three diameters of one of the %zu reference "
                        "circles",
                        patches.size(), parts.circles.size()));
  // A target may stand before or behind the references, where the same pitch looks larger or smaller: they alone say the
  // scale, unless they are too few to say the perspective.
  std::vector<SeenPatch> scale = parts.reference_patches();
  if (scale.size() < 3) scale.insert(scale.end(), parts.targets.begin(), parts.targets.end());
  const BoardFromIdeal rough = board_from_gratings(scale, lens, options.pitch_mm);
  return site_of(parts, placed(rough, parts, lens, options.axes), lens, options.pitch_mm);
}

}  // namespace moiregauge
