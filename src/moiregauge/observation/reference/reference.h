// SPDX-License-Identifier: Apache-2.0
// The reference frame: where everything was when displacement was zero by definition.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/image/tone.h"
#include "moiregauge/observation/reference/observation.h"

namespace moiregauge::internal {

struct ObserveOptions {
  RasterOptions raster;
  CircleOptions circles;
  TemplateUse template_use = TemplateUse::kAuto;  // of `precise`
};

struct GreyPicture {
  LumaView luma;
  int bits = 8;
  double rounding =
      0.0;  // grey levels, rms: by how much a lossy codec may have any pixel wrong; 0: it is as the sensor had it
};

// A circle's centre as a point of the homography: the lens and the perspective offset of the ellipse's centre taken
// out.
struct CirclePoint {
  std::size_t marker = 0;  // index in the site
  BoardPoint board;        // mm, the site's circle centre
  IdealPoint ideal;        // px
  double u_px = 0.0;       // standard uncertainty of each coordinate
};

struct Reference {
  Site site;
  Camera lens;
  int width = 0;  // px, of the picture
  int height = 0;
  ObserveOptions options;
  std::vector<CirclePoint> circles;               // of the reference markers, in the site's order
  View view;                                      // the board as the circles of the reference frame show it
  std::vector<RasterPlan> plans;                  // one per site marker; pitch_mm = 0 where there is no grating
  Observation seen;                               // the reference frame itself, patches in `view`
  std::vector<std::optional<PrintModel>> prints;  // of `precise`, one per site marker; empty: not learned
  std::vector<Loss> plan_loss;                    // kTooCoarse etc., one per marker
  CircleSearch search;                            // everything that looked like a circle, for the overlay
  Tone tone;                                      // by which grey levels were mapped to light before all this
  std::vector<double> light_per_grey;             // one per site marker, over its print; empty: no mapping

  // Of a reference's circle in another view, px.
  [[nodiscard]] double diameter_px(const CirclePoint& point, const View& in) const {
    return seen.markers[point.marker].circle->diameter_px * view.mm_per_px(point.board) / in.mm_per_px(point.board);
  }
  // The step of a codec's quantiser in the units that the marker's print was measured in: grey levels, or light.
  [[nodiscard]] double step_of(std::size_t marker, const Quantiser& quantiser) const {
    return step_or_usual(quantiser.step) * (marker < light_per_grey.size() ? light_per_grey[marker] : 1.0);
  }
  // Was a camera given? Then three references tell a pose where a homography needs four.
  [[nodiscard]] bool knows_camera() const { return !lens.is_distortion_free() || lens.fx != 1.0; }
};

enum class ReferenceProblem { kNotFound, kTooCoarse, kNoGrating, kSiteDisagrees };

struct ReferenceFailure {
  ReferenceProblem problem = ReferenceProblem::kNotFound;
  std::string message;
  CircleSearch search;
};

// Finds circles and gratings by the site's layout in the picture that is to be the reference frame.
[[nodiscard]] tl::expected<Reference, ReferenceFailure> make_reference(const GreyPicture& picture, const Site& site,
                                                                       const Camera& lens,
                                                                       const ObserveOptions& options);

// The same in a view that is known: for a method that takes the camera to stand still, and so needs no circles.
[[nodiscard]] tl::expected<Reference, ReferenceFailure> make_reference_in_view(const GreyPicture& picture,
                                                                               const Site& site, const View& view,
                                                                               CircleSearch search,
                                                                               const ObserveOptions& options);

// The points of the reference circles among `seen`, given roughly how the frame sees the board.
[[nodiscard]] std::vector<CirclePoint> circle_points(const Site& site, const Camera& lens, const CircleSearch& search,
                                                     const Identified& who);

// The homography of the circles (exact for four, least squares for more).
[[nodiscard]] tl::expected<IdealFromBoard, HomographyFailure> fit_circles(const std::vector<CirclePoint>& points);

}  // namespace moiregauge::internal
