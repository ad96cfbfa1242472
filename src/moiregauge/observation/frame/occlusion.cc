// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/occlusion.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace moiregauge::internal {
namespace {

// Change of sigma^2 from which on the blocks are examined. A grating that turns from facing the camera to 8 deg changes
// it by a fifth in all blocks. Chosen.
constexpr double kMissesChanged = 1.15;
// Smallest excess residual of a block, relative to the template's contrast. If all of it pulled one way, the grating
// would move by 0.0005 px. Chosen.
constexpr double kMinMiss = 0.01;
// Largest sigma^2 of the free part relative to the reference frame's. Blur and light cause a part of it. Chosen.
constexpr double kStillCovered = 2.0;

double square(double v) { return v * v; }

double least_of(const PrintModel& model, const PatchFit& fit, double rounding) {
  return square(kMinMiss * fit.gain[0] * model.print.contrast()) + square(rounding);
}

}  // namespace

CoveredBlocks find_occluded_blocks(const GreyPicture& picture, const PrintModel& model, const PatchFit& at_rest,
                                   const PatchFit& fit, Rows rows) {
  const double ratio = square(fit.sigma) / square(at_rest.sigma);
  if (ratio < kMissesChanged && ratio > 1.0 / kMissesChanged) return {};
  const int row_step = rows == Rows::kAll ? 1 : model.options.row_step;
  return covered_blocks(model.misses, template_residuals(picture.luma, fit, model.window, model.print, row_step),
                        least_of(model, fit, picture.rounding));
}

std::optional<PatchFit> free_points(const GreyPicture& picture, const PrintModel& model, const PatchFit& at_rest,
                                    const PatchFit& fit, const BlockSet& covered) {
  const auto window = free_window(model.window, covered);
  const auto map = fit_homography<frame::Print, frame::Image>(std::span<const ImagePoint>(fit.image),
                                                              std::span<const PrintPoint>(fit.print));
  if (!window || !map) return std::nullopt;
  auto part = fit_patch(picture.luma, *map, {*window, model.print, model.options});
  if (!part) return std::nullopt;
  // The occlusion also displaced the first fit, so the free blocks are compared with the reference frame again.
  const double least = square(at_rest.sigma) + least_of(model, fit, picture.rounding);
  if (square(part->fit.sigma) > kStillCovered * least) return std::nullopt;
  return std::move(part->fit);
}

}  // namespace moiregauge::internal
