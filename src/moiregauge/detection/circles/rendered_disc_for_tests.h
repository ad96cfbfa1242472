// SPDX-License-Identifier: Apache-2.0
// Renders discs for tests from their geometry. Shares no code with the detector.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::test {

struct Disc {
  double x = 0.0, y = 0.0;  // px, centre of the ellipse
  double diameter = 30.0;   // px, major axis
  double tilt_rad = 0.0;    // minor / major = cos(tilt)
  double turn_rad = 0.0;    // direction of the major axis, from image x towards image y
};

struct Scene {
  int size = 128;                    // px, width and height
  double psf_px = 0.7;               // px, sigma of the lens blur, without the box of the pixel
  double paper = 170.0, ink = 40.0;  // grey levels
  double shading = 0.0;              // relative change of the light across the image
};

// Returns the integral of the normal distribution function up to z.
inline double ramp(double z) {
  return z * 0.5 * std::erfc(-z * std::sqrt(0.5)) + std::exp(-0.5 * z * z) / std::sqrt(kTwoPi);
}

// Returns the share of a blurred box pixel beyond an edge, for its centre at distance a (px).
inline double beyond_edge(double a, double sigma) {
  return sigma * (ramp((a + 0.5) / sigma) - ramp((a - 0.5) / sigma));
}

// Returns the share of each pixel inside the disc. Exact along x (Gaussian and box over each chord); midpoint rule with
// steps of 1/20 px along y.
inline std::vector<double> coverage(const Disc& disc, const Scene& scene) {
  const double a = 0.5 * disc.diameter, b = a * std::cos(disc.tilt_rad), c = std::cos(disc.turn_rad),
               s = std::sin(disc.turn_rad);
  const double xx = a * a * c * c + b * b * s * s, xy = (a * a - b * b) * c * s, yy = a * a * s * s + b * b * c * c;
  std::vector<double> out(static_cast<std::size_t>(scene.size * scene.size), 0.0);
  const double half = std::sqrt(yy), reach = 5.0 * scene.psf_px + 1.0;
  const int chords = static_cast<int>(std::ceil(2.0 * half * 20.0));
  for (int i = 0; i < chords; ++i) {
    const double dy = -half + 2.0 * half * (i + 0.5) / chords, y = disc.y + dy;
    const double middle = disc.x + xy / yy * dy,
                 width = std::sqrt(std::max(0.0, (xx * yy - xy * xy) / yy * (1.0 - dy * dy / yy)));
    for (int py = std::max(0, static_cast<int>(y - reach)); py <= std::min(scene.size - 1, static_cast<int>(y + reach));
         ++py) {
      const double down = (beyond_edge(y - py + 1e-3, scene.psf_px) - beyond_edge(y - py - 1e-3, scene.psf_px)) / 2e-3;
      for (int px = 0; px < scene.size; ++px) {
        const double along =
            beyond_edge(px - middle + width, scene.psf_px) - beyond_edge(px - middle - width, scene.psf_px);
        out[static_cast<std::size_t>(py * scene.size + px)] += along * down * 2.0 * half / chords;
      }
    }
  }
  return out;
}

inline std::vector<double> grey_levels(const std::vector<double>& coverage, const Scene& scene) {
  std::vector<double> out;
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const double x = static_cast<double>(i % static_cast<std::size_t>(scene.size)) / scene.size - 0.5;
    out.push_back((scene.paper + (scene.ink - scene.paper) * coverage[i]) * (1.0 + scene.shading * x));
  }
  return out;
}

template <typename Grey>
Image<Grey> picture(const std::vector<double>& levels, int size, double gain, double noise_sigma,
                    std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  Image<Grey> out(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double level = levels[static_cast<std::size_t>(y * size + x)] + noise_sigma * normal(rng);
      out.at(x, y) = static_cast<Grey>(std::clamp(gain * level + 0.5, 0.0, sizeof(Grey) == 1 ? 255.0 : 65535.0));
    }
  }
  return out;
}

}  // namespace moiregauge::internal::test
