// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/sampling_moire.h"

#include <cmath>
#include <complex>

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

internal::Image<double> grey_of(const ImageView& image) {
  return image.bits == 8 ? copied<std::uint8_t>(image) : copied<std::uint16_t>(image);
}

internal::Axis internal_axis(Axis axis) { return axis == Axis::kX ? internal::Axis::kX : internal::Axis::kY; }

}  // namespace

FringePhase sampling_moire(const ImageView& image, Axis axis, double pitch_px, int region_px, double noise_grey) {
  if (image.width <= 0 || image.height <= 0 || region_px <= 0 || !(pitch_px >= internal::kMinSamplingPitchPx))
    return {};
  const auto picture = grey_of(image);
  const internal::Sampling sampling{std::round(pitch_px), pitch_px, region_px};
  const internal::RegionPhase region = internal::measure_region(picture.view(), internal_axis(axis), sampling);
  FringePhase out;
  out.is_valid = region.valid;
  if (!region.valid) return out;
  out.phase_rad = region.phase_rad;
  out.modulation = region.modulation;
  out.u_rad =
      internal::region_mean_uncertainty(noise_grey, region.modulation, sampling.sampling_pitch_px, pitch_px, region_px);
  return out;
}

PhaseMap phase_map(const ImageView& image, Axis axis, double pitch_px) {
  PhaseMap out;
  if (image.width <= 0 || image.height <= 0 || !(pitch_px >= internal::kMinSamplingPitchPx)) return out;
  const double sampling_pitch_px = std::round(pitch_px);
  const auto field = internal::sampling_moire(grey_of(image).view(), internal_axis(axis), sampling_pitch_px);
  const double response = internal::window_response(sampling_pitch_px, 1.0 / pitch_px);
  out.width = field.fringe.width();
  out.height = field.fringe.height();
  out.margin = field.margin;
  for (int y = 0; y < out.height; ++y) {
    for (const std::complex<double>& fringe : field.fringe.row(y)) {
      out.phase_rad.push_back(std::arg(fringe));
      out.modulation.push_back(2.0 * std::abs(fringe) / response);
    }
  }
  return out;
}

double displacement_px(const FringePhase& reference, const FringePhase& current, double pitch_px) {
  return -internal::wrapped(current.phase_rad - reference.phase_rad) / internal::kTwoPi * pitch_px;
}

}  // namespace moiregauge
