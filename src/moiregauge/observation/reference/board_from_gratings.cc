// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/board_from_gratings.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr int kPasses = 30;
// Prior of the perspective terms over the gratings' part of the image, k = 1: practically free. Chosen.
constexpr double kPriorTilt = 1.0;
constexpr double kReading = 1e-3;  // u of a local pitch (k = 1), relative; chosen

// Wave vectors (pitches per ideal px) at one point of the image.
struct LocalLattice {
  IdealPoint at;
  Eigen::Matrix2d k;
  bool reads_x = true, reads_y = true;
};

LocalLattice local(ImagePoint at, ImageExtent k_x, ImageExtent k_y, const Camera& lens, Pattern pattern) {
  LocalLattice out{{at.x, at.y}, Eigen::Matrix2d::Zero(), pattern != Pattern::kLinesY, pattern != Pattern::kLinesX};
  out.k << k_x.x, k_x.y, k_y.x, k_y.y;
  if (lens.is_distortion_free()) return out;
  out.at = lens.undistort(at);
  // d image / d ideal, by differences over a pixel in both directions.
  const ImagePoint right = lens.distort({out.at.x + 1, out.at.y}), left = lens.distort({out.at.x - 1, out.at.y});
  const ImagePoint below = lens.distort({out.at.x, out.at.y + 1}), above = lens.distort({out.at.x, out.at.y - 1});
  Eigen::Matrix2d j;
  j << right.x - left.x, below.x - above.x, right.y - left.y, below.y - above.y;
  out.k = out.k * (0.5 * j);
  return out;
}

// Fewer than three gratings do not show the perspective by their positions. Their corners do.
std::vector<LocalLattice> lattices(std::span<const DetectedPatch> patches, const Camera& lens) {
  std::vector<LocalLattice> out;
  for (const DetectedPatch& p : patches) {
    if (patches.size() >= 3) {
      out.push_back(local(p.centre, p.k_x, p.k_y, lens, p.pattern));
      continue;
    }
    for (std::size_t i = 0; i < 4; ++i)
      out.push_back(local(p.outline[i], p.k_corners[i][0], p.k_corners[i][1], lens, p.pattern));
  }
  return out;
}

// Unknowns: the 2 x 2 part in mm per unit length of the image, then the perspective terms per unit length.
using Unknowns = Eigen::Matrix<double, 6, 1>;

struct Normalised {
  IdealPoint centre;
  double unit = 1.0;  // px
};

BoardFromIdeal map_of(const Unknowns& u, const Normalised& n) {
  Matrix3 h, t;
  h << u[0], u[1], 0, u[2], u[3], 0, u[4], u[5], 1;
  t << 1 / n.unit, 0, -n.centre.x / n.unit, 0, 1 / n.unit, -n.centre.y / n.unit, 0, 0, 1;
  return BoardFromIdeal(h * t);
}

Eigen::VectorXd misfit(const std::vector<LocalLattice>& seen, const Unknowns& u, const Normalised& n, double pitch_mm) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * seen.size() + 2));
  const BoardFromIdeal board = map_of(u, n);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    // This matrix is orthonormal for the right map.
    const Eigen::Matrix2d k = seen[i].k * board.jacobian(seen[i].at).inverse() * pitch_mm;
    const auto at = static_cast<Eigen::Index>(3 * i);
    if (seen[i].reads_x) out[at] = (k.row(0).norm() - 1.0) / kReading;
    if (seen[i].reads_y) out[at + 1] = (k.row(1).norm() - 1.0) / kReading;
    if (seen[i].reads_x && seen[i].reads_y) out[at + 2] = k.row(0).dot(k.row(1)) / kReading;
  }
  out[out.size() - 2] = u[4] / kPriorTilt;
  out[out.size() - 1] = u[5] / kPriorTilt;
  return out;
}

