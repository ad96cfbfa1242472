// SPDX-License-Identifier: Apache-2.0
// Sampling moiré as the seed paper describes it, image by image. It is slow on purpose: tests compare the fast form
// with it.
#include <algorithm>
#include <utility>

#include "moiregauge/phase/sampling_moire/sampling_moire.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

// Returns Eq. (2): the k-th down-sampled line (every T-th pixel from k on), linearly interpolated at s.
template <typename PixelAt>
double down_sampled(const PixelAt& pixel_at, int s, int k, int pitch) {
  const int left = s - (((s - k) % pitch) + pitch) % pitch;
  const double part = static_cast<double>(s - left) / pitch;
  return part == 0.0 ? pixel_at(left) : (1.0 - part) * pixel_at(left) + part * pixel_at(left + pitch);
}

// Returns the zero-frequency term of the T points: the mean of the down-sampled images, down the columns.
Image<double> mean_down(ImageView<double> in, int pitch) {
  Image<double> out(in.width, in.height - 2 * (pitch - 1));
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      const auto pixel_at = [&](int row) { return in.at(x, row); };
      double sum = 0.0;
      for (int k = 0; k < pitch; ++k) sum += down_sampled(pixel_at, y + pitch - 1, k, pitch);
      out.at(x, y) = sum / pitch;
    }
  }
  return out;
}

// Returns Eq. (3) along the rows, times the carrier 2 pi x / T between the moiré's phase and the grating's. The
// argument of z_m is the phase of the moiré:
//     z_m = (1/T) sum_k f_m(k) (cos 2 pi k/T - i sin 2 pi k/T)
Image<std::complex<double>> dft_right(ImageView<double> in, int pitch) {
  Image<std::complex<double>> out(in.width - 2 * (pitch - 1), in.height);
  for (int y = 0; y < out.height(); ++y) {
    const auto pixel_at = [&](int column) { return in.at(column, y); };
    for (int x = 0; x < out.width(); ++x) {
      const int column = x + pitch - 1;
      std::complex<double> moire;
      for (int k = 0; k < pitch; ++k) {
        moire += down_sampled(pixel_at, column, k, pitch) * std::polar(1.0, -kTwoPi * k / pitch);
      }
      out.at(x, y) = moire / static_cast<double>(pitch) * std::polar(1.0, kTwoPi * (column % pitch) / pitch);
    }
  }
  return out;
}

template <typename Pixel>
Image<Pixel> transposed(ImageView<Pixel> in) {
  Image<Pixel> out(in.height, in.width);
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) out.at(y, x) = in.at(x, y);
  }
  return out;
}

}  // namespace

FringeField sampling_moire_textbook(ImageView<double> picture, Axis axis, int sampling_pitch_px) {
  const int margin = window_margin(sampling_pitch_px);
  if (sampling_pitch_px < kMinSamplingPitchPx || std::min(picture.width, picture.height) < 2 * margin + 1) return {};
  const Image<double> upright = axis == Axis::kX ? Image<double>() : transposed(picture);
  const Image<double> averaged = mean_down(axis == Axis::kX ? picture : upright.view(), sampling_pitch_px);
  Image<std::complex<double>> fringe = dft_right(averaged.view(), sampling_pitch_px);
  return {axis == Axis::kX ? std::move(fringe) : transposed(fringe.view()), margin,
          static_cast<double>(sampling_pitch_px)};
}

}  // namespace moiregauge::internal
