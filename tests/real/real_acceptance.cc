// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "real/real_lattices.h"

namespace moiregauge::internal::test {
namespace {

struct Expected {
  ImagePoint at;
  double spacing_px = 0.0;
};

// Returns the middle between neighbours on opposite sides, which requires neither the dot nor a model of the view.
std::optional<Expected> expected_at(const IndexedLattice& lattice, int column, int row) {
  std::optional<Expected> best;
  double least = 1e9;
  for (const auto& [c, r] : {Place{1, 0}, Place{0, 1}, Place{1, 1}, Place{1, -1}}) {
    const LatticePoint* a = lattice.find(column - c, row - r);
    const LatticePoint* b = lattice.find(column + c, row + r);
    if (a == nullptr || b == nullptr) continue;
    const double apart = 0.5 * length(b->at - a->at);
    if (apart >= least) continue;
    least = apart;
    best = Expected{{0.5 * (a->at.x + b->at.x), 0.5 * (a->at.y + b->at.y)}, apart};
  }
  return best;
}

bool circle_near(const CircleSearch& circles, ImagePoint at, double reach_px, double least_px, double most_px) {
  return std::any_of(circles.circles.begin(), circles.circles.end(), [&](const DetectedCircle& c) {
    return length(c.centre - at) < reach_px && c.diameter_px > least_px && c.diameter_px < most_px;
  });
}

}  // namespace

Acceptance dots_accepted(const std::vector<LatticeView>& views) {
  Acceptance out;
  std::vector<double> sizes;
  for (const LatticeView& view : views) {
    if (view.lattices.empty()) continue;
    const IndexedLattice& lattice = view.lattices.front();
    std::vector<double> of_view;
    for (const LatticePoint& p : lattice.points) of_view.push_back(p.size_px);
    std::nth_element(of_view.begin(), of_view.begin() + static_cast<std::ptrdiff_t>(of_view.size() / 2), of_view.end());
    const double size = of_view[of_view.size() / 2];
    for (int row = 0; row < lattice.rows; ++row) {
      for (int column = 0; column < lattice.columns; ++column) {
        const auto expected = expected_at(lattice, column, row);
        if (!expected) continue;
        ++out.there;
        sizes.push_back(size);
        out.accepted +=
            circle_near(view.circles, expected->at, 0.15 * expected->spacing_px, 0.7 * size, 1.4 * size) ? 1 : 0;
      }
    }
  }
  if (sizes.empty()) return out;
  std::sort(sizes.begin(), sizes.end());
  out.median_diameter_px = sizes[sizes.size() / 2];
  return out;
}

Acceptance squares_accepted(const std::vector<LatticeView>& views) {
  Acceptance out;
  for (const LatticeView& view : views) {
    if (view.lattices.empty()) continue;
    const IndexedLattice& lattice = view.lattices.front();
    for (const LatticePoint& p : lattice.points) {
      const std::array<const LatticePoint*, 3> others{
          lattice.find(p.column + 1, p.row), lattice.find(p.column, p.row + 1), lattice.find(p.column + 1, p.row + 1)};
      if (std::any_of(others.begin(), others.end(), [](const LatticePoint* q) { return q == nullptr; })) continue;
      ImagePoint centre{0.25 * p.at.x, 0.25 * p.at.y};
      for (const LatticePoint* q : others) centre = {centre.x + 0.25 * q->at.x, centre.y + 0.25 * q->at.y};
      ++out.there;
      out.accepted += circle_near(view.circles, centre, 0.25 * p.size_px, 0.5 * p.size_px, 1.6 * p.size_px) ? 1 : 0;
      out.median_diameter_px = lattice.pitch_px;
    }
  }
  return out;
}

}  // namespace moiregauge::internal::test
