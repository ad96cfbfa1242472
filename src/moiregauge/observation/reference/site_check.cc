// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/site_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "moiregauge/observation/reference/grating_lens.h"
#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/observation/reference/scale_check.h"

namespace moiregauge::internal {
namespace {

// Uncertainty of the view's scale, which follows from that of the circles' positions. Two circles, each known to u and
// at a distance s, determine the scale along their line to sqrt(2) u / s. At a corner of the layout their errors also
// cause false perspective, and the short spacing counts for both directions. In the mean over the references,
// perspective cancels. Over both directions half of either uncertainty remains.
struct ScaleUncertainty {
  double alone = 0.0;  // relative, at one reference
  double mean = 0.0;   // for the mean over all
};
// Factor for false perspective at one reference. Chosen.
constexpr double kPerspective = 1.3;

ScaleUncertainty scale_uncertainty(const Reference& reference) {
  const double u = reference.site.known_to.position_mm, n = static_cast<double>(reference.circles.size());
  double x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;
  for (const CirclePoint& c : reference.circles) x += c.board.x / n, y += c.board.y / n;
  for (const CirclePoint& c : reference.circles) {
    xx += 4.0 / n * (c.board.x - x) * (c.board.x - x);
    yy += 4.0 / n * (c.board.y - y) * (c.board.y - y);
  }
  if (!(xx > 0.0 && yy > 0.0)) return {};
  return {kPerspective * std::sqrt(2.0) * u / std::sqrt(std::min(xx, yy)),
          0.5 * std::hypot(u / std::sqrt(xx), u / std::sqrt(yy))};
}

// Coverage factor k from which on the site is wrong, and not only uncertain. Chosen.
constexpr double kSure = 3.0;

// Hint at the tone curve: least ratio of two circles' differences, largest difference, and number of circles. Chosen.
// Levels of sRGB that were read as light made circles 1.3 px too small.
constexpr double kAlike = 0.5, kLargestByTone_px = 3.0;
constexpr std::size_t kCirclesForTone = 3;

// Sizes of gratings and circles in the image against the site, by the scale of the circle spacing. A lens that
// the gratings show is removed. Otherwise a distortion of 4 % would look like wrong pitches.
class SeenSizes {
 public:
  explicit SeenSizes(const Reference& seen)
      : reference(seen), uncertainty(scale_uncertainty(seen)), lens_(lens_from_gratings(seen, uncertainty.alone)) {}

  // Returns the relative stretch of a pitch along an axis of its grating. It is the phase gradient beyond the nominal
  // carrier. A displacement gradient g along its own axis means that the grating is stretched by g against the board.
  [[nodiscard]] double stretch(std::size_t marker, std::size_t axis) const {
    const double seen = reference.seen.markers[marker].patch.gradient[axis][axis];
    if (!lens_) return seen;
    const Grating& grating = *reference.site.markers[marker].grating;
    const auto k = static_cast<Eigen::Index>(axis);
    return seen - gradient_by_lens(reference, lens_->view, grating.centre, reference.plans[marker].angle_rad)(k, k);
  }
  // Returns the mean over both axes. NaN if the grating does not determine it.
  [[nodiscard]] double stretch(std::size_t marker) const {
    const PatchReading& patch = reference.seen.markers[marker].patch;
    double sum = 0.0;
    int axes = 0;
    for (std::size_t a = 0; a < 2; ++a) {
      if (std::isnan(patch.phase_rad[a]) || std::isnan(patch.gradient[a][a])) continue;
      sum += stretch(marker, a);
      ++axes;
    }
    return axes > 0 && std::isfinite(patch.u_gradient) ? sum / axes : std::nan("");
  }
  [[nodiscard]] double mm_per_px(BoardPoint at) const {
    const double seen = reference.view.mm_per_px(at);
    if (!lens_) return seen;
    const Matrix2 shrunk = Matrix2::Identity() - gradient_by_lens(reference, lens_->view, at, 0.0);
    return seen * std::sqrt(std::abs(shrunk.determinant()));
  }

  const Reference& reference;
  ScaleUncertainty uncertainty;

