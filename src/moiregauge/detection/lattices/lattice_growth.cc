// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/lattices/lattice_growth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

#include "moiregauge/detection/lattices/lattice_frontier.h"
#include "moiregauge/detection/lattices/point_grid.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::markers_detail {
namespace {

constexpr std::size_t kNeighboursTried = 12;
constexpr double kSeedSymmetry = 0.15;  // in steps, deviation from point symmetry; perspective causes 5 % per step
constexpr double kSeedReach = 0.2;      // relative to a step, deviation of the corners of the 3 x 3
constexpr double kMinSeedSine = 0.3;    // sine of the angle between the two steps
// Largest |a . b| / min(a^2, b^2) of a reduced pair of steps, with a margin for perspective. Below 0.5 adding one step
// to the other does not shorten it. With alternating signs only twice a step keeps the sign: the limit is 1.
constexpr double kReducedAlike = 0.57;
constexpr double kReducedAlternating = 1.1;
constexpr double kMaxStepRatio = 2.5;    // ratio of the two steps: a square lattice tilted by 66 degrees
constexpr double kSeedSizeRatio = 1.6;   // between points of a seed
constexpr double kGrownSizeRatio = 2.6;  // between any points: larger dots may mark a corner of the board
constexpr double kGrowthReach = 0.25;    // relative to the spacing, distance from the prediction
constexpr double kMaxSignError = 1.0;    // rad

double wrapped(double angle) { return std::remainder(angle, kTwoPi); }

class Growth {
 public:
  Growth(std::span<const LatticeNode> nodes, SignRule rule)
      : nodes_(nodes), rule_(rule), near_(points_of(nodes)), taken_(nodes.size(), false) {}

  std::vector<GrownLattice> all() {
    std::vector<GrownLattice> found;
    std::vector<bool> tried(nodes_.size(), false);  // nodes of rejected lattices: no other seed would do better
    for (std::size_t p = 0; p < nodes_.size(); ++p) {
      if (taken_[p] || tried[p]) continue;
      auto lattice = seed_at(p);
      if (!lattice) continue;
      for (const auto& [cell, node] : lattice->node_at) taken_[node] = true;
      grow(*lattice);
      const auto before = lattice->node_at;
      const bool is_kept = prune(*lattice, nodes_);
      for (const auto& [cell, node] : before) {
        taken_[node] = is_kept && lattice->node_at.contains(cell);
        tried[node] = !is_kept;
      }
      if (is_kept) found.push_back(std::move(*lattice));
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.node_at.size() > b.node_at.size(); });
    return found;
  }

 private:
  static std::vector<Eigen::Vector2d> points_of(std::span<const LatticeNode> nodes) {
    std::vector<Eigen::Vector2d> points;
    for (const LatticeNode& node : nodes) points.push_back(node.at);
    return points;
  }

  [[nodiscard]] bool fits_sign(std::size_t node, double sign_rad) const {
    return std::abs(wrapped(nodes_[node].sign_rad - sign_rad)) < kMaxSignError;
  }
  [[nodiscard]] double sign_after(double sign_rad, int steps) const {
    return rule_ == SignRule::kAlternating ? sign_rad + kPi * steps : sign_rad;
  }

  // Returns the nearest free node within `reach` px of `at` with a matching sign and size.
  [[nodiscard]] std::optional<std::size_t> node_near(const Eigen::Vector2d& at, double reach, double sign_rad,
                                                     double size_px, double size_ratio) const {
    std::optional<std::size_t> best;
    double least = reach;
    near_.visit(at, reach, [&](std::size_t i) {
      const double distance = (nodes_[i].at - at).norm();
      if (taken_[i] || distance > least || !fits_sign(i, sign_rad) ||
          !alike_sizes(nodes_[i].size_px, size_px, size_ratio))
        return;
      least = distance;
      best = i;
    });
    return best;
  }

  struct SymmetricPair {
    std::size_t ahead = 0, behind = 0;
    Eigen::Vector2d step{0, 0};
  };

  // Returns pairs of neighbours on opposite sides of a node, shortest step first.
  [[nodiscard]] std::vector<SymmetricPair> pairs_round(std::size_t p) const {
    std::vector<SymmetricPair> pairs;
    const LatticeNode& centre = nodes_[p];
    for (const std::size_t q : near_.nearest(centre.at, kNeighboursTried + 1)) {
      if (q == p || taken_[q] || !fits_sign(q, sign_after(centre.sign_rad, 1))) continue;
      if (!alike_sizes(nodes_[q].size_px, centre.size_px, kSeedSizeRatio)) continue;
      const Eigen::Vector2d step = nodes_[q].at - centre.at;
      const auto behind = node_near(centre.at - step, kSeedSymmetry * step.norm(), sign_after(centre.sign_rad, 1),
                                    centre.size_px, kSeedSizeRatio);
      if (!behind || *behind == p || *behind == q) continue;
      if (std::any_of(pairs.begin(), pairs.end(),
                      [&](const SymmetricPair& s) { return s.behind == q || s.ahead == q; }))
        continue;
      pairs.push_back({q, *behind, 0.5 * (nodes_[q].at - nodes_[*behind].at)});
    }
    return pairs;
  }

