// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "moiregauge/observation/raster/lines_region.h"
#include "moiregauge/observation/raster/noise.h"
#include "moiregauge/phase/raw_pixels/fringe_nodes.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Largest u of a phase. A worse one belongs to noise: that of pure noise is about 1 rad. Chosen.
constexpr double kMaxPhaseUncertainty = 0.1;  // rad

// Points per side at which a window's outline is examined, and at which a lens is evaluated. Chosen.
constexpr int kOutlinePoints = 9;
constexpr int kLensPoints = 3;
// Half the side of a window at which the lens is evaluated, relative to its own. These are the nodes of Gauss and
// Legendre: what the correction leaves has no mean over the window.
constexpr double kLensNode = 0.7745966692414834;
// Nodes per period of the region. Chosen.
constexpr double kNodesPerPeriod = 1.5;

using BoardFromFringe = Homography<frame::Board, frame::Fringe>;

BoardFromFringe board_from_fringe(const RasterPlan& plan, Extent<frame::Board> shift) {
  const double c = std::cos(plan.angle_rad) * plan.pitch_mm, s = std::sin(plan.angle_rad) * plan.pitch_mm;
  const BoardPoint centre = plan.centre + shift;
  Matrix3 h;
  h << c, -s, centre.x, s, c, centre.y, 0, 0, 1;
  return BoardFromFringe(h);
}

// Returns the lens near a point as an affine map.
Homography<frame::Image, frame::Ideal> lens_near(const Camera& lens, IdealPoint p) {
  const ImagePoint at = lens.distort(p);
  const auto dx = lens.distort({p.x + 0.5, p.y}) - lens.distort({p.x - 0.5, p.y});
  const auto dy = lens.distort({p.x, p.y + 0.5}) - lens.distort({p.x, p.y - 0.5});
  Matrix3 h;
  h << dx.x, dy.x, at.x - dx.x * p.x - dy.x * p.y, dx.y, dy.y, at.y - dx.y * p.x - dy.y * p.y, 0, 0, 1;
  return Homography<frame::Image, frame::Ideal>(h);
}

// Returns the coefficients of the parabola through (-t, a), (0, b) and (t, c).
std::array<double, 3> parabola(double a, double b, double c, double t) {
  return {b, (c - a) / (2.0 * t), (a - 2.0 * b + c) / (2.0 * t * t)};
}

// Corrects the map for the lens within the window.
void bend(const View& view, const BoardFromFringe& board, FringeMap& map) {
  std::array<std::array<double, kLensPoints * kLensPoints>, 2> off{};
  for (int j = 0; j < kLensPoints; ++j) {
    for (int i = 0; i < kLensPoints; ++i) {
      const FringePoint p{(i - 1) * kLensNode * map.half, (j - 1) * kLensNode * map.half};
      const auto miss = p - map.from_image(view(board(p)));
      const auto k = static_cast<std::size_t>(j * kLensPoints + i);
      off[0][k] = miss.x, off[1][k] = miss.y;
    }
  }
  for (std::size_t a = 0; a < 2; ++a) {
    std::array<std::array<double, 3>, 3> rows;
    for (std::size_t j = 0; j < 3; ++j)
      rows[j] = parabola(off[a][3 * j], off[a][3 * j + 1], off[a][3 * j + 2], kLensNode);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto column = parabola(rows[0][i], rows[1][i], rows[2][i], kLensNode);
      for (std::size_t j = 0; j < 3; ++j) map.bend[a][3 * j + i] = column[j];
    }
  }
  map.is_bent = true;
}

FringeMap fringe_map(const View& view, const RasterPlan& plan, Extent<frame::Board> shift, double half) {
  const BoardFromFringe board = board_from_fringe(plan, shift);
  const auto ideal = view.ideal_from_board * board;
  FringeMap map;
  map.half = half;
  if (view.lens.is_distortion_free()) {
    map.from_image = Homography<frame::Fringe, frame::Image>(ideal.matrix().inverse());
    return map;
  }
  map.from_image = (lens_near(view.lens, ideal({})) * ideal).inverse();
  bend(view, board, map);
  return map;
}

