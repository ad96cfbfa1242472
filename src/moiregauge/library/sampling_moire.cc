// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sampling_moire.h"

#include <cmath>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge {
namespace {

template <typename Grey>
internal::Image<double> copied(const ImageView& image) {
  internal::Image<double> out(image.width, image.height);
  const auto* pixels = static_cast<const Grey*>(image.data);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) out.at(x, y) = static_cast<double>(pixels[y * image.stride + x]);
  return out;
}

}  // namespace

FringePhase sampling_moire(const ImageView& image, Axis axis, double pitch_px, int region_px, double noise_grey) {
  if (image.width <= 0 || image.height <= 0 || region_px <= 0 || !(pitch_px >= internal::kMinSamplingPitchPx))
    return {};
  const auto picture = image.bits == 8 ? copied<std::uint8_t>(image) : copied<std::uint16_t>(image);
  const internal::Sampling sampling{std::round(pitch_px), pitch_px, region_px};
  const auto along = axis == Axis::kX ? internal::Axis::kX : internal::Axis::kY;
  const internal::RegionPhase region = internal::measure_region(picture.view(), along, sampling);
  FringePhase out;
  out.is_valid = region.valid;
  if (!region.valid) return out;
  out.phase_rad = region.phase_rad;
  out.modulation = region.modulation;
  out.u_rad =
      internal::region_mean_uncertainty(noise_grey, region.modulation, sampling.sampling_pitch_px, pitch_px, region_px);
  return out;
}

double displacement_px(const FringePhase& reference, const FringePhase& current, double pitch_px) {
  return -internal::wrapped(current.phase_rad - reference.phase_rad) / internal::kTwoPi * pitch_px;
}

}  // namespace moiregauge