  // Returns true if no node of the same kind is between the points of the seed: the steps then skip no point.
  [[nodiscard]] bool nothing_between(std::size_t p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    Eigen::Matrix2d steps;
    steps << a, b;
    const Eigen::Matrix2d inverse = steps.inverse();
    bool empty = true;
    near_.visit(nodes_[p].at, a.norm() + b.norm(), [&](std::size_t i) {
      if (!alike_sizes(nodes_[i].size_px, nodes_[p].size_px, kSeedSizeRatio)) return;
      if (!fits_sign(i, nodes_[p].sign_rad) && !fits_sign(i, sign_after(nodes_[p].sign_rad, 1))) return;
      const Eigen::Vector2d cells = inverse * (nodes_[i].at - nodes_[p].at);
      if (cells.cwiseAbs().maxCoeff() > 1.2) return;
      const Eigen::Vector2d off = cells.array() - cells.array().round();
      if (off.cwiseAbs().maxCoeff() > 0.3) empty = false;
    });
    return empty;
  }

  [[nodiscard]] std::optional<GrownLattice> seed_at(std::size_t p) const {
    const auto pairs = pairs_round(p);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t j = i + 1; j < pairs.size(); ++j) {
        if (auto seed = seed_of(p, pairs[i], pairs[j])) return seed;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<GrownLattice> seed_of(std::size_t p, const SymmetricPair& a,
                                                    const SymmetricPair& b) const {
    const double la = a.step.norm(), lb = b.step.norm(), shorter = std::min(la, lb);
    const double sine = std::abs(a.step.x() * b.step.y() - a.step.y() * b.step.x()) / (la * lb);
    if (sine < kMinSeedSine || std::max(la, lb) > kMaxStepRatio * shorter) return std::nullopt;
    const double reduced = rule_ == SignRule::kAlike ? kReducedAlike : kReducedAlternating;
    if (std::abs(a.step.dot(b.step)) > reduced * shorter * shorter) return std::nullopt;
    if (!nothing_between(p, a.step, b.step)) return std::nullopt;
    GrownLattice out{rule_, {}};
    out.node_at = {{{0, 0}, p}, {{1, 0}, a.ahead}, {{-1, 0}, a.behind}, {{0, 1}, b.ahead}, {{0, -1}, b.behind}};
    for (const Cell cell : {Cell{1, 1}, Cell{1, -1}, Cell{-1, 1}, Cell{-1, -1}}) {
      // Each corner is predicted from the two arms next to it, so that perspective does not accumulate.
      const Eigen::Vector2d at =
          nodes_[out.node_at[{cell.column, 0}]].at + nodes_[out.node_at[{0, cell.row}]].at - nodes_[p].at;
      const auto node = node_near(at, kSeedReach * shorter, nodes_[p].sign_rad, nodes_[p].size_px, kSeedSizeRatio);
      if (!node) return std::nullopt;
      out.node_at[cell] = *node;
    }
    return out;
  }

  // Adds cells with the most neighbours first, so that no row grows ahead of the adjacent ones.
  void grow(GrownLattice& lattice) {
    LatticeFrontier frontier(lattice, kAffineReach);
    for (bool grown = true; grown;) {
      grown = false;
      for (const int support : {5, 3, 2}) {
        for (const Cell cell : frontier.cells(support)) {
          if (!frontier.take_change(cell)) continue;
          const auto there = predict(lattice, nodes_, cell, LocalModel::kAffine);
          if (!there) continue;
          const auto node =
              node_near(there->at, kGrowthReach * there->spacing_px, there->sign_rad, there->size_px, kGrownSizeRatio);
          if (!node) continue;
          lattice.node_at[cell] = *node;
          frontier.add(lattice, cell);
          taken_[*node] = true;
          grown = true;
        }
        if (grown) break;
      }
    }
  }

  std::span<const LatticeNode> nodes_;
  SignRule rule_;
  NearPoints near_;
  std::vector<bool> taken_;
};

}  // namespace

std::vector<GrownLattice> grow_lattices(std::span<const LatticeNode> nodes, SignRule rule) {
  return nodes.size() < kMinLatticePoints ? std::vector<GrownLattice>{} : Growth(nodes, rule).all();
}

void fill_in(GrownLattice& lattice, std::vector<LatticeNode>& nodes, const Look& look) {
  LatticeFrontier frontier(lattice, kQuadraticReach);
  for (bool added = true; added;) {
    added = false;
    for (const Cell cell : frontier.cells(3)) {
      if (!frontier.take_change(cell)) continue;
      const auto there = predict(lattice, nodes, cell, LocalModel::kQuadratic);
      if (!there) continue;
      const auto seen = look(*there);
      if (!seen) continue;
      lattice.node_at[cell] = nodes.size();
      nodes.push_back(*seen);
      frontier.add(lattice, cell);
      added = true;
    }
  }
}

}  // namespace moiregauge::internal::markers_detail
