// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/processing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

#include "moiregauge/simulator/rendering/local_tone.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::simulator {

DrawnParts::DrawnParts(int width, int height)
    : width_(width),
      height_(height),
      columns_(static_cast<std::size_t>((width + kBlock - 1) / kBlock)),
      is_drawn_(columns_ * static_cast<std::size_t>((height + kBlock - 1) / kBlock), 0) {}

void DrawnParts::add(int left, int top, int right, int bottom) {
  const int x0 = std::max(left, 0), x1 = std::min(right, width_), y0 = std::max(top, 0), y1 = std::min(bottom, height_);
  if (x0 >= x1 || y0 >= y1) return;
  for (int row = y0 / kBlock; row <= (y1 - 1) / kBlock; ++row) {
    for (int column = x0 / kBlock; column <= (x1 - 1) / kBlock; ++column)
      is_drawn_[static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column)] = 1;
  }
}

namespace {

// Half widths of the filters in px.
int half_of_gaussian(double sigma_px) { return static_cast<int>(std::ceil(3.0 * sigma_px)); }
int half_of_bilateral(double sigma_px) { return static_cast<int>(std::ceil(2.0 * sigma_px)); }
constexpr int kHalfOfLowPass = 12;

// Returns a pixel of the image, continued beyond its edges by its border pixels.
double beyond_edges(const Image<double>& picture, int x, int y) {
  return picture.at(std::clamp(x, 0, picture.width() - 1), std::clamp(y, 0, picture.height() - 1));
}

// Replaces each drawn pixel by value(x, y), clipped. `value` reads the unchanged image.
template <typename Value>
void replace(const DrawnParts& parts, Image<double>& picture, const Value& value) {
  Image<double> made = picture;
  tbb::parallel_for(0, picture.height(), [&](int y) {
    parts.for_each_run(y, [&](int from, int to) {
      for (int x = from; x < to; ++x) made.at(x, y) = std::clamp(value(x, y), 0.0, 255.0);
    });
  });
  picture = std::move(made);
}

void median(int window_px, const DrawnParts& parts, Image<double>& picture) {
  const int half = window_px / 2;
  replace(parts, picture, [&](int x, int y) {
    std::array<double, 49> greys{};
    auto end = greys.begin();
    for (int v = -half; v <= half; ++v) {
      for (int u = -half; u <= half; ++u) *end++ = beyond_edges(picture, x + u, y + v);
    }
    const auto middle = greys.begin() + (end - greys.begin()) / 2;
    std::nth_element(greys.begin(), middle, end);
    return *middle;
  });
}

void bilateral(double sigma_px, double sigma_grey, const DrawnParts& parts, Image<double>& picture) {
  constexpr double kPerGrey = 16.0;
  std::vector<double> by_difference(static_cast<std::size_t>(256.0 * kPerGrey));
  for (std::size_t i = 0; i < by_difference.size(); ++i) {
    const double t = static_cast<double>(i) / kPerGrey / sigma_grey;
    by_difference[i] = std::exp(-0.5 * t * t);
  }
  const int half = half_of_bilateral(sigma_px);
  std::vector<double> by_distance;
  for (int d = 0; d <= half; ++d) by_distance.push_back(std::exp(-0.5 * d * d / (sigma_px * sigma_px)));
  replace(parts, picture, [&](int x, int y) {
    const double here = picture.at(x, y);
    double sum = 0.0, weights = 0.0;
    for (int v = -half; v <= half; ++v) {
      for (int u = -half; u <= half; ++u) {
        const double grey = beyond_edges(picture, x + u, y + v);
        const auto apart = static_cast<std::size_t>(std::min(std::abs(grey - here) * kPerGrey, 256.0 * kPerGrey - 1.0));
        const double weight = by_distance[static_cast<std::size_t>(std::abs(u))] *
                              by_distance[static_cast<std::size_t>(std::abs(v))] * by_difference[apart];
        sum += weight * grey;
        weights += weight;
      }
    }
    return sum / weights;
  });
}

// Taps of a symmetric separable filter: the middle one and those of one side. The sum with both sides is 1.
using Taps = std::vector<double>;

Taps unit_sum(Taps taps) {
  double sum = taps[0];
  for (std::size_t i = 1; i < taps.size(); ++i) sum += 2.0 * taps[i];
  for (double& tap : taps) tap /= sum;
  return taps;
}

Taps gaussian_taps(double sigma_px) {
  Taps taps;
  for (int i = 0; i <= half_of_gaussian(sigma_px); ++i) taps.push_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
  return unit_sum(taps);
}

// Returns the truncated low-pass sin(2 pi c n) / (pi n), which rings at edges as an image scaler does.
Taps low_pass_taps(double cycles_per_px) {
  Taps taps{2.0 * cycles_per_px};
  for (int i = 1; i <= kHalfOfLowPass; ++i) taps.push_back(std::sin(kTwoPi * cycles_per_px * i) / (kPi * i));
  return unit_sum(taps);
}

struct Step {
  int x, y;  // px
};

// Returns the sum of the taps on both sides of (x, y), along the direction of `step`.
double weighted_sum(const Taps& taps, const Image<double>& image, int x, int y, Step step) {
  double sum = taps[0] * image.at(x, y);
  for (int i = 1; i < static_cast<int>(taps.size()); ++i)
    sum += taps[static_cast<std::size_t>(i)] *
           (beyond_edges(image, x + i * step.x, y + i * step.y) + beyond_edges(image, x - i * step.x, y - i * step.y));
  return sum;
}

// Returns the filtered image without clipping.
Image<double> filtered(const Taps& taps, const DrawnParts& parts, const Image<double>& picture) {
  Image<double> across = picture, both = picture;
  const auto pass = [&](const Image<double>& from_image, Image<double>& made, Step step) {
    tbb::parallel_for(0, picture.height(), [&](int y) {
      parts.for_each_run(y, [&](int from, int to) {
        for (int x = from; x < to; ++x) made.at(x, y) = weighted_sum(taps, from_image, x, y, step);
      });
    });
  };
  pass(picture, across, {1, 0});
  pass(across, both, {0, 1});
  return both;
}

// Block of pixels along one axis: the first pixel, and the share of each pixel in the block.
struct Block {
  int first = 0;
  std::vector<double> shares;
};

std::vector<Block> blocks_of(int length_px, double size) {
  std::vector<Block> blocks(static_cast<std::size_t>(length_px));
  for (int x = 0; x < length_px; ++x) {
    const double from = std::floor((x + 0.5) / size) * size, to = std::min(from + size, static_cast<double>(length_px));
    Block& block = blocks[static_cast<std::size_t>(x)];
    block.first = static_cast<int>(from);
    for (int i = block.first; i < to; ++i)
      block.shares.push_back((std::min(i + 1.0, to) - std::max(static_cast<double>(i), from)) / (to - from));
  }
  return blocks;
}

void enlarge_pixels(double size, const DrawnParts& parts, Image<double>& picture) {
  const auto columns = blocks_of(picture.width(), size), rows = blocks_of(picture.height(), size);
  replace(parts, picture, [&](int x, int y) {
    const Block &u = columns[static_cast<std::size_t>(x)], &v = rows[static_cast<std::size_t>(y)];
    double sum = 0.0;
    for (std::size_t j = 0; j < v.shares.size(); ++j) {
      for (std::size_t i = 0; i < u.shares.size(); ++i)
        sum += v.shares[j] * u.shares[i] * picture.at(u.first + static_cast<int>(i), v.first + static_cast<int>(j));
    }
    return sum;
  });
}

}  // namespace

