// SPDX-License-Identifier: Apache-2.0
#include "studies/world/blur.h"

#include <algorithm>
#include <cmath>

#include "studies/world/exposure.h"

namespace world {
namespace {

// Returns the kernel convolved with the area of a pixel. Its first weight is that of the sample `radius` before the
// pixel's first one.
std::vector<float> with_pixel_area(const std::vector<float>& kernel, int samples) {
  const int size = static_cast<int>(kernel.size());
  std::vector<float> out(static_cast<std::size_t>(size + samples - 1));
  for (int m = 0; m < size + samples - 1; ++m) {
    for (int s = 0; s < samples; ++s) {
      const int k = s + size - 1 - m;
      if (k >= 0 && k < size) out[static_cast<std::size_t>(m)] += kernel[static_cast<std::size_t>(k)];
    }
    out[static_cast<std::size_t>(m)] /= static_cast<float>(samples);
  }
  return out;
}

}  // namespace

std::vector<float> skewed_kernel(double sigma, double skew) {
  const int radius = std::max(1, static_cast<int>(std::ceil((skew == 0.0 ? 4.0 : 6.0) * sigma)));
  std::vector<double> weights;
  double sum = 0.0;
  for (int i = -radius; i <= radius; ++i) {
    const double z = i / sigma, wide = (z - (skew > 0.0 ? 1.2 : -1.2)) / 1.6;
    const double narrow = std::exp(-0.5 * z * z);
    weights.push_back((1.0 - std::abs(skew)) * narrow + std::abs(skew) * std::exp(-0.5 * wide * wide) / 1.6);
    sum += weights.back();
  }
  std::vector<float> out;
  for (const double w : weights) out.push_back(static_cast<float>(w / sum));
  return out;
}

void blur(Picture& picture, const std::vector<float>& along_x, const std::vector<float>& along_y) {
  const int rx = static_cast<int>(along_x.size() / 2), ry = static_cast<int>(along_y.size() / 2);
  std::vector<float> padded(static_cast<std::size_t>(picture.width + 2 * rx));
  for (int y = 0; y < picture.height; ++y) {
    float* row = picture.row(y);
    for (int x = -rx; x < picture.width + rx; ++x) {
      padded[static_cast<std::size_t>(x + rx)] = row[std::clamp(x, 0, picture.width - 1)];
    }
    std::fill(row, row + picture.width, 0.0F);
    for (int k = 0; k <= 2 * rx; ++k) {
      const float weight = along_x[static_cast<std::size_t>(2 * rx - k)];
      for (int x = 0; x < picture.width; ++x) row[x] += weight * padded[static_cast<std::size_t>(x + k)];
    }
  }
  const Picture rows = picture;
  std::fill(picture.values.begin(), picture.values.end(), 0.0F);
  for (int y = 0; y < picture.height; ++y) {
    float* out = picture.row(y);
    for (int k = -ry; k <= ry; ++k) {
      const float weight = along_y[static_cast<std::size_t>(ry - k)];
      const float* in = rows.row(std::clamp(y + k, 0, picture.height - 1));
      for (int x = 0; x < picture.width; ++x) out[x] += weight * in[x];
    }
  }
}

Picture blurred_to_pixels(const Picture& fine, int samples, const std::vector<float>& along_x,
                          const std::vector<float>& along_y) {
  const std::vector<float> x_weights = with_pixel_area(along_x, samples), y_weights = with_pixel_area(along_y, samples);
  const int rx = static_cast<int>(along_x.size() / 2), ry = static_cast<int>(along_y.size() / 2);
  Picture rows(fine.width / samples, fine.height), out(fine.width / samples, fine.height / samples);
  std::vector<float> padded(static_cast<std::size_t>(fine.width + 2 * rx));
  for (int y = 0; y < fine.height; ++y) {
    const float* in = fine.row(y);
    for (int x = -rx; x < fine.width + rx; ++x) {
      padded[static_cast<std::size_t>(x + rx)] = in[std::clamp(x, 0, fine.width - 1)];
    }
    for (int x = 0; x < rows.width; ++x) {
      const float* from = padded.data() + static_cast<std::ptrdiff_t>(x) * samples;
      float sum = 0.0F;
      for (const float weight : x_weights) sum += weight * *from++;
      rows.row(y)[x] = sum;
    }
  }
  for (int y = 0; y < out.height; ++y) {
    float* to = out.row(y);
    int at = y * samples - ry;
    for (const float weight : y_weights) {
      const float* in = rows.row(std::clamp(at++, 0, rows.height - 1));
      for (int x = 0; x < out.width; ++x) to[x] += weight * in[x];
    }
  }
  return out;
}

}  // namespace world
