// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "moiregauge/detection/lattices/lattice_growth.h"
#include "moiregauge/geometry/symmetric_eigen.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr int kWindowReach = kAffineReach;   // cells: a window of 5 x 5
constexpr int kWideReach = kQuadraticReach;  // cells: a window of 7 x 7
constexpr double kMinSpread = 0.12;          // cells^2, smallest variance of the points along any direction
constexpr std::size_t kMinQuadratic = 8;     // points; the quadratic has 6 parameters
constexpr std::size_t kAmple = 12;           // points; with fewer (at corners, among gaps) the wide window is used

struct Known {
  Eigen::Vector2d offset;  // cells
  Eigen::Vector2d at;      // px
  double weight = 0.0;
  std::size_t node = 0;
};

// Fits px as a polynomial in cells. The rows of the result are the coefficients of 1, x, y and, with 6 terms, x^2, x y,
// y^2.
template <int Terms>
Eigen::Matrix<double, Terms, 2> fit_terms(const std::vector<Known>& known) {
  Eigen::Matrix<double, Terms, Terms> normal = Eigen::Matrix<double, Terms, Terms>::Zero();
  Eigen::Matrix<double, Terms, 2> right = Eigen::Matrix<double, Terms, 2>::Zero();
  for (const Known& k : known) {
    Eigen::Matrix<double, Terms, 1> row;
    const double x = k.offset.x(), y = k.offset.y();
    const std::array<double, 6> terms{1.0, x, y, x * x, x * y, y * y};
    for (int i = 0; i < Terms; ++i) row[i] = terms[static_cast<std::size_t>(i)];
    normal += k.weight * row * row.transpose();
    right += k.weight * row * k.at.transpose();
  }
  return normal.ldlt().solve(right);
}

bool spreads_both_ways(const std::vector<Known>& known) {
  Eigen::Vector2d mean{0, 0};
  for (const Known& k : known) mean += k.offset / static_cast<double>(known.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Known& k : known) {
    spread += (k.offset - mean) * (k.offset - mean).transpose() / static_cast<double>(known.size());
  }
  return eigen_of(spread).values[0] > kMinSpread;
}

// Returns true if the points determine a quadratic: at least kMinQuadratic of them, in three columns and three rows.
bool holds_quadratic(const std::vector<Known>& known) {
  if (known.size() < kMinQuadratic) return false;
  std::array<bool, 2 * kWideReach + 1> columns{}, rows{};
  for (const Known& k : known) {
    columns[static_cast<std::size_t>(std::lround(k.offset.x()) + kWideReach)] = true;
    rows[static_cast<std::size_t>(std::lround(k.offset.y()) + kWideReach)] = true;
  }
  return std::count(columns.begin(), columns.end(), true) >= 3 && std::count(rows.begin(), rows.end(), true) >= 3;
}

std::vector<Known> known_round(const GrownLattice& lattice, std::span<const LatticeNode> nodes, Cell cell, int reach) {
  std::vector<Known> known;
  for (int dr = -reach; dr <= reach; ++dr) {
    for (int dc = -reach; dc <= reach; ++dc) {
      if (dr == 0 && dc == 0) continue;
      const auto it = lattice.node_at.find({cell.column + dc, cell.row + dr});
      if (it == lattice.node_at.end()) continue;
      known.push_back({Eigen::Vector2d(dc, dr), nodes[it->second].at, 1.0 / (dc * dc + dr * dr), it->second});
    }
  }
  return known;
}

}  // namespace

std::optional<CellPrediction> predict(const GrownLattice& lattice, std::span<const LatticeNode> nodes, Cell cell,
                                      LocalModel model) {
  auto known = known_round(lattice, nodes, cell, kWindowReach);
  if (model == LocalModel::kQuadratic && known.size() < kAmple) known = known_round(lattice, nodes, cell, kWideReach);
  CellPrediction out;
  double most = 0.0;
  for (const Known& k : known) {
    if (k.offset.cwiseAbs().maxCoeff() < 1.5) ++out.neighbours;
    if (k.weight <= most) continue;
    most = k.weight;
    out.nearest = k.node;
    const double steps = lattice.rule == SignRule::kAlternating ? k.offset.sum() : 0.0;
    out.sign_rad = nodes[k.node].sign_rad + kPi * steps;
  }
  if (known.size() < 3 || !spreads_both_ways(known)) return std::nullopt;
  const auto affine = fit_terms<3>(known);
  out.at = affine.row(0).transpose();
  out.step.col(0) = affine.row(1).transpose();
  out.step.col(1) = affine.row(2).transpose();
  if (model == LocalModel::kQuadratic && holds_quadratic(known)) {
    const auto quadratic = fit_terms<6>(known);
    if (quadratic.allFinite()) out.at = quadratic.row(0).transpose();
  }
  out.spacing_px = std::min(out.step.col(0).norm(), out.step.col(1).norm());
  std::vector<double> sizes;
  sizes.reserve(known.size());
  for (const Known& k : known) sizes.push_back(nodes[k.node].size_px);
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  out.size_px = *middle;
  return out;
}

}  // namespace moiregauge::internal::markers_detail
