// SPDX-License-Identifier: Apache-2.0
// Reference frame: the positions of all markers when displacement is zero by definition.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/image/tone.h"
#include "moiregauge/observation/reference/observation.h"
#include "moiregauge/site/marker_choice.h"

namespace moiregauge::internal {

struct ObserveOptions {
  RasterOptions raster;
  CircleOptions circles;
  TemplateUse template_use = TemplateUse::kAuto;  // for `precise`
  SearchArea area;                                // in the reference frame
};

struct GreyPicture {
  LumaView luma;
  int bits = 8;
  // Error that a lossy codec may leave in a pixel, grey levels, rms. 0 for other footage.
  double rounding = 0.0;
};

// Image of one frame, and the view of the board in it.
struct BoardPicture {
  const GreyPicture& picture;
  const View& view;
};

// Centre of a circle as a point of the homography, corrected for the lens and for the perspective offset of the
// ellipse's centre.
struct CirclePoint {
  std::size_t marker = 0;  // index in the site
  BoardPoint board;        // mm, the site's circle centre
  IdealPoint ideal;        // px
  double u_px = 0.0;       // standard uncertainty (k = 1) of each coordinate
};

struct Reference {
  Site site;
  Camera lens;
  int width = 0;  // px, of the image
  int height = 0;
  ObserveOptions options;
  std::vector<CirclePoint> circles;  // the reference markers' circles, in the site's order
  View view;                         // view of the board through the circles of the reference frame
  // One per site marker; pitch_mm = 0 if it has no grating.
  std::vector<RasterPlan> plans;
  Observation seen;  // reference frame itself, with patches read in `view`
  // For `precise`, one per site marker. Empty if it was not learned.
  std::vector<std::optional<PrintModel>> prints;
  std::vector<Loss> plan_loss;  // one per site marker: kTooCoarse etc.
  CircleSearch search;          // all circle candidates, for the overlay
  Tone tone;                    // curve that mapped the grey levels to light before
  // Ratio of light to grey level over each marker's grating. Empty without a mapping.
  std::vector<double> light_per_grey;

  // Returns the diameter of a reference's circle in another view, px.
  [[nodiscard]] double diameter_px(const CirclePoint& point, const View& in) const {
    return seen.markers[point.marker].circle->diameter_px * view.mm_per_px(point.board) / in.mm_per_px(point.board);
  }
  // Returns a codec's quantisation step in the unit in which the marker was measured: grey levels, or light.
  [[nodiscard]] double step_of(std::size_t marker, const Quantiser& quantiser) const {
    return step_or_usual(quantiser.step) * (marker < light_per_grey.size() ? light_per_grey[marker] : 1.0);
  }
  // Returns true if a camera was given. Three references then determine a pose, where a homography needs four.
  [[nodiscard]] bool knows_camera() const { return !lens.is_distortion_free() || lens.fx != 1.0; }
};

// kNoSuchMarker: the user chose a marker that was not found.
enum class ReferenceProblem { kNotFound, kTooCoarse, kNoGrating, kSiteDisagrees, kNoSuchMarker };

struct ReferenceFailure {
  ReferenceProblem problem = ReferenceProblem::kNotFound;
  std::string message;
  CircleSearch search;
};

// Finds circles and gratings of a site in the image of the reference frame, and reads them.
// Fails: the message names the reason and the marker.
[[nodiscard]] tl::expected<Reference, ReferenceFailure> make_reference(const GreyPicture& picture, const Site& site,
                                                                       const Camera& lens,
                                                                       const ObserveOptions& options);

// Reads a site in a known view, for a method that assumes a fixed camera and therefore needs no circles.
// Fails: as make_reference.
[[nodiscard]] tl::expected<Reference, ReferenceFailure> make_reference_in_view(const GreyPicture& picture,
                                                                               const Site& site, const View& view,
                                                                               CircleSearch search,
                                                                               const ObserveOptions& options);

// Finds the circles in the search area.
[[nodiscard]] CircleSearch search_circles(const LumaView& image, const ObserveOptions& options);

// Returns the points of the identified reference circles. `who` contains an approximate view of the board.
[[nodiscard]] std::vector<CirclePoint> circle_points(const Site& site, const Camera& lens, const CircleSearch& search,
                                                     const Identified& who);

// Fits the homography of the circles: exact for four, least squares for more.
// Fails: HomographyFailure names the reason.
[[nodiscard]] tl::expected<IdealFromBoard, HomographyFailure> fit_circles(const std::vector<CirclePoint>& points);

}  // namespace moiregauge::internal
