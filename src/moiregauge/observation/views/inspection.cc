// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/views/inspection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Assumed pitch without --pitch, mm. The tolerances of identification, about a millimetre, suit this pitch. Lengths are
// divided by it afterwards, so their unit is the gratings' own pitch. Chosen.
constexpr double kPitchForOrder_mm = 10.0;

double area_of(const std::array<ImagePoint, 4>& p) {
  double twice = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const ImagePoint a = p[i], b = p[(i + 1) % p.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * std::abs(twice);
}

PixelNoise noise_of(const GreyPicture& picture, const std::array<ImagePoint, 4>& outline) {
  double x0 = outline[0].x, x1 = x0, y0 = outline[0].y, y1 = y0;
  for (const ImagePoint& p : outline) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
  const int left = static_cast<int>(x0), top = static_cast<int>(y0);
  return pixel_noise(
      part_of(picture.luma, left, top, left + static_cast<int>(x1 - x0), top + static_cast<int>(y1 - y0)),
      picture.bits);
}

std::vector<InspectedPatch> patches_of(const GreyPicture& picture, std::vector<DetectedPatch> found) {
  std::vector<InspectedPatch> out;
  for (DetectedPatch& patch : found) {
    const PixelNoise noise = noise_of(picture, patch.outline);
    const double pixels = area_of(patch.outline);
    patch.modulation = std::ldexp(patch.modulation, picture.bits - 8);  // grey levels as stored
    patch.noise = std::ldexp(patch.noise, picture.bits - 8);
    out.push_back({patch, noise, pixels});
  }
  return out;
}

std::vector<IndexedLattice> lattices_of(const GreyPicture& picture, const CircleSearch& search) {
  std::vector<IndexedLattice> out = find_dot_lattices(picture.luma, search.circles);
  for (IndexedLattice& checker : find_checker_lattices(picture.luma, picture.bits)) out.push_back(std::move(checker));
  return out;
}

// Marks crossed patterns with round elements as dots. More than half of their positions must contain a dot of a
// lattice.
void name_dots(Inspection& inspection) {
  for (InspectedPatch& patch : inspection.patches) {
    if (patch.seen.pattern != Pattern::kAuto) continue;
    double dots = 0.0;
    for (const IndexedLattice& lattice : inspection.lattices) {
      if (lattice.kind != LatticeKind::kDots) continue;
      dots += static_cast<double>(std::count_if(lattice.points.begin(), lattice.points.end(),
                                                [&](const LatticePoint& p) { return holds(patch.seen, p.at); }));
    }
    if (dots > 0.5 * patch.seen.periods_x * patch.seen.periods_y) patch.seen.pattern = Pattern::kDots;
  }
}

int lattice_of(const DetectedCircle& circle, const std::vector<IndexedLattice>& lattices) {
  for (std::size_t i = 0; i < lattices.size(); ++i) {
    if (lattices[i].kind != LatticeKind::kDots) continue;
    for (const LatticePoint& dot : lattices[i].points) {
      if (length(dot.at - circle.centre) < 0.25 * dot.size_px) return static_cast<int>(i);
    }
  }
  return kUnidentified;
}

RejectedOutline too_small(const DetectedCircle& circle, const CircleOptions& options) {
  char why[96];
  std::snprintf(why, sizeof why, "too small, diameter %.2f px of at least %.2f", circle.diameter_px,
                options.min_diameter_px);
  return {circle.centre, circle.diameter_px, circle.circularity, why};
}

// `gratings`: all of the image. A site file states its own.
tl::expected<Reference, ReferenceFailure> who_is_who(const GreyPicture& picture, const InspectOptions& options,
                                                     std::vector<DetectedPatch> gratings,
                                                     std::vector<std::string>& notes) {
  if (options.site) return make_reference(picture, *options.site, options.lens, options.observe);
  PictureSiteOptions looked_for;
  looked_for.pitch_mm = options.pitch_mm.value_or(kPitchForOrder_mm);
  looked_for.axes = options.axes;
  looked_for.observe = options.observe;
  looked_for.choice = options.choice;
  auto found = detect_site(picture, options.lens, looked_for, std::move(gratings));
  if (!found) return tl::unexpected(std::move(found.error()));
  notes = std::move(found->notes);
  return make_reference(picture, found->site, options.lens, options.observe);
}

bool same_circle(const DetectedCircle& a, const DetectedCircle& b) {
  return length(a.centre - b.centre) < 0.25 * std::min(a.diameter_px, b.diameter_px) &&
         std::abs(a.diameter_px - b.diameter_px) < 0.25 * a.diameter_px;
}

// Assigns a marker to the first free detection of its circle.
void name_circle(std::vector<InspectedCircle>& circles, const DetectedCircle& circle, int marker) {
  const auto found = std::ranges::find_if(
      circles, [&](const InspectedCircle& c) { return c.marker == kUnidentified && same_circle(c.seen, circle); });
  if (found != circles.end()) found->marker = marker;
}

// Assigns each marker to the detection nearest to its position in the reference.
void name_the_seen(Inspection& inspection) {
  const Reference& reference = *inspection.reference;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const int marker = static_cast<int>(i);
    if (const auto& circle = reference.seen.markers[i].circle) name_circle(inspection.circles, *circle, marker);
    if (!reference.site.markers[i].grating || reference.seen.markers[i].loss != Loss::kNone) continue;
    const ImagePoint centre = reference.view(reference.site.markers[i].grating->centre);
    InspectedPatch* nearest = nullptr;
    for (InspectedPatch& p : inspection.patches) {
      if (!holds(p.seen, centre)) continue;
      if (nearest == nullptr || length(p.seen.centre - centre) < length(nearest->seen.centre - centre)) nearest = &p;
    }
    if (nearest != nullptr) nearest->marker = marker;
  }
}

}  // namespace

