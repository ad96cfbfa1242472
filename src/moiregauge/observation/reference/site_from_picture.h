// SPDX-License-Identifier: Apache-2.0
// Determines the site from an image and the gratings' pitch. Detects circles and gratings, sorts them into references
// and targets, and computes their positions in mm.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

enum class BoardAxes { kPrint, kImage };  // x along the references' gratings, or along the image's rows

struct PictureSiteOptions {
  double pitch_mm = 0.0;
  BoardAxes axes = BoardAxes::kPrint;
  ObserveOptions observe{};  // circles and search area
  MarkerChoice choice{};     // among the markers found
  // False for a method that assumes a fixed camera, for which gratings suffice. Among fewer than four circles, those
  // with a grating are still references.
  bool needs_references = true;
};

struct PictureSite {
  Site site;
  IdealFromBoard view;  // by the gratings' pitch; less accurate than a homography of the circles
  CircleSearch search;
  std::vector<std::string> notes;  // identifications that the user should check
};

// Returns the site of an image. The outermost circles (four or more) are references R1, R2, ... in reading order. The
// nearest grating whose edge is within three diameters of a circle belongs to it. All others are targets T1, T2, ... in
// reading order. A grating with another pitch than the references' is excluded. The origin is the references' centroid.
// Fails: ReferenceFailure names the missing circles or gratings.
[[nodiscard]] tl::expected<PictureSite, ReferenceFailure> detect_site(const GreyPicture& picture, const Camera& lens,
                                                                      const PictureSiteOptions& options);
// `patches`: all gratings of the image, as gratings_of() finds them.
[[nodiscard]] tl::expected<PictureSite, ReferenceFailure> detect_site(const GreyPicture& picture, const Camera& lens,
                                                                      const PictureSiteOptions& options,
                                                                      std::vector<DetectedPatch> patches);
[[nodiscard]] std::vector<DetectedPatch> gratings_of(const GreyPicture& picture);
[[nodiscard]] tl::expected<Site, ReferenceFailure> site_from_picture(const GreyPicture& picture, const Camera& lens,
                                                                     const PictureSiteOptions& options);

}  // namespace moiregauge::internal