bool has_spatial_steps(const Processing& p) {
  return p.median_px > 1 || p.bilateral_px > 0.0 || p.local_tone.strength != 0.0 || p.sharpen_amount != 0.0 ||
         p.low_pass > 0.0 || p.pixel_size > 1.0;
}

int reach_of(const Processing& p) {
  int reach = p.median_px / 2;
  if (p.bilateral_px > 0.0) reach += half_of_bilateral(p.bilateral_px);
  if (p.sharpen_amount != 0.0) reach += half_of_gaussian(p.sharpen_radius_px);
  if (p.low_pass > 0.0) reach += kHalfOfLowPass;
  if (p.pixel_size > 1.0) reach += static_cast<int>(std::ceil(p.pixel_size));
  return reach;
}

void develop(const Processing& p, const DrawnParts& parts, Image<double>& picture) {
  if (p.median_px > 1) median(p.median_px, parts, picture);
  if (p.bilateral_px > 0.0) bilateral(p.bilateral_px, p.bilateral_grey, parts, picture);
  if (p.local_tone.strength != 0.0) map_local_tones(p.local_tone, picture);
  if (p.sharpen_amount != 0.0) {
    const Image<double> soft = filtered(gaussian_taps(p.sharpen_radius_px), parts, picture);
    replace(parts, picture,
            [&](int x, int y) { return picture.at(x, y) + p.sharpen_amount * (picture.at(x, y) - soft.at(x, y)); });
  }
  if (p.low_pass > 0.0) {
    const Image<double> passed = filtered(low_pass_taps(p.low_pass), parts, picture);
    replace(parts, picture, [&](int x, int y) { return passed.at(x, y); });
  }
  if (p.pixel_size > 1.0) enlarge_pixels(p.pixel_size, parts, picture);
}

}  // namespace moiregauge::internal::simulator