const char* word_for(BoardUnit unit) { return unit == BoardUnit::kMillimetre ? "mm" : "pitches"; }

Inspection inspect_picture(const GreyPicture& picture, const InspectOptions& options) {
  Inspection out;
  out.width = width_of(picture.luma);
  out.height = height_of(picture.luma);
  // Dots of a lattice confirm each other, so they count from a smaller diameter than a separate circle.
  CircleOptions circles = options.observe.circles;
  circles.min_diameter_px = std::min(circles.min_diameter_px, DotSearchOptions{}.min_diameter_px);
  CircleSearch search = find_circles(picture.luma, circles);
  out.lattices = lattices_of(picture, search);
  out.rejected = std::move(search.rejected);
  std::erase_if(out.rejected, [&](const RejectedOutline& seen) { return !options.observe.area.holds(seen.centre); });
  for (const DetectedCircle& circle : search.circles) {
    if (!options.observe.area.holds(circle.centre)) continue;
    const int lattice = lattice_of(circle, out.lattices);
    if (lattice < 0 && circle.diameter_px < options.observe.circles.min_diameter_px)
      out.rejected.push_back(too_small(circle, options.observe.circles));
    else
      out.circles.push_back({.seen = circle, .lattice = lattice});
  }
  std::stable_sort(out.rejected.begin(), out.rejected.end(),
                   [](const RejectedOutline& a, const RejectedOutline& b) { return a.circularity > b.circularity; });
  std::vector<DetectedPatch> gratings = gratings_of(picture);
  out.patches = patches_of(picture, gratings);
  std::erase_if(out.patches,
                [&](const InspectedPatch& patch) { return !options.observe.area.holds(patch.seen.centre); });
  name_dots(out);
  if (!options.site && !options.pitch_mm) {
    out.unit = BoardUnit::kPitch;
    out.pitch_of_unit = kPitchForOrder_mm;
  }
  auto reference = who_is_who(picture, options, std::move(gratings), out.notes);
  if (!reference) {
    out.missing = std::move(reference.error().message);
    out.is_choice_unknown = reference.error().problem == ReferenceProblem::kNoSuchMarker;
    return out;
  }
  out.reference = std::move(*reference);
  name_the_seen(out);
  return out;
}

PatchAxes axes_of(const DetectedPatch& patch) {
  const auto along = [](ImageExtent k) { return (1.0 / (k.x * k.x + k.y * k.y)) * k; };
  if (patch.pattern == Pattern::kLinesX) return {along(patch.k_x), {}};
  if (patch.pattern == Pattern::kLinesY) return {{}, along(patch.k_y)};
  // Vectors of one pitch along one axis and zero along the other.
  const ImageExtent a = patch.k_x, b = patch.k_y;
  const double det = a.x * b.y - a.y * b.x;
  return {{b.y / det, -b.x / det}, {-a.y / det, a.x / det}};
}

PatchBound displacement_bound(const InspectedPatch& patch) {
  const PatchAxes axes = axes_of(patch.seen);
  const double u_phase = std::sqrt(2.0) * phase_bound(patch.noise.sigma, patch.seen.modulation, patch.pixels);
  // The fundamentals of a checkerboard are on its diagonals, so each informs both axes.
  const double shared = patch.seen.pattern == Pattern::kCheckerboard ? std::sqrt(0.5) : 1.0;
  const auto along = [&](ImageExtent pitch) {
    const double px = length(pitch);
    return px > 0.0 ? shared * u_phase / kTwoPi * px : std::numeric_limits<double>::quiet_NaN();
  };
  return {along(axes.x), along(axes.y)};
}

}  // namespace moiregauge::internal