 private:
  std::optional<GratingLens> lens_;
};

std::string pitch_text(const Marker& marker, double stretch) {
  char text[240];
  std::snprintf(text, sizeof text,
                "pitch_mm = %.4g of marker '%s' contradicts the spacing of the reference circles, which gives %.4g mm",
                marker.grating->pitch_mm, marker.name.c_str(), marker.grating->pitch_mm * (1.0 + stretch));
  return text;
}

// Stretch along the board's x and y: mean over the references' gratings.
struct MeanStretch {
  double x = 0.0, y = 0.0;
  [[nodiscard]] double both() const { return 0.5 * (x + y); }
  // Returns true if one axis differs from the other. A printer stretches its sheets along both. Circles with a 5 %
  // error along x do not stretch y.
  [[nodiscard]] bool is_along_one() const { return std::abs(x - y) > std::max(kSiteTolerance, 0.5 * std::abs(both())); }
};

// Returns the mean stretch. It is empty if a grating is rotated (a checkerboard is read along its diagonals) or does not
// show both axes.
std::optional<MeanStretch> mean_stretch(const SeenSizes& sizes) {
  const Reference& reference = sizes.reference;
  constexpr double kTurned = 0.1;  // rad
  MeanStretch sum;
  double count = 0.0;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const PatchReading& patch = reference.seen.markers[i].patch;
    if (marker.role != Role::kReference || !marker.grating || !patch.valid) continue;
    if (std::abs(reference.plans[i].angle_rad) > kTurned) return std::nullopt;
    if (std::isnan(patch.phase_rad[0]) || std::isnan(patch.phase_rad[1])) return std::nullopt;
    sum.x += sizes.stretch(i, 0), sum.y += sizes.stretch(i, 1), count += 1.0;
  }
  if (!(count > 0.0)) return std::nullopt;
  return MeanStretch{sum.x / count, sum.y / count};
}

// Returns the text on two references far apart in this direction, with their distance by the gratings.
std::string spacing_text(const Reference& reference, Extent<frame::Board> along, double stretch) {
  const auto part = [&](Extent<frame::Board> d) { return std::abs(d.x * along.x + d.y * along.y); };
  const CirclePoint *from = &reference.circles.front(), *to = from;
  for (const CirclePoint& a : reference.circles) {
    for (const CirclePoint& b : reference.circles) {
      if (part(b.board - a.board) > 1.001 * part(to->board - from->board)) from = &a, to = &b;
    }
  }
  const double stated = part(to->board - from->board);
  const auto& markers = reference.site.markers;
  char text[240];
  std::snprintf(text, sizeof text, "'%s' and '%s' are %s apart, not %s", markers[from->marker].name.c_str(),
                markers[to->marker].name.c_str(), short_length(stated / (1.0 + stretch), "mm").c_str(),
                short_length(stated, "mm").c_str());
  return text;
}

// No image shows which of the two is wrong, so the text names both.
std::string both_suspects(const SeenSizes& sizes, const Marker& first, double stretch) {
  const auto mean = mean_stretch(sizes);
  const char* axis = "";
  Extent<frame::Board> along{1.0, 0.0};
  if (mean && mean->is_along_one()) {
    const bool is_x = std::abs(mean->x) > std::abs(mean->y);
    axis = is_x ? " along x" : " along y";
    stretch = is_x ? mean->x : mean->y;
    if (!is_x) along = {0.0, 1.0};
  }
  char text[160];
  std::snprintf(text, sizeof text, ". Either the gratings are %.1f %% too %s%s, or ", 100.0 * std::abs(stretch),
                stretch > 0.0 ? "large" : "small", axis);
  return pitch_text(first, stretch) + text + spacing_text(sizes.reference, along, stretch) + axis;
}

// Tests for a stretch that all references share, from a wrong common pitch or wrong circle positions.
std::optional<std::string> common_pitch_disagreement(const SeenSizes& sizes) {
  const Reference& reference = sizes.reference;
  double sum = 0.0, noise = 0.0, count = 0.0;
  const Marker* first = nullptr;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const PatchReading& patch = reference.seen.markers[i].patch;
    if (marker.role != Role::kReference || !marker.grating || !patch.valid || std::isnan(sizes.stretch(i))) continue;
    if (first == nullptr) first = &marker;
    sum += sizes.stretch(i), noise += patch.u_gradient, count += 1.0;
  }
  if (count < 4.0) return std::nullopt;
  const double allowed = std::max(kSiteTolerance, kSure * sizes.uncertainty.mean) + 3.0 * noise / count;
  if (std::abs(sum / count) <= allowed) return std::nullopt;
  return both_suspects(sizes, *first, sum / count);
}

