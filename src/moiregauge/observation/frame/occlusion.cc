// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/occlusion.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace moiregauge::internal {
namespace {

// A print that goes from facing the camera to 8 deg misses its template by a fifth more (rms squared) all over; less than
// that is not worth a look at every block.
constexpr double kMissesChanged = 1.15;
// Of the template's contrast: what a block must miss in excess for the print to move by half a thousandth of a pixel or
// more, should all of it pull one way.
constexpr double kMinMiss = 0.01;
// The free part may miss by so much more, squared, than the print did at rest: blur and light take their share.
constexpr double kStillCovered = 2.0;

double square(double v) { return v * v; }

double least_of(const PrintModel& model, const PatchFit& fit, double rounding) {
  return square(kMinMiss * fit.gain[0] * model.print.contrast()) + square(rounding);
}

}  // namespace

CoveredBlocks find_occluded_blocks(const GreyPicture& picture, const PrintModel& model, const PatchFit& at_rest,
                                   const PatchFit& fit) {
  const double ratio = square(fit.sigma) / square(at_rest.sigma);
  if (ratio < kMissesChanged && ratio > 1.0 / kMissesChanged) return {};
  return covered_blocks(model.misses, template_residuals(picture.luma, fit, model.window, model.print),
                        least_of(model, fit, picture.rounding));
}

std::optional<PatchFit> free_points(const GreyPicture& picture, const PrintModel& model, const PatchFit& at_rest,
                                    const PatchFit& fit, const BlockSet& covered) {
  const auto window = free_window(model.window, covered);
  const auto map = fit_homography<frame::Print, frame::Image>(std::span<const ImagePoint>(fit.image),
                                                              std::span<const PrintPoint>(fit.print));
  if (!window || !map) return std::nullopt;
  auto part = fit_patch(picture.luma, *map, *window, model.print, model.options);
  if (!part) return std::nullopt;
  // What covered the print also bent the first fit: the blocks that are left must be as they were.
  const double least = square(at_rest.sigma) + least_of(model, fit, picture.rounding);
  if (square(part->fit.sigma) > kStillCovered * least) return std::nullopt;
  return std::move(part->fit);
}

}  // namespace moiregauge::internal
