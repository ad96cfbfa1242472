// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

// Side of the largest upright square that fits a w x h print when turned by `angle` against it.
double inscribed_side(double width, double height, double angle) {
  return std::min(width, height) / (std::abs(std::cos(angle)) + std::abs(std::sin(angle)));
}

template <typename Grey>
double bilinear(const ImageView<Grey>& picture, int x, int y, double fx, double fy) {
  const Grey* p = picture.data + y * picture.stride + x;
  const Grey* q = p + picture.stride;
  const double top = double(p[0]) + fx * (double(p[1]) - double(p[0]));
  const double bottom = double(q[0]) + fx * (double(q[1]) - double(q[0]));
  return top + fy * (bottom - top);
}

template <typename Grey>
bool resample_from(const ImageView<Grey>& picture, const View& view, const RasterPlan& plan, Extent<frame::Board> shift,
                   Image<double>& out) {
  const double c = std::cos(plan.angle_rad) * plan.step_mm;
  const double s = std::sin(plan.angle_rad) * plan.step_mm;
  const double middle = 0.5 * (plan.side_px - 1);
  const BoardPoint centre = plan.centre + shift;
  if (out.width() != plan.side_px || out.height() != plan.side_px) out = Image<double>(plan.side_px, plan.side_px);
  for (int j = 0; j < plan.side_px; ++j) {
    const auto row = out.row(j);
    const double v = j - middle;
    for (int i = 0; i < plan.side_px; ++i) {
      const double u = i - middle;
      const ImagePoint p = view(BoardPoint{centre.x + c * u - s * v, centre.y + s * u + c * v});
      const int x = static_cast<int>(std::floor(p.x));
      const int y = static_cast<int>(std::floor(p.y));
      if (!(p.x >= 0.0 && p.y >= 0.0 && x + 1 < picture.width && y + 1 < picture.height)) return false;
      row[static_cast<std::size_t>(i)] = bilinear(picture, x, y, p.x - x, p.y - y);
    }
  }
  return true;
}

}  // namespace

double fundamental_pitch_mm(const Grating& grating) {
  return grating.pattern == Pattern::kCheckerboard ? grating.pitch_mm / std::sqrt(2.0) : grating.pitch_mm;
}

tl::expected<RasterPlan, RasterFailure> plan_raster(const Grating& grating, double mm_per_px, const RasterOptions& options) {
  const bool diagonal = grating.pattern == Pattern::kCheckerboard;
  RasterPlan plan;
  plan.centre = grating.centre;
  plan.angle_rad = grating.angle_rad + (diagonal ? kPi / 4.0 : 0.0);
  plan.pitch_mm = fundamental_pitch_mm(grating);
  plan.reads_x = grating.pattern != Pattern::kLinesY;
  plan.reads_y = grating.pattern != Pattern::kLinesX;
  const double pitch_px = plan.pitch_mm / mm_per_px;
  if (!(pitch_px >= kMinPitchPx)) return tl::unexpected(RasterFailure::kTooCoarse);
  plan.sampling_pitch_px =
      options.sampling_pitch_px > 0 ? options.sampling_pitch_px : std::max(3, static_cast<int>(std::lround(pitch_px)));
  plan.step_mm = plan.pitch_mm * (options.sampling_pitch_px > 0 ? 1.0 / pitch_px : 1.0 / plan.sampling_pitch_px);
  const double print_px =
      inscribed_side(grating.width_mm, grating.height_mm, diagonal ? kPi / 4.0 : 0.0) / plan.step_mm;
  const int support = 2 * (plan.sampling_pitch_px - 1);
  const double room = print_px - support - 2.0 * options.edge_px;
  // A print that holds the bare window but not its clear edge is still read: its outermost taps weigh next to nothing.
  if (print_px < support + 1) return tl::unexpected(RasterFailure::kPrintTooSmall);
  plan.region_px = std::max(1, std::min(options.region_px, static_cast<int>(room)));
  if ((plan.region_px + support) % 2 == 0) --plan.region_px;  // an odd raster has a centre pixel
  plan.region_px = std::max(1, plan.region_px);
  plan.side_px = plan.region_px + support;
  return plan;
}

bool resample(const LumaView& luma, const View& view, const RasterPlan& plan, Extent<frame::Board> shift,
              Image<double>& out) {
  return std::visit([&](const auto& picture) { return resample_from(picture, view, plan, shift, out); }, luma);
}

}  // namespace moiregauge