std::optional<std::string> pitch_disagreement(const SeenSizes& sizes, std::size_t i) {
  const Marker& marker = sizes.reference.site.markers[i];
  const PatchReading& patch = sizes.reference.seen.markers[i].patch;
  const double stretch = sizes.stretch(i);
  const double allowed =
      std::max(marker.role == Role::kTarget ? kTargetTolerance : kSiteTolerance, kSure * sizes.uncertainty.alone);
  // The scale of a small region is noisy, so three times its noise is allowed, too.
  if (std::isnan(stretch) || std::abs(stretch) <= allowed + 3.0 * patch.u_gradient) return std::nullopt;
  return pitch_text(marker, stretch);
}

// The amount by which a circle in the image is larger than stated, and the scale of the view there.
struct Excess {
  double px, mm_per_px;
};

// Fails (nothing): the marker has no circle, or it is not seen.
std::optional<Excess> excess_of(const SeenSizes& sizes, std::size_t i) {
  const Marker& marker = sizes.reference.site.markers[i];
  const auto& seen = sizes.reference.seen.markers[i].circle;
  if (!seen || !marker.circle || marker.circle->diameter_mm <= 0.0) return std::nullopt;
  // The lens at a circle is less certain than at the gratings, which are nearer to the middle. It may only excuse.
  const auto excess = [&](double mm_per_px) {
    return Excess{seen->diameter_px - marker.circle->diameter_mm / mm_per_px, mm_per_px};
  };
  const Excess through_lens = excess(sizes.mm_per_px(marker.circle->centre));
  const Excess without = excess(sizes.reference.view.mm_per_px(marker.circle->centre));
  return std::abs(through_lens.px) < std::abs(without.px) ? through_lens : without;
}

// Returns a hint if all circles differ from their diameters by about `found_px`, as one of them does. Grey levels that
// are not light shift every edge by a part of its width.
std::string tone_hint(const SeenSizes& sizes, double found_px) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < sizes.reference.site.markers.size(); ++i) {
    const auto excess = excess_of(sizes, i);
    if (!excess) continue;
    if (!(excess->px / found_px > kAlike && found_px / excess->px > kAlike)) return "";
    ++count;
  }
  if (count < kCirclesForTone || std::abs(found_px) > kLargestByTone_px) return "";
  return fmt::format(
      ". All circles look too {} by about the same number of pixels. If the grey levels are not proportional to light, "
      "state their tone curve, for example --tone srgb",
      found_px < 0.0 ? "small" : "large");
}

std::optional<std::string> diameter_disagreement(const SeenSizes& sizes, std::size_t i) {
  const Marker& marker = sizes.reference.site.markers[i];
  const auto excess = excess_of(sizes, i);
  if (!excess || std::abs(excess->px) <= kDiameterTolerance) return std::nullopt;
  const double excess_mm = excess->px * excess->mm_per_px;
  if (std::abs(excess_mm) <= std::max(kSiteTolerance, kSure * sizes.uncertainty.alone) * marker.circle->diameter_mm)
    return std::nullopt;
  return fmt::format(
             "circle_diameter_mm = {:.4g} of marker '{}' contradicts the spacing of the reference circles, which gives "
             "{:.4g} mm",
             marker.circle->diameter_mm, marker.name, marker.circle->diameter_mm + excess_mm) +
         tone_hint(sizes, excess->px);
}

}  // namespace

std::optional<std::string> site_disagreement(const Reference& reference) {
  const SeenSizes sizes(reference);
  if (auto text = common_pitch_disagreement(sizes)) return text;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    if (marker.grating && reference.seen.markers[i].patch.valid) {
      if (auto text = pitch_disagreement(sizes, i)) return text;
    }
    if (auto text = diameter_disagreement(sizes, i)) return text;
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
