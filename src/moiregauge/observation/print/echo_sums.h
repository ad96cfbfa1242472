// SPDX-License-Identifier: Apache-2.0
// Share of the previous frame in the current one, from sums over the frames of a recording. echo.h collects them.
//
// Edges. A frame i gives a share s_i with weight w_i. An error of the template is structure that moves with the grating.
// Its effect on s_i is constant while the grating moves in one direction, and changes sign with that direction.
//
//     s_i = s + a x_i + b y_i
//
// Here (x_i, y_i) has the direction of the movement, and the standard deviation of s_i by noise as its length. So the
// variance of a and b is that of the structure relative to the noise.
//
// Behind tone curves and sharpening the structure exceeds the noise. It differs from grating to grating, and an echo does
// not: the scatter of the gratings' own shares beyond their noise widens u. Slow movement in one direction needs this.
//
// Noise. The residuals of frames t and t - k are multiplied, at pixels e apart. The mean product is:
//
//     <r(t, p) r(t - k, p - e)> / <r^2> = alpha_t + sum_mn beta_mn cos(pi m dx / 2 px) cos(pi n dy / 2 px)
//                                         + s [k = 1, e = 0]
//
// The distance (dx, dy) of both pixels on the sheet is along the axes of its pattern. Structure of template, print and
// paper gives beta. Products with other e have similar distances as those with e = 0, but no echo. That separates s
// from beta also where all frames have the same movement. A pattern fixed to the sensor gives alpha. It varies with the
// place of the edges in their pixels, so each frame has one for e = 0 and one for the others.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "moiregauge/observation/print/movement_blur.h"

namespace moiregauge::internal {

// Shares of one grating over all frames.
struct GratingShares {
  double weight = 0.0;    // sum of 1 / u^2
  double weighted = 0.0;  // sum of s / u^2
};

// Share of the previous frame and its standard uncertainty, 1.
struct EchoShare {
  double share = 0.0;
  double u = std::numeric_limits<double>::infinity();
};

// Products of one grating: weighted normal equations of all beta, s and the product, without alpha.
struct NoiseSums {
  // Those of beta_10 and s, lower triangle by rows, and with the product.
  std::array<double, 3> normal{};
  std::array<double, 2> right{};
  double squares = 0.0, equations = 0.0;
  std::array<double, 99> structure{};  // the rest, lower triangle by rows
};

struct EchoSums {
  // Edges: sums of w, w^2, w s and w s^2.
  double weights = 0.0, squared_weights = 0.0, shares = 0.0, squared_shares = 0.0;
  // Noise: sums over all gratings, with the names of NoiseSums.
  std::array<double, 3> normal{};
  std::array<double, 2> right{};
  double squares = 0.0, equations = 0.0;
  // Edges: sums of w x x, w x y, w y y, w x, w y, w x s, w y s.
  std::array<double, 7> directions{};
  std::array<double, 99> structure{};   // noise, as above
  std::vector<GratingShares> gratings;  // edges, per marker
  // Behind a codec that predicts, and for equal frames.
  BlurSlope blur;
  EchoShare both_sides;          // share of the images before and after, each
  std::vector<NoiseSums> noise;  // per marker; empty in a run of an earlier version
};

// Share by the edges of one frame.
struct FrameShare {
  double share = 0.0;
  double u = 0.0;           // by noise of the pixels
  double x = 0.0, y = 0.0;  // as above
};
void add_share(const FrameShare& frame, EchoSums& sums);
// Adds the share by the edges of one grating in one frame. `u`: by noise of the pixels.
void add_grating(std::size_t marker, double share, double u, EchoSums& sums);

// A product of residuals, over <r^2>.
struct NoiseProduct {
  double dx = 0.0, dy = 0.0;  // px, at most kLargestDistance_px together
  bool is_echo = false;       // k = 1 and e = 0
  double value = 0.0;         // 1
};
// Distance up to which the terms describe the structure. Chosen: at 1.8 px, shares without an echo were 0.03 to 0.05.
inline constexpr double kLargestDistance_px = 1.2;
// Adds products of one grating and frame that have the same alpha. `weight`: number of pixels.
void add_products(std::size_t marker, const std::vector<NoiseProduct>& products, double weight, EchoSums& sums);

// Return the share by the edges, by the noise, and by both, weighted. u is infinite if the recording shows no share.
// Error: u is by the scatter between frames. It is enlarged for few frames, so that 4 u are as rare as 4 sigma.
[[nodiscard]] EchoShare share_by_edges(const EchoSums& sums);
[[nodiscard]] EchoShare share_by_noise(const EchoSums& sums);
[[nodiscard]] EchoShare share_by_both(const EchoSums& sums);

// Returns the mean of the shares of both sides, one per frame. u is infinite for fewer than five frames.
[[nodiscard]] EchoShare share_of_both_sides(const std::vector<double>& shares);

// Smallest share of the previous frame that matters: the lag of a target is that share of its movement per frame.
inline constexpr double kLeastEcho = 0.03;
// Returns true if further frames change nothing: u is small, or the share by the edges is certainly below kLeastEcho.
[[nodiscard]] bool is_decided(const EchoSums& sums);

}  // namespace moiregauge::internal
