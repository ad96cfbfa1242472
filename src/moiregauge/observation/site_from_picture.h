// SPDX-License-Identifier: Apache-2.0
// The site of a picture of which only the gratings' pitch is known: circles and gratings found, sorted into references and
// targets, and placed in millimetres.
#pragma once

#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/markers/grating_patches.h"
#include "moiregauge/observation/reference.h"

namespace moiregauge {

enum class BoardAxes { kPrint, kImage };  // x along the references' gratings, or along the picture's rows

struct PictureSiteOptions {
  double pitch_mm = 0.0;
  BoardAxes axes = BoardAxes::kPrint;
  CircleOptions circles;
};

// The outermost circles (four or more) are references R1, R2, ...; a grating whose edge is within three diameters of the
// nearest of them is its, every other one a target T1, T2, ...; both in reading order. The origin is the references' centroid.
[[nodiscard]] tl::expected<Site, ReferenceFailure> site_from_picture(const GreyPicture& picture, const Camera& lens,
                                                                     const PictureSiteOptions& options);

}  // namespace moiregauge