// Returns the pixels round the window. Fails (nothing): a part of it is outside the image.
std::optional<PixelBox> box_round(const View& view, const BoardFromFringe& board, double half, int width, int height) {
  double x0 = width, x1 = 0.0, y0 = height, y1 = 0.0;
  for (int i = 0; i < kOutlinePoints; ++i) {
    const double at = half * (2.0 * i / (kOutlinePoints - 1) - 1.0);
    for (const FringePoint q :
         {FringePoint{at, -half}, FringePoint{at, half}, FringePoint{-half, at}, FringePoint{half, at}}) {
      const ImagePoint p = view(board(q));
      if (!(p.x >= 1.0 && p.y >= 1.0 && p.x < width - 2 && p.y < height - 2)) return std::nullopt;
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x), y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
  }
  return PixelBox{static_cast<int>(x0) - 1, static_cast<int>(y0) - 1, static_cast<int>(x1) + 2,
                  static_cast<int>(y1) + 2};
}

// Returns the mean of every fourth pixel of every fourth row, grey levels. What a constant leaves in the fringe is
// proportional to the difference from it.
double level_of(const LumaView& luma, const PixelBox& box) {
  constexpr int kEvery = 4;
  long sum = 0, count = 0;
  std::visit(
      [&](const auto& picture) {
        for (int y = box.y0; y <= box.y1; y += kEvery) {
          const auto row = picture.row(y);
          for (int x = box.x0; x <= box.x1; x += kEvery, ++count) sum += row[static_cast<std::size_t>(x)];
        }
      },
      luma);
  return static_cast<double>(sum) / static_cast<double>(count);
}

FringeRegion region_of(const RasterPlan& plan) {
  FringeRegion region;
  region.side = static_cast<double>(plan.region_px) / plan.sampling_pitch_px;
  const bool of_lines = plan.reads_x != plan.reads_y;
  const int nodes = of_lines ? kMaxNodes : static_cast<int>(std::lround(kNodesPerPeriod * region.side));
  region.nodes = std::clamp(nodes, std::min(3, plan.region_px), kMaxNodes);
  return region;
}

PixelNoise noise_round(const LumaView& luma, int bits, const View& view, const RasterPlan& plan,
                       Extent<frame::Board> shift) {
  const double half = 0.5 * plan.side_px * plan.step_mm;
  const ImagePoint a = view(plan.centre + shift + Extent<frame::Board>{-half, half});
  const ImagePoint b = view(plan.centre + shift + Extent<frame::Board>{half, -half});
  const int x0 = static_cast<int>(std::min(a.x, b.x)), x1 = static_cast<int>(std::max(a.x, b.x));
  const int y0 = static_cast<int>(std::min(a.y, b.y)), y1 = static_cast<int>(std::max(a.y, b.y));
  return pixel_noise(part_of(luma, x0, y0, x1, y1), bits);
}

// Returns u of the slope of a plane fitted to the means of `cells` cells along a side of n points.
// Model: u sqrt(12 / (1 - 1 / cells^2)) / n, for a mean over all cells with uncertainty u.
double slope_uncertainty(double u_mean, double side, int cells) {
  return side > 1.0 && cells > 1 ? u_mean * std::sqrt(12.0 / (1.0 - 1.0 / (cells * cells))) / side : kNaN;
}

}  // namespace

PatchReading read_patch(const LumaView& luma, int bits, const View& view, const RasterPlan& plan,
                        Extent<frame::Board> shift) {
  PatchReading reading;
  reading.phase_rad = reading.u_phase_rad = reading.modulation = {kNaN, kNaN};
  reading.gradient = {{{kNaN, kNaN}, {kNaN, kNaN}}};
  reading.u_gradient = kNaN;
  const FringeRegion cells = region_of(plan);
  const BoardFromFringe board = board_from_fringe(plan, shift);
  const auto box = box_round(view, board, 0.5 * plan.side_px / plan.sampling_pitch_px, width_of(luma), height_of(luma));
  if (!box) return reading;
  const FringeMap map = fringe_map(view, plan, shift, cells.window());
  const auto fields = fringe_nodes(luma, map, cells, *box, level_of(luma, *box));
  const PixelNoise noise = noise_round(luma, bits, view, plan, shift);
  reading.noise_sigma = noise.sigma;
  reading.clipped_share = noise.clipped_share;
  // A raster pixel contains the information of the image's pixels under it.
  const double step_px = plan.step_mm / view.mm_per_px(plan.centre + shift);
  const double pitch_px = plan.sampling_pitch_px, cell_px = static_cast<double>(plan.region_px) / cells.nodes;
  const double mm_per_rad = plan.pitch_mm / kTwoPi;
  reading.valid = true;
  double straightness = 0.0;
  for (std::size_t a = 0; a < 2; ++a) {
    if (!(a == 0 ? plan.reads_x : plan.reads_y)) continue;
    const Axis axis = a == 0 ? Axis::kX : Axis::kY;
    const bool of_lines = plan.reads_x != plan.reads_y;
    const LinesRegion lines = of_lines ? region_mean_of_lines(fields[a], axis)
                                       : LinesRegion{region_mean(fields[a], axis, kNoCarrier, cells.nodes), 1.0};
    const RegionPhase& region = lines.phase;
    const double u = region.valid ? region_mean_uncertainty(noise.sigma, region.modulation, plan.sampling_pitch_px,
                                                            pitch_px, plan.region_px) /
                                        step_px / std::sqrt(lines.share)
                                  : kNaN;
    if (!(u < kMaxPhaseUncertainty)) {
      reading.valid = false;
      continue;
    }
    reading.phase_rad[a] = region.phase_rad;
    reading.modulation[a] = region.modulation;
    reading.u_phase_rad[a] = u;
    const double per_px = -mm_per_rad / (cell_px * plan.step_mm);  // RegionPhase counts in nodes
    reading.gradient[a] = {per_px * region.gradient_x_rad_per_px, per_px * region.gradient_y_rad_per_px};
    reading.u_gradient = slope_uncertainty(reading.u_phase_rad[a] * mm_per_rad,
                                           lines.share * plan.region_px * plan.step_mm, cells.nodes);
    reading.u_straightness_mm = mm_per_rad / step_px *
                                region_mean_uncertainty(noise.sigma, region.modulation, plan.sampling_pitch_px,
                                                        pitch_px, std::max(1, static_cast<int>(cell_px)));
    straightness = std::max(straightness, region.straightness_rad * mm_per_rad);
  }
  reading.straightness_mm = straightness;
  return reading;
}

