// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/sampling_moire/sampling_moire.h"

#include <algorithm>
#include <span>
#include <vector>

#include "moiregauge/phase/sampling_moire/sampling_window.h"

namespace moiregauge::internal {
namespace {

void add(std::span<double> sum, std::span<const double> term) {
  double* s = sum.data();
  const double* t = term.data();
  for (std::size_t i = 0; i < sum.size(); ++i) s[i] += t[i];
}

Image<double> rows_as_columns(ImageView<double> in) {
  Image<double> out(in.height, in.width);
  for (int y = 0; y < in.height; ++y) {
    const std::span<const double> row = in.row(y);
    for (int x = 0; x < in.width; ++x) out.at(y, x) = row[static_cast<std::size_t>(x)];
  }
  return out;
}

// Returns sums of n rows: out(y) = in(y) + ... + in(y + n - 1), with three additions per pixel for any n.
//
// Rows are processed in blocks of n. A sum that starts in one block is the tail of that block plus the head of the
// next. Each of the two grows by one addition per row. Nothing is ever subtracted, so round-off stays that of n
// additions for any size of image.
Image<double> box_down(ImageView<double> in, int n) {
  Image<double> out(in.width, in.height - n + 1);
  std::vector<double> running(static_cast<std::size_t>(in.width));
  for (int block = 0; block < out.height(); block += n) {
    const int rows = std::min(n, out.height() - block);
    std::fill(running.begin(), running.end(), 0.0);
    for (int i = n - 1; i >= 0; --i) {
      add(running, in.row(block + i));
      if (i < rows) std::copy(running.begin(), running.end(), out.row(block + i).begin());
    }
    std::fill(running.begin(), running.end(), 0.0);
    for (int i = 1; i < rows; ++i) {
      add(running, in.row(block + n + i - 1));
      add(out.row(block + i), running);
    }
  }
  return out;
}

// Returns the triangle applied down the columns, with 2 margin rows fewer than `in`. With n = margin + 1 = ceil(T) it
// is a box of n applied twice, less (n - T) boxes of 2 n - 1:
//     T - |u| = (n - |u|) - (n - T),  |u| < n
Image<double> triangle_down(ImageView<double> in, const SamplingWindow& window) {
  const int n = window.margin + 1;
  Image<double> out = box_down(box_down(in, n).view(), n);
  const double overhang = n - window.pitch_px;
  const Image<double> wide = overhang > 0.0 ? box_down(in, 2 * n - 1) : Image<double>();
  for (int y = 0; y < out.height(); ++y) {
    const std::span<double> row = out.row(y);
    if (overhang > 0.0) {
      const std::span<const double> excess = wide.row(y);
      for (std::size_t x = 0; x < row.size(); ++x) row[x] -= overhang * excess[x];
    }
    for (double& value : row) value /= window.area;
  }
  return out;
}

// Returns exp(-2 pi i s / T). s is first reduced to one period, exactly, so that far pixels are as accurate as near
// ones.
std::complex<double> carrier(int s, double pitch_px) {
  return std::polar(1.0, -kTwoPi * (std::fmod(static_cast<double>(s), pitch_px) / pitch_px));
}

// Returns each row (real, one per step along the axis) times the carrier. The columns are the real parts, the imaginary
// parts and, if the window leaks, the plain row.
Image<double> demodulated(const Image<double>& rows, const SamplingWindow& window) {
  const auto width = static_cast<std::size_t>(rows.width());
  Image<double> out(rows.width() * (window.leak != 0.0 ? 3 : 2), rows.height());
  for (int s = 0; s < rows.height(); ++s) {
    const std::complex<double> turn = carrier(s, window.pitch_px);
    const std::span<const double> row = rows.row(s);
    const std::span<double> target = out.row(s);
    for (std::size_t x = 0; x < width; ++x) target[x] = row[x] * turn.real();
    for (std::size_t x = 0; x < width; ++x) target[width + x] = row[x] * turn.imag();
    if (window.leak != 0.0) std::copy(row.begin(), row.end(), target.begin() + 2 * rows.width());
  }
  return out;
}

// Returns the averaged rows times the conjugate carrier. Their phase is that of Eq. (1) and not that of the moiré.
Image<std::complex<double>> remodulated(const Image<double>& parts, int width, Axis axis,
                                        const SamplingWindow& window) {
  const bool along_x = axis == Axis::kX;
  Image<std::complex<double>> out(along_x ? parts.height() : width, along_x ? width : parts.height());
  for (int s = 0; s < parts.height(); ++s) {
    const std::complex<double> back = std::conj(carrier(s + window.margin, window.pitch_px));
    for (int c = 0; c < width; ++c) {
      const double re = parts.at(c, s);
      const double im = parts.at(width + c, s);
      const double plain = window.leak != 0.0 ? window.leak * parts.at(2 * width + c, s) : 0.0;
      const std::complex<double> z(re * back.real() - im * back.imag() - plain, re * back.imag() + im * back.real());
      (along_x ? out.at(s, c) : out.at(c, s)) = z;
    }
  }
  return out;
}

}  // namespace

FringeField sampling_moire(ImageView<double> picture, Axis axis, double sampling_pitch_px) {
  if (!(sampling_pitch_px >= kMinSamplingPitchPx)) return {};
  const SamplingWindow window(sampling_pitch_px);
  if (std::min(picture.width, picture.height) < 2 * window.margin + 1) return {};
  // Average across the axis first, while the image is real. Then each row is one step along the axis.
  const Image<double> averaged = triangle_down(axis == Axis::kX ? picture : rows_as_columns(picture).view(), window);
  const Image<double> rows = rows_as_columns(averaged.view());
  const Image<double> parts = triangle_down(demodulated(rows, window).view(), window);
  return {remodulated(parts, rows.width(), axis, window), window.margin, sampling_pitch_px};
}

double window_response(double sampling_pitch_px, double cycles_per_px) {
  const SamplingWindow window(sampling_pitch_px);
  double response = 0.0;
  for (int u = -window.margin; u <= window.margin; ++u) {
    response += (window.along(u) * std::polar(1.0, kTwoPi * cycles_per_px * u)).real();
  }
  return response;
}

}  // namespace moiregauge::internal
