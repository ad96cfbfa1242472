// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/echo_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/observation/print/few_frames.h"

namespace moiregauge::internal {
namespace {

constexpr double kAlikeError = 0.02;  // frames of a smaller u weigh alike, so that no single one decides. Chosen.
// A test is decided when u is far below the smallest share that matters. Chosen.
constexpr double kDecidedByEdges = 0.003, kDecidedByNoise = 0.008;
constexpr double kDecidingFrames = 12.0;
// Distance in u from the smallest share that matters at which there is certainly no echo. It is tested after each frame:
// over 400 frames a share of that size would end the work once in a hundred recordings at most. Chosen.
constexpr double kSureOfNone = 4.0;

// Largest structure in relation to the noise, as a standard deviation of beta: both have the same variance. Chosen.
constexpr double kStructure = 1.0;
// Structure of a template alone: harmonics beyond its last one, at the edges of binary gratings. Their products give
// 0.16 to 0.18. The odd column sees twice as much, because it has the same edges.
constexpr double kLeastStructure = 0.4;
// Standard uncertainty of a share by noise, for structure that the terms leave. Fifteen recordings without an echo scattered
// by 0.0125, of which 0.0079 is noise. They moved by 0.6 px per frame in one direction.
constexpr double kLeftStructure = 0.0097;
// Largest u of a share by noise that says something. Few products remain where blur excludes most frames, and then their
// errors are not those of pixels. Behind a bilateral filter a clean recording had 0.57 at u = 0.19. Chosen.
constexpr double kKnownShare = 0.1;
// Smallest variance of the shares by which the normal equations are divided.
constexpr double kLeastVariance = 1e-12;
// Terms (m, n) of the structure, each number in quarters of a cycle per pixel.
constexpr std::array<std::array<int, 2>, 12> kWaves{
    {{1, 0}, {2, 0}, {3, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {1, 2}, {2, 1}, {2, 2}, {1, 3}, {3, 1}}};
constexpr int kTerms = static_cast<int>(kWaves.size());
constexpr int kShare = kTerms, kValue = kTerms + 1;
constexpr double kLeastEquations = 2.0 * kMinMovingFrames + kTerms;  // chosen
using ProductRow = Eigen::Matrix<double, kTerms + 2, 1>;
using ProductNormal = Eigen::Matrix<double, kTerms + 2, kTerms + 2>;

// Calls `visit(i, j, sum)` for the lower triangle of the normal equations of the products.
template <typename Sums, typename Visit>
void for_each_product(Sums& sums, Visit visit) {
  visit(0, 0, sums.normal[0]), visit(kShare, 0, sums.normal[1]), visit(kShare, kShare, sums.normal[2]);
  visit(kValue, 0, sums.right[0]), visit(kValue, kShare, sums.right[1]), visit(kValue, kValue, sums.squares);
  std::size_t next = 0;
  for (int i = 1; i <= kValue; ++i) {
    for (int j = 0; j <= i; ++j) {
      const bool has_term = (i > 0 && i < kTerms) || (j > 0 && j < kTerms);
      if (has_term) visit(i, j, sums.structure[next++]);
    }
  }
}

ProductRow row_of(const NoiseProduct& product) {
  ProductRow row;
  constexpr double kQuarter = std::numbers::pi / 2.0;
  for (int i = 0; i < kTerms; ++i) {
    const auto [m, n] = kWaves[static_cast<std::size_t>(i)];
    row(i) = std::cos(kQuarter * m * product.dx) * std::cos(kQuarter * n * product.dy);
  }
  row(kShare) = product.is_echo ? 1.0 : 0.0;
  row(kValue) = product.value;
  return row;
}

// Returns the effective number of frames whose edges moved.
double frames_of(const EchoSums& sums) {
  return sums.squared_weights > 0.0 ? sums.weights * sums.weights / sums.squared_weights : 0.0;
}

// Returns the variance of the mean share by what differs between gratings beyond their noise (DerSimonian and Laird 1986,
// Controlled Clinical Trials 7, 177-188). Zero for a single grating.
double variance_between(const std::vector<GratingShares>& gratings) {
  double w = 0.0, w2 = 0.0, ws = 0.0, ws2 = 0.0, count = 0.0;
  for (const GratingShares& grating : gratings) {
    if (!(grating.weight > 0.0)) continue;
    const double share = grating.weighted / grating.weight;
    w += grating.weight, w2 += grating.weight * grating.weight;
    ws += grating.weighted, ws2 += grating.weighted * share, count += 1.0;
  }
  if (count < 2.0) return 0.0;
  const double excess = std::max(0.0, (ws2 - ws * ws / w) - (count - 1.0)) / (w - w2 / w);
  const double few = enlargement_of_few(count - 1.0);
  return few * few * excess * w2 / (w * w);
}

using NoiseNormal = Eigen::Matrix<double, kTerms, kTerms>;
using NoiseTerms = Eigen::Matrix<double, kTerms, 1>;

// Normal equations of one beta and s, and beta without s.
struct NoiseEquations {
  NoiseTerms structure;                 // beta without an echo
  double weight = 0.0, weighted = 0.0;  // the share's, and its product with the share
  double square = 0.0;                  // what beta leaves of the squared products
};

template <typename Sums>
NoiseEquations equations_of(const Sums& sums) {
  ProductNormal all;
  for_each_product(sums, [&](int i, int j, double sum) { all(i, j) = all(j, i) = sum; });
  NoiseNormal normal = all.topLeftCorner<kTerms, kTerms>();
  normal.diagonal().array() += 1.0 / (kStructure * kStructure);
  const Eigen::LDLT<NoiseNormal> solver(normal);
  const NoiseTerms by_share = all.block<kTerms, 1>(0, kShare), by_value = all.block<kTerms, 1>(0, kValue);
  const NoiseTerms structure = solver.solve(by_value);
  return {structure, all(kShare, kShare) - by_share.dot(solver.solve(by_share)),
          all(kShare, kValue) - by_share.dot(structure), all(kValue, kValue) - by_value.dot(structure)};
}

// Returns the structure of all gratings: the mean product of neighbours at distance zero, relative to <r^2>.
double structure_by_noise(const EchoSums& sums) {
  return sums.equations < kLeastEquations ? 0.0 : equations_of(sums).structure.sum();
}

// Eliminates the beta of each grating.
EchoShare fit_noise(const EchoSums& sums) {
  if (sums.equations < kLeastEquations) return {};
  NoiseEquations all;
  std::vector<GratingShares> shares;
  double freedom = -1.0;
  const auto add = [&](const auto& grating) {
    if (grating.equations <= kTerms) return;
    const NoiseEquations one = equations_of(grating);
    if (!(one.weight > 0.0)) return;
    all.weight += one.weight, all.weighted += one.weighted, all.square += one.square;
    shares.push_back({one.weight, one.weighted});
    freedom += grating.equations - kTerms;
  };
  if (sums.noise.empty()) add(sums);
  for (const NoiseSums& grating : sums.noise) add(grating);
  if (!(all.weight > 0.0 && freedom >= 1.0)) return {};
  const double share = all.weighted / all.weight;
  const double few = enlargement_of_few(freedom);
  // The noise of the products is known. What exceeds it is known by their scatter only.
  const double variance = 1.0 + few * few * std::max(0.0, (all.square - share * all.weighted) / freedom - 1.0);
  for (GratingShares& one : shares) one.weight /= variance, one.weighted /= variance;
  return {share, std::sqrt(variance / all.weight + variance_between(shares))};
}

}  // namespace

void add_share(const FrameShare& frame, EchoSums& sums) {
  const double w = 1.0 / (frame.u * frame.u + kAlikeError * kAlikeError);
  const double s = std::clamp(frame.share, -1.0, 1.0), x = frame.x, y = frame.y;
  sums.weights += w, sums.squared_weights += w * w, sums.shares += w * s, sums.squared_shares += w * s * s;
  const std::array<double, 7> more{x * x, x * y, y * y, x, y, x * s, y * s};
  for (std::size_t i = 0; i < more.size(); ++i) sums.directions[i] += w * more[i];
}

void add_grating(std::size_t marker, double share, double u, EchoSums& sums) {
  if (sums.gratings.size() <= marker) sums.gratings.resize(marker + 1);
  sums.gratings[marker].weight += 1.0 / (u * u);
  sums.gratings[marker].weighted += share / (u * u);
}

void add_products(std::size_t marker, const std::vector<NoiseProduct>& products, double weight, EchoSums& sums) {
  if (products.size() < 2) return;  // alpha takes a single one
  if (sums.noise.size() <= marker) sums.noise.resize(marker + 1);
  ProductRow mean = ProductRow::Zero();
  for (const NoiseProduct& one : products) mean += row_of(one) / static_cast<double>(products.size());
  NoiseSums& grating = sums.noise[marker];
  for (const NoiseProduct& one : products) {
    const ProductRow row = row_of(one) - mean;
    const auto add = [&](int i, int j, double& sum) { sum += weight * row(i) * row(j); };
    for_each_product(sums, add), for_each_product(grating, add);
  }
  sums.equations += static_cast<double>(products.size() - 1);
  grating.equations += static_cast<double>(products.size() - 1);
}

EchoShare share_by_edges(const EchoSums& sums) {
  const double frames = frames_of(sums);
  if (!(frames >= kMinMovingFrames)) return {};
  const double structure = std::max(kLeastStructure, structure_by_noise(sums));
  const auto& [xx, xy, yy, x, y, xs, ys] = sums.directions;
  Eigen::Matrix3d normal;
  normal << xx, xy, x, xy, yy, y, x, y, sums.weights;
  const Eigen::Vector3d right(xs, ys, sums.shares);
  // `variance`: of a share, relative to 1 / w.
  const auto fit = [&](double variance) {
    Eigen::Matrix3d scaled = normal / variance;
    scaled(0, 0) += 1.0 / structure, scaled(1, 1) += 1.0 / structure;
    const Eigen::Matrix3d inverse = scaled.inverse();
    return std::pair(Eigen::Vector3d(inverse * right / variance), inverse(2, 2));
  };
  const double scatter = std::max(0.0, sums.squared_shares - fit(1.0).first.dot(right));
  const double few = enlargement_of_few(frames - 1.0);
  const auto [found, square_of_u] = fit(std::max(kLeastVariance, few * few * scatter / (frames - 1.0)));
  return {found(2), std::sqrt(square_of_u + variance_between(sums.gratings))};
}

EchoShare share_by_noise(const EchoSums& sums) {
  const EchoShare share = fit_noise(sums);
  if (!(share.u <= kKnownShare)) return {};
  return {share.share, std::hypot(share.u, kLeftStructure)};
}

EchoShare share_by_both(const EchoSums& sums) {
  const EchoShare edges = share_by_edges(sums), noise = share_by_noise(sums);
  const double a = 1.0 / (edges.u * edges.u), b = 1.0 / (noise.u * noise.u);
  if (!(a + b > 0.0)) return {};
  return {(a * edges.share + b * noise.share) / (a + b), 1.0 / std::sqrt(a + b)};
}

EchoShare share_of_both_sides(const std::vector<double>& shares) {
  const auto frames = static_cast<double>(shares.size());
  if (frames < kMinMovingFrames) return {};
  double sum = 0.0, squares = 0.0;
  for (const double share : shares) sum += share, squares += share * share;
  const double mean = sum / frames;
  const double variance = std::max(0.0, squares / frames - mean * mean) / (frames - 1.0);
  return {mean, enlargement_of_few(frames - 1.0) * std::sqrt(variance)};
}

bool is_decided(const EchoSums& sums) {
  const EchoShare edges = share_by_edges(sums);
  const bool is_known = edges.u < kDecidedByEdges || edges.share + kSureOfNone * edges.u < kLeastEcho;
  return (frames_of(sums) >= kDecidingFrames && is_known) || fit_noise(sums).u < kDecidedByNoise;
}

}  // namespace moiregauge::internal