bool is_lost(const PatchReading& then, const PatchReading& now) {
  for (std::size_t a = 0; a < 2; ++a) {
    if (now.modulation[a] < kLostModulation * then.modulation[a]) return true;
  }
  return false;
}

bool is_bent(const RasterPlan& plan, const PatchReading& then, const PatchReading& now, double lag_mm) {
  if (now.straightness_mm > kBentLattice * plan.pitch_mm + then.straightness_mm + 5.0 * now.u_straightness_mm + lag_mm)
    return true;
  const double allowed = kStretchedLattice + 5.0 * std::hypot(then.u_gradient, now.u_gradient) + lag_mm / plan.pitch_mm;
  for (std::size_t a = 0; a < 2; ++a) {
    for (std::size_t b = 0; b < 2; ++b) {
      if (std::abs(now.gradient[a][b] - then.gradient[a][b]) > allowed)
        return true;  // NaN (not measured) counts as not bent
    }
  }
  return false;
}

Extent<frame::Board> board_from_raster(const RasterPlan& plan, double along_0, double along_1) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  return {c * along_0 - s * along_1, s * along_0 + c * along_1};
}

std::array<double, 2> raster_from_board(const RasterPlan& plan, Extent<frame::Board> d) {
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  return {c * d.x + s * d.y, -s * d.x + c * d.y};
}

bool shows_an_axis(const RasterPlan& plan) {
  if (plan.reads_x && plan.reads_y) return true;
  return std::max(std::abs(std::cos(plan.angle_rad)), std::abs(std::sin(plan.angle_rad))) > kUpright;
}

Extent<frame::Board> displacement_between(const RasterPlan& plan, const PatchReading& from, const PatchReading& to) {
  const double mm_per_rad = plan.pitch_mm / kTwoPi;
  const double d0 = plan.reads_x ? -mm_per_rad * wrapped(to.phase_rad[0] - from.phase_rad[0]) : kNaN;
  const double d1 = plan.reads_y ? -mm_per_rad * wrapped(to.phase_rad[1] - from.phase_rad[1]) : kNaN;
  // A grating of lines along a board axis must not spoil the axis that it shows.
  if (std::isnan(d0) || std::isnan(d1)) {
    const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
    const double known = std::isnan(d0) ? d1 : d0;
    const Extent<frame::Board> along = std::isnan(d0) ? Extent<frame::Board>{-s, c} : Extent<frame::Board>{c, s};
    return {std::abs(along.x) > kUpright ? known * along.x : kNaN,
            std::abs(along.y) > kUpright ? known * along.y : kNaN};
  }
  return board_from_raster(plan, d0, d1);
}

Extent<frame::Board> displacement_at(const RasterPlan& plan, const PatchReading& from, const PatchReading& to,
                                     Extent<frame::Board> shift) {
  // The raster moves with the window, so it reads the grating's displacement minus the window's own.
  return shift + displacement_between(plan, from, to);
}

}  // namespace moiregauge::internal
