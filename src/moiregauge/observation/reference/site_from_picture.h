// SPDX-License-Identifier: Apache-2.0
// The site of a picture of which only the gratings' pitch is known: circles and gratings found, sorted into references
// and targets, and placed in millimetres.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

enum class BoardAxes { kPrint, kImage };  // x along the references' gratings, or along the picture's rows

struct PictureSiteOptions {
  double pitch_mm = 0.0;
  BoardAxes axes = BoardAxes::kPrint;
  CircleOptions circles;
  // False for a method that takes the camera to stand still: then gratings are enough, and of fewer than four circles
  // those that have one are references none the less.
  bool needs_references = true;
};

struct PictureSite {
  Site site;
  IdealFromBoard view;  // by the gratings' pitch; a homography of the circles is better
  CircleSearch search;
  std::vector<std::string> notes;  // what a user should know about who was taken for what
};

// The outermost circles (four or more) are references R1, R2, ...; of the gratings whose edge is within three diameters
// of the nearest of them, the nearest is its; every other one is a target T1, T2, ...; both in reading order. A grating
// that repeats by another length than the references' is left out. The origin is the references' centroid.
[[nodiscard]] tl::expected<PictureSite, ReferenceFailure> detect_site(const GreyPicture& picture, const Camera& lens,
                                                                      const PictureSiteOptions& options);
[[nodiscard]] tl::expected<Site, ReferenceFailure> site_from_picture(const GreyPicture& picture, const Camera& lens,
                                                                     const PictureSiteOptions& options);

}  // namespace moiregauge::internal
