// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>
#include <variant>

#include <Eigen/LU>

#include "moiregauge/board/seen_board.h"
#include "moiregauge/detection/gratings/grating_fit.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kLatticeReach = 1.25;  // pitches to either side of a point: window of its lattice fit; chosen
constexpr double kExplained = 0.7;      // least explained share of the grey levels around a point; chosen
constexpr double kAsMuch = 0.95;        // relative to the first point: less at the edge of the grating; chosen
constexpr double kNodeFarOff = 0.15;    // limit of the distance from the neighbour's prediction, pitches; chosen
// Rough u of a point from its own pixels, pitches. The calibration adds the scatter of all points.
constexpr double kNoise = 1e-3;
// Use all pixels: sparse ones would alias with sharp edges.
constexpr LatticeFitOptions kFit{.order = kHighestOrder, .perspective = true, .most_pixels = 10000};
using Cell = std::pair<int, int>;

struct Node {
  ImagePoint at;
  Lattice lattice;  // its origin at `at`
  double explained = 0.0;
};

Image<float> grey_of(const LumaView& luma) {
  Image<float> out(width_of(luma), height_of(luma));
  std::visit(
      [&](const auto& view) {
        for (int y = 0; y < view.height; ++y)
          std::transform(view.row(y).begin(), view.row(y).end(), out.row(y).begin(),
                         [](auto grey) { return static_cast<float>(grey); });
      },
      luma);
  return out;
}

// Returns the position of the harmonic's maximum, in periods of the harmonic.
double phase_of(const LatticeModel& model, int m, int n) {
  for (std::size_t k = 0; k < model.harmonics.size(); ++k) {
    if (model.harmonics[k] != Eigen::Vector2i(m, n)) continue;
    const auto c = static_cast<Eigen::Index>(1 + 2 * k);
    return std::atan2(model.coefficients(c + 1), model.coefficients(c)) / kTwoPi;
  }
  return 0.0;
}

bool is_inside(const Image<float>& grey, const Lattice& lattice) {
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    if (std::isnan(grey_at(grey, lattice.at({x * kLatticeReach, y * kLatticeReach})))) return false;
  }
  return true;
}

struct NodeLook {
  double tolerance = 0.5;  // pitches
  double explained = kExplained;
};

// Finds the point nearest to the expected lattice's origin at which both fundamentals have a maximum.
std::optional<Node> look_for_node(const Image<float>& grey, const Lattice& expected, const NodeLook& how) {
  if (!is_inside(grey, expected)) return std::nullopt;
  LatticeModel model;
  model.lattice = expected;
  if (!fit_lattice(grey, {{-kLatticeReach, -kLatticeReach}, {kLatticeReach, kLatticeReach}},
                   Eigen::Matrix2d::Identity(), kFit, model))
    return std::nullopt;
  if (model.explained() < how.explained) return std::nullopt;
  const Eigen::Vector2d here = model.lattice.phi(expected.origin), peak(phase_of(model, 1, 0), phase_of(model, 0, 1));
  const Eigen::Vector2d off = (peak - here).array() - (peak - here).array().round();
  if (off.cwiseAbs().maxCoeff() > how.tolerance) return std::nullopt;
  Node node;
  node.at = model.lattice.at(here + off);
  node.lattice.k = model.lattice.jacobian(node.at);
  node.lattice.origin = node.at;
  node.explained = model.explained();
  return node;
}

}  // namespace

SeenBoard grating_points(const LumaView& luma, const DetectedPatch& patch) {
  const Image<float> grey = grey_of(luma);
  Lattice middle;
  middle.origin = patch.centre;
  middle.k << patch.k_x.x, patch.k_x.y, patch.k_y.x, patch.k_y.y;
  std::map<Cell, Node> nodes;
  std::queue<Cell> fresh;
  if (const auto first = look_for_node(grey, middle, {})) {
    nodes[{0, 0}] = *first;
    fresh.push({0, 0});
  }
  for (; !fresh.empty(); fresh.pop()) {
    const Cell cell = fresh.front();
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Cell next{cell.first + dx, cell.second + dy};
      if (nodes.contains(next)) continue;
      const Node& from = nodes.at(cell);
      Lattice expected = from.lattice;
      expected.origin = from.lattice.at({dx, dy});
      // Two neighbours in line also give the change of the step.
      if (const auto before = nodes.find({cell.first - dx, cell.second - dy}); before != nodes.end())
        expected.origin = from.at + (from.at - before->second.at);
      if (auto node = look_for_node(grey, expected, {kNodeFarOff, kAsMuch * nodes.at({0, 0}).explained})) {
        nodes[next] = *node;
        fresh.push(next);
      }
    }
  }
  SeenBoard board;
  board.pattern = BoardPattern::kGrating;
  if (nodes.empty()) return board;
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  for (const auto& [cell, node] : nodes) {
    x0 = std::min(x0, cell.first), x1 = std::max(x1, cell.first);
    y0 = std::min(y0, cell.second), y1 = std::max(y1, cell.second);
  }
  board.columns = x1 - x0 + 1;
  board.rows = y1 - y0 + 1;
  for (const auto& [cell, node] : nodes) {
    const double pitch = 1.0 / std::sqrt(std::abs(node.lattice.k.determinant()));
    board.points.push_back({cell.first - x0, y1 - cell.second, node.at, kNoise * pitch, pitch});
  }
  return board;
}

}  // namespace moiregauge::internal
