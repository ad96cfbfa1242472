// SPDX-License-Identifier: Apache-2.0
// One grating read in one frame: the region mean of its phase along both raster axes, and what the phase field says
// about the geometry inside the patch.
#pragma once

#include <array>

#include "moiregauge/observation/raster/raster.h"

namespace moiregauge::internal {

// Axis 0 and 1 are the raster's. What the print cannot show is NaN.
struct PatchReading {
  bool valid = false;
  std::array<double, 2> phase_rad{};    // at the raster's centre, wrapped
  std::array<double, 2> u_phase_rad{};  // from the pixel noise
  std::array<double, 2> modulation{};   // grey levels
  // Apparent displacement gradient inside the patch, d(displacement along axis a)/d(raster axis b): local scale and
  // rotation of the print against the view. Dimensionless.
  std::array<std::array<double, 2>, 2> gradient{};
  double u_gradient = 0.0;         // from the pixel noise
  double straightness_mm = 0.0;    // rms departure of the lattice lines from straight
  double u_straightness_mm = 0.0;  // what the pixel noise alone makes of it
  double noise_sigma = 0.0;        // grey levels
  double clipped_share = 0.0;
};

// Buffers that are kept from frame to frame.
struct PatchWorkspace {
  RasterWorkspace raster;
};

[[nodiscard]] PatchReading read_patch(const LumaView& luma, int bits, const View& view, const RasterPlan& plan,
                                      Extent<frame::Board> shift, PatchWorkspace& work);

// The share of the reference frame's modulation below which the print is gone, not merely dim or blurred.
inline constexpr double kLostModulation = 0.15;
[[nodiscard]] bool is_gone(const PatchReading& then, const PatchReading& now);

// A lattice that is bent, stretched or turned against its state in the reference frame, beyond five times its noise, is
// not all there: something covers a part of it. A lens of -2 % at 8 deg stretches a patch by 1e-3.
inline constexpr double kBentLattice = 0.001;       // of the pitch, rms
inline constexpr double kStretchedLattice = 0.003;  // relative
// lag_mm: by how much a lossy codec may leave parts of it behind.
[[nodiscard]] bool is_bent(const RasterPlan& plan, const PatchReading& then, const PatchReading& now,
                           double lag_mm = 0.0);

// False for lines that lie askew to both board axes: what they show is neither dx nor dy.
[[nodiscard]] bool shows_an_axis(const RasterPlan& plan);

// Displacement on the board (mm, seed paper Eq. (4)) that turns phase `from` into phase `to`; each raster axis is
// brought to within half a pitch. An axis the print cannot show is NaN.
[[nodiscard]] Extent<frame::Board> displacement_between(const RasterPlan& plan, const PatchReading& from,
                                                        const PatchReading& to);

// The same when `to` was read in a window shifted by `shift`: of the displacements that differ by whole pitches, the
// one nearest to `shift`.
[[nodiscard]] Extent<frame::Board> displacement_at(const RasterPlan& plan, const PatchReading& from,
                                                   const PatchReading& to, Extent<frame::Board> shift);

// A vector along the raster's axes as one on the board, and back.
[[nodiscard]] Extent<frame::Board> board_from_raster(const RasterPlan& plan, double along_0, double along_1);
[[nodiscard]] std::array<double, 2> raster_from_board(const RasterPlan& plan, Extent<frame::Board> d);

}  // namespace moiregauge::internal