Eigen::MatrixXd slopes(const std::vector<LocalLattice>& seen, const Unknowns& u, const Normalised& n, double pitch_mm) {
  const double size = u.head<4>().norm();
  Eigen::MatrixXd j(static_cast<Eigen::Index>(3 * seen.size() + 2), 6);
  for (int c = 0; c < 6; ++c) {
    Unknowns more = u, less = u;
    const double h = 1e-6 * (c < 4 ? size : 1.0);
    more[c] += h;
    less[c] -= h;
    j.col(c) = (misfit(seen, more, n, pitch_mm) - misfit(seen, less, n, pitch_mm)) / (2.0 * h);
  }
  return j;
}

}  // namespace

BoardFromIdeal board_from_gratings(std::span<const DetectedPatch> patches, const Camera& lens, double pitch_mm) {
  const std::vector<LocalLattice> seen = lattices(patches, lens);
  Normalised n;
  const auto share = 1.0 / static_cast<double>(seen.size());
  for (const LocalLattice& l : seen) n.centre = {n.centre.x + share * l.at.x, n.centre.y + share * l.at.y};
  for (const LocalLattice& l : seen) n.unit = std::max(n.unit, length(l.at - n.centre));
  Unknowns u = Unknowns::Zero();
  const Eigen::Matrix2d start = pitch_mm * n.unit * seen.front().k;
  u.head<4>() << start(0, 0), start(0, 1), start(1, 0), start(1, 1);
  double damping = 1e-3;
  double cost = misfit(seen, u, n, pitch_mm).squaredNorm();
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::MatrixXd j = slopes(seen, u, n, pitch_mm);
    Eigen::Matrix<double, 6, 6> normal = j.transpose() * j;
    // A rotation of the board changes no pitch, so only the damping determines it.
    const double floor = 1e-9 * normal.diagonal().maxCoeff();
    normal.diagonal() += damping * normal.diagonal();
    normal.diagonal().array() += floor;
    const Unknowns next = u - normal.ldlt().solve(j.transpose() * misfit(seen, u, n, pitch_mm));
    const double then = misfit(seen, next, n, pitch_mm).squaredNorm();
    if (std::isfinite(then) && then <= cost) {
      u = next;
      cost = then;
      damping *= 0.2;
    } else {
      damping *= 10.0;
    }
  }
  return map_of(u, n);
}

double pitch_on(const DetectedPatch& patch, const BoardFromIdeal& board, const Camera& lens) {
  const LocalLattice at = local(patch.centre, patch.k_x, patch.k_y, lens, patch.pattern);
  const Eigen::Matrix2d k = at.k * board.jacobian(at.at).inverse();
  if (!at.reads_y) return 1.0 / k.row(0).norm();
  if (!at.reads_x) return 1.0 / k.row(1).norm();
  return 1.0 / std::sqrt(k.row(0).norm() * k.row(1).norm());
}

double print_angle(const DetectedPatch& patch, const BoardFromIdeal& board, const Camera& lens) {
  const LocalLattice at = local(patch.centre, patch.k_x, patch.k_y, lens, patch.pattern);
  const Eigen::Matrix2d k = at.k * board.jacobian(at.at).inverse();
  // Crossed gratings have two readings of this angle.
  const double by_x = std::atan2(k(0, 1), k(0, 0)), by_y = std::atan2(-k(1, 0), k(1, 1));
  const double angle = !at.reads_y ? by_x : !at.reads_x ? by_y : by_x + 0.5 * std::remainder(by_y - by_x, kTwoPi);
  return std::remainder(angle, 0.5 * kPi);
}

BoardFromIdeal turned(const BoardFromIdeal& board, double angle_rad, BoardPoint origin) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Matrix3 turn, shift;
  turn << c, s, 0, -s, c, 0, 0, 0, 1;
  shift << 1, 0, -origin.x, 0, 1, -origin.y, 0, 0, 1;
  return BoardFromIdeal(turn * shift * board.matrix());
}

}  // namespace moiregauge::internal
