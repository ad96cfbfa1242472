// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/lattices/indexed_lattice.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "moiregauge/detection/lattices/indexing.h"

namespace moiregauge::internal {

const LatticePoint* IndexedLattice::find(int column, int row) const {
  const auto before = [](const LatticePoint& p, const std::pair<int, int>& place) {
    return std::pair(p.row, p.column) < place;
  };
  const auto it = std::lower_bound(points.begin(), points.end(), std::pair(row, column), before);
  return it != points.end() && it->row == row && it->column == column ? &*it : nullptr;
}

}  // namespace moiregauge::internal

namespace moiregauge::internal::markers_detail {
namespace {

// Smallest ratio by which another pair of axes must fill its rectangle better than the shortest steps. If the tilt
// exceeds 50 degrees, a diagonal of the board may be shorter than its step, and only the outline shows the true axes.
constexpr double kClearlyFuller = 1.3;

struct Box {
  Cell low{0, 0}, high{0, 0};
  [[nodiscard]] int columns() const { return high.column - low.column + 1; }
  [[nodiscard]] int rows() const { return high.row - low.row + 1; }
};

Cell under(const Eigen::Matrix2i& change, Cell cell) {
  const Eigen::Vector2i to = change * Eigen::Vector2i(cell.column, cell.row);
  return {to.x(), to.y()};
}

Box box_of(const GrownLattice& lattice, const Eigen::Matrix2i& change) {
  const Cell first = under(change, lattice.node_at.begin()->first);
  Box box{first, first};
  for (const auto& [cell, node] : lattice.node_at) {
    const Cell to = under(change, cell);
    box.low = {std::min(box.low.column, to.column), std::min(box.low.row, to.row)};
    box.high = {std::max(box.high.column, to.column), std::max(box.high.row, to.row)};
  }
  return box;
}

double filled(const GrownLattice& lattice, const Eigen::Matrix2i& change) {
  const Box box = box_of(lattice, change);
  return static_cast<double>(lattice.node_at.size()) / (static_cast<double>(box.columns()) * box.rows());
}

// Returns the mean steps in px between columns and between rows, after the change of indices.
Eigen::Matrix2d mean_steps(const GrownLattice& lattice, std::span<const LatticeNode> nodes,
                           const Eigen::Matrix2i& change) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (const auto& [cell, node] : lattice.node_at) {
    const Cell to = under(change, cell);
    const Eigen::Vector3d row(1.0, to.column, to.row);
    normal += row * row.transpose();
    right += row * nodes[node].at.transpose();
  }
  return normal.ldlt().solve(right).bottomRows<2>().transpose();
}

Eigen::Matrix2i fullest_axes(const GrownLattice& lattice) {
  Eigen::Matrix2i best = Eigen::Matrix2i::Identity();
  if (lattice.rule == SignRule::kAlternating) return best;  // colours alternate along the board's axes only
  double most = filled(lattice, best) * kClearlyFuller;
  for (const int shear : {1, -1}) {
    Eigen::Matrix2i along, across;
    along << 1, shear, 0, 1;
    across << 1, 0, shear, 1;
    for (const Eigen::Matrix2i& change : {along, across}) {
      if (filled(lattice, change) <= most) continue;
      most = filled(lattice, change);
      best = change;
    }
  }
  return best;
}

// Returns the change of indices that makes columns go rightwards and rows downwards, without a mirror image.
Eigen::Matrix2i upright_axes(const GrownLattice& lattice, std::span<const LatticeNode> nodes) {
  Eigen::Matrix2i change = fullest_axes(lattice);
  Eigen::Matrix2d steps = mean_steps(lattice, nodes, change);
  Eigen::Matrix2i swap, quarter;
  swap << 0, 1, 1, 0;
  quarter << 0, 1, -1, 0;
  if (steps.determinant() < 0.0) change = swap * change;
  Eigen::Matrix2i best = change;
  double rightmost = -2.0;
  for (int turn = 0; turn < 4; ++turn, change = quarter * change) {
    const Eigen::Vector2d along = mean_steps(lattice, nodes, change).col(0).normalized();
    // The margin prefers the earlier rotation: at 45 degrees the choice must not depend on rounding.
    if (along.x() <= rightmost + 1e-9) continue;
    rightmost = along.x();
    best = change;
  }
  return best;
}

double median_spacing(const IndexedLattice& lattice) {
  std::vector<double> all;
  for (const LatticePoint& p : lattice.points) {
    for (const LatticePoint* q : {lattice.find(p.column + 1, p.row), lattice.find(p.column, p.row + 1)}) {
      if (q != nullptr) all.push_back(length(q->at - p.at));
    }
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

}  // namespace

Indexing index_upright(const GrownLattice& lattice, std::span<const LatticeNode> nodes, std::span<const double> u_px) {
  const Eigen::Matrix2i change = upright_axes(lattice, nodes);
  const Box box = box_of(lattice, change);
  Indexing out;
  out.lattice.kind = lattice.rule == SignRule::kAlternating ? LatticeKind::kCheckerCorners : LatticeKind::kDots;
  out.lattice.columns = box.columns();
  out.lattice.rows = box.rows();
  std::map<std::pair<int, int>, std::size_t> by_row;
  for (const auto& [cell, node] : lattice.node_at) {
    const Cell to = under(change, cell);
    by_row[{to.row - box.low.row, to.column - box.low.column}] = node;
  }
  for (const auto& [place, node] : by_row) {
    const LatticeNode& n = nodes[node];
    out.lattice.points.push_back({place.second, place.first, {n.at.x(), n.at.y()}, u_px[node], n.size_px});
    out.node.push_back(node);
  }
  out.lattice.pitch_px = median_spacing(out.lattice);
  out.steps = mean_steps(lattice, nodes, change);
  return out;
}

}  // namespace moiregauge::internal::markers_detail
