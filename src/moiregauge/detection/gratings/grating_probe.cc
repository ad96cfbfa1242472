// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/gratings/grating_probe.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/detection/gratings/stratified_points.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kSide = 16;    // sample points along each axis
constexpr double kProbeReach = 1.1;  // periods
constexpr int kMaxTerms = 9;         // mean, (1, 0), (0, 1), (1, 1), (1, -1)

const std::array<Eigen::Vector2d, kSide * kSide>& places() {
  static const auto list = [] {
    std::array<Eigen::Vector2d, kSide * kSide> out;
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = kProbeReach * (2.0 * markers_detail::stratified_in_square(i, kSide) - Eigen::Vector2d(1, 1));
    return out;
  }();
  return list;
}

constexpr std::size_t kThinSide = 24;  // sample points along each axis
constexpr double kThinReach = 1.6;     // periods: two lines or more each way, so that half the pitch does not fit
constexpr int kProfileOrder = 3;       // harmonics of one profile
constexpr int kFirstProduct = 1 + 4 * kProfileOrder;
constexpr int kThinTerms = kFirstProduct + 4;  // and harmonics (1, 1) and (1, -1)
// Amplitude of the second harmonic, relative to the first: cos(pi d) for lines of share d, 0.5 at a third of the pitch.
// The seed's error and ragged edges lower it.
constexpr double kMinProbedSecond = 0.3;
// Harmonics (1, 1) and (1, -1), relative to the first: 0.2 for thin lines, 0.8 for small dots and squares.
constexpr double kMaxProbedDiagonal = 0.5;

}  // namespace

double explained_by(const LatticeSeed& seed, const Image<float>& grey) {
  const bool lines = seed.k2.isZero();
  Eigen::Matrix2d k;
  k.row(0) = seed.k1.transpose();
  k.row(1) = lines ? Eigen::RowVector2d(-seed.k1.y(), seed.k1.x()) : Eigen::RowVector2d(seed.k2.transpose());
  const Eigen::Matrix2d px_from_phi = k.inverse();
  const Eigen::Index terms = lines ? 3 : kMaxTerms;
  Eigen::Matrix<double, kMaxTerms + 1, kMaxTerms + 1> sums = decltype(sums)::Zero();  // the last one is the grey level
  for (const Eigen::Vector2d& place : places()) {
    const Eigen::Vector2d x = px_from_phi * place;
    const int px = static_cast<int>(std::lround(seed.centre.x + x.x())),
              py = static_cast<int>(std::lround(seed.centre.y + x.y()));
    if (px < 0 || py < 0 || px >= grey.width() || py >= grey.height()) continue;
    const Eigen::Vector2d phi = kTwoPi * (k * Eigen::Vector2d(px - seed.centre.x, py - seed.centre.y));
    const double c1 = std::cos(phi.x()), s1 = std::sin(phi.x());
    Eigen::Matrix<double, kMaxTerms + 1, 1> row = decltype(row)::Zero();
    row.head<3>() << 1.0, c1, s1;
    if (!lines) {
      const double c2 = std::cos(phi.y()), s2 = std::sin(phi.y());
      row.segment<6>(3) << c2, s2, c1 * c2, s1 * s2, s1 * c2, c1 * s2;
    }
    row[kMaxTerms] = double{grey.at(px, py)};
    sums.noalias() += row * row.transpose();
  }
  const double count = sums(0, 0), greys = sums(0, kMaxTerms);
  // Fewer than half of the sample points are inside the image: too few for a decision.
  if (count < 0.5 * kSide * kSide) return 0.0;
  const double variation = sums(kMaxTerms, kMaxTerms) - greys * greys / count;
  Eigen::MatrixXd normal = sums.topLeftCorner(terms, terms);
  normal.diagonal().array() += 1e-6 * count;
  const Eigen::VectorXd right = sums.col(kMaxTerms).head(terms);
  const double left = sums(kMaxTerms, kMaxTerms) - normal.ldlt().solve(right).dot(right);
  return variation > 0.0 ? std::clamp(1.0 - left / variation, 0.0, 1.0) : 0.0;
}

double explained_by_thin_lines(const LatticeSeed& seed, const Image<float>& grey) {
  Eigen::Matrix2d k;
  k << seed.k1.transpose(), seed.k2.transpose();
  if (!(std::abs(k.determinant()) > 0.0)) return 0.0;  // lines along one axis are no grid
  const Eigen::Matrix2d px_from_phi = k.inverse();
  Eigen::Matrix<double, kThinTerms + 1, kThinTerms + 1> sums = decltype(sums)::Zero();  // the last is the grey level
  Eigen::Matrix<double, kThinTerms + 1, 1> row;
  for (std::size_t i = 0; i < kThinSide * kThinSide; ++i) {
    const Eigen::Vector2d place =
        kThinReach * (2.0 * markers_detail::stratified_in_square(i, kThinSide) - Eigen::Vector2d(1, 1));
    const Eigen::Vector2d x = px_from_phi * place;
    const int px = static_cast<int>(std::lround(seed.centre.x + x.x())),
              py = static_cast<int>(std::lround(seed.centre.y + x.y()));
    if (px < 0 || py < 0 || px >= grey.width() || py >= grey.height()) continue;
    const Eigen::Vector2d phi = kTwoPi * (k * Eigen::Vector2d(px - seed.centre.x, py - seed.centre.y));
    row[0] = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
      const double c = std::cos(phi[axis]), s = std::sin(phi[axis]);
      double cn = 1.0, sn = 0.0;
      for (int n = 0; n < kProfileOrder; ++n) {
        const double next = cn * c - sn * s;
        sn = sn * c + cn * s;
        cn = next;
        const int at = 1 + 2 * (axis * kProfileOrder + n);
        row[at] = cn;
        row[at + 1] = sn;
      }
    }
    const auto wave1 = row.segment<2>(1), wave2 = row.segment<2>(1 + 2 * kProfileOrder);
    row.segment<2>(kFirstProduct) = wave1[0] * wave2;
    row.segment<2>(kFirstProduct + 2) = wave1[1] * wave2;
    row[kThinTerms] = double{grey.at(px, py)};
    sums.selfadjointView<Eigen::Lower>().rankUpdate(row);
  }
  const double count = sums(0, 0), greys = sums(kThinTerms, 0);
  if (count < 0.5 * kThinSide * kThinSide) return 0.0;
  const double variation = sums(kThinTerms, kThinTerms) - greys * greys / count;
  Eigen::Matrix<double, kThinTerms, kThinTerms> normal = sums.topLeftCorner<kThinTerms, kThinTerms>();
  normal.diagonal().array() += 1e-6 * count;
  const Eigen::Matrix<double, kThinTerms, 1> right = sums.row(kThinTerms).head<kThinTerms>().transpose();
  const Eigen::Matrix<double, kThinTerms, 1> profile = normal.ldlt().solve(right);
  double strongest = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    const auto first = profile.segment<2>(1 + 2 * axis * kProfileOrder),
               second = profile.segment<2>(3 + 2 * axis * kProfileOrder);
    if (second.norm() < kMinProbedSecond * first.norm()) return 0.0;
    strongest = std::max(strongest, first.norm());
  }
  // Harmonics (1, 1) and (1, -1) of amplitude a give four product terms with a norm of 2 a.
  if (0.5 * profile.tail<4>().norm() > kMaxProbedDiagonal * strongest) return 0.0;
  const double left = sums(kThinTerms, kThinTerms) - profile.dot(right);
  return variation > 0.0 ? std::clamp(1.0 - left / variation, 0.0, 1.0) : 0.0;
}

}  // namespace moiregauge::internal
