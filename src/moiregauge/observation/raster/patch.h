// SPDX-License-Identifier: Apache-2.0
// Raster reading of one grating in one frame: mean phase along both raster axes, and the phase gradient over the patch.
#pragma once

#include <array>

#include "moiregauge/geometry/view.h"
#include "moiregauge/image/image.h"
#include "moiregauge/observation/raster/raster.h"

namespace moiregauge::internal {

// Axes 0 and 1 are those of the raster. A value that the grating does not show is NaN.
struct PatchReading {
  bool valid = false;
  std::array<double, 2> phase_rad{};  // at the raster's centre, wrapped
  // Standard uncertainty (k = 1) from the pixel noise.
  std::array<double, 2> u_phase_rad{};
  std::array<double, 2> modulation{};  // grey levels
  // Apparent displacement gradient over the patch, d(displacement along axis a) / d(raster axis b), 1. It shows local
  // scale and rotation of the grating relative to the view.
  std::array<std::array<double, 2>, 2> gradient{};
  // Standard uncertainty (k = 1) of the gradient from the pixel noise.
  double u_gradient = 0.0;
  // Deviation of the lattice lines from straight lines, rms.
  double straightness_mm = 0.0;
  // Share of it that the pixel noise alone causes.
  double u_straightness_mm = 0.0;
  double noise_sigma = 0.0;  // grey levels
  double clipped_share = 0.0;
};

// Reads the grating of `plan`, in a window displaced on the board by `shift` (mm).
// Fails (valid = false): the window leaves the image, or a phase has no u below 0.1 rad.
[[nodiscard]] PatchReading read_patch(const LumaView& luma, int bits, const View& view, const RasterPlan& plan,
                                      Extent<frame::Board> shift);

// Share of the reference frame's modulation. Below it the grating is lost, not only dark or blurred. Chosen.
inline constexpr double kLostModulation = 0.15;
// Returns true if the modulation along an axis is below this share.
[[nodiscard]] bool is_lost(const PatchReading& then, const PatchReading& now);

// Limits of a change of the lattice since the reference frame, beyond five times its noise. A lattice that is bent,
// stretched or rotated by more is partly occluded. For comparison, a lens of -2 % at 8 deg stretches a patch by 1e-3.
// Chosen.
inline constexpr double kBentLattice = 0.001;       // relative to the pitch, rms
inline constexpr double kStretchedLattice = 0.003;  // relative
// Returns true if the lattice exceeds one of these limits. `lag_mm`: distance by which a lossy codec may leave parts of
// it behind.
[[nodiscard]] bool is_bent(const RasterPlan& plan, const PatchReading& then, const PatchReading& now,
                           double lag_mm = 0.0);

// Smallest cosine of the angle between a board axis and the normal of the lines, at 1.5 deg. Lines show movement across
// themselves only. At 1.5 deg, 0.026 of the movement along them appears as movement along that axis. Beyond this limit
// neither axis is known. A grating is mounted to 0.3 deg. Chosen.
inline constexpr double kUpright = 0.99966;
// Returns false for lines oblique to both board axes, which measure neither dx nor dy.
[[nodiscard]] bool shows_an_axis(const RasterPlan& plan);

// Returns the displacement on the board between two readings (mm, seed paper Eq. (4)). Along each raster axis it is
// within half a pitch. An axis that the grating does not show is NaN.
[[nodiscard]] Extent<frame::Board> displacement_between(const RasterPlan& plan, const PatchReading& from,
                                                        const PatchReading& to);

// Returns the same if `to` was read in a window displaced by `shift`. Among the displacements that differ by whole
// pitches, it is the one nearest to `shift`.
[[nodiscard]] Extent<frame::Board> displacement_at(const RasterPlan& plan, const PatchReading& from,
                                                   const PatchReading& to, Extent<frame::Board> shift);

// Convert a vector from the raster's axes to the board's, and back.
[[nodiscard]] Extent<frame::Board> board_from_raster(const RasterPlan& plan, double along_0, double along_1);
[[nodiscard]] std::array<double, 2> raster_from_board(const RasterPlan& plan, Extent<frame::Board> d);

}  // namespace moiregauge::internal
