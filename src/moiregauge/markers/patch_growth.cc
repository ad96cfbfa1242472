// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/markers/patch_growth.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace moiregauge {
namespace {

constexpr double kCore = 1.1;        // fundamental periods each way from the seed: a print of three, the seed a bit aside
constexpr double kStranger = 0.6;    // rms misfit of a strip, in the pattern's own rms, that is no longer the print
constexpr double kStretch = 1.4;     // growth between two fits: so far an affine lattice tells where to look
constexpr double kFinestHarmonic_px = 2.2;
constexpr double kInset_px = 3.0;
constexpr double kMostInStrip = 64.0;  // points that judge a strip
constexpr int kMostRounds = 14;

int order_for(const Lattice& lattice) {
  const double finest = std::max(lattice.k.row(0).norm(), lattice.k.row(1).norm());
  return std::clamp(static_cast<int>(1.0 / (finest * kFinestHarmonic_px)), 1, 3);
}

double explained(const LatticeModel& model) {
  const double signal = model.sigma * model.sigma, rest = model.residual * model.residual;
  return signal / (signal + rest);
}

// The product of square waves has harmonic (1, 1) of its fundamentals' size; on a checkerboard, whose fundamentals lie on
// the diagonals, it vanishes and (2, 1) does not.
bool is_checkerboard(const LatticeModel& model) {
  const double first = 0.5 * (model.amplitude(1, 0) + model.amplitude(0, 1));
  const double diagonal = std::max(model.amplitude(1, 1), model.amplitude(1, -1));
  const double next = std::max(model.amplitude(2, 1), model.amplitude(2, -1));
  return diagonal < 0.15 * first && next > 0.06 * first && next > diagonal;
}

bool is_cosine(const LatticeModel& model) {
  const double first = std::max(model.amplitude(1, 0), model.amplitude(0, 1));
  for (const Eigen::Vector2i& h : model.harmonics) {
    if (h.cwiseAbs().maxCoeff() > 1 && model.amplitude(h.x(), h.y()) > 0.05 * first) return false;
  }
  return order_for(model.lattice) > 2;
}

// Turns the print's axes so that x is the one nearest to the picture's horizontal, rightwards, and y goes up.
Eigen::Matrix2d oriented(const Eigen::Matrix2d& to_phi, const Lattice& lattice) {
  Eigen::Matrix2d out = to_phi;
  const Eigen::Matrix2d k = to_phi.inverse() * lattice.k;
  const auto level = [&](int row) { return std::abs(k(row, 0)) / k.row(row).norm(); };
  const int x = level(0) >= level(1) ? 0 : 1;
  out.col(0) = (k(x, 0) > 0.0 ? 1.0 : -1.0) * to_phi.col(x);
  out.col(1) = (k(1 - x, 1) < 0.0 ? 1.0 : -1.0) * to_phi.col(1 - x);
  return out;
}

void name_pattern(GrownPatch& patch) {
  const LatticeModel& model = patch.model;
  patch.to_phi = Eigen::Matrix2d::Identity();
  patch.pattern = Pattern::kAuto;
  if (!model.lattice.lines && is_checkerboard(model)) {
    patch.pattern = Pattern::kCheckerboard;
    patch.to_phi << 1, 1, 1, -1;
  } else if (!model.lattice.lines && is_cosine(model)) {
    patch.pattern = Pattern::kCosine;
  }
  patch.to_phi = oriented(patch.to_phi, model.lattice);
  if (model.lattice.lines) patch.pattern = std::abs(patch.to_phi(0, 0)) > 0.5 ? Pattern::kLinesX : Pattern::kLinesY;
}

// The strip at `edge` pitches along `axis`, one pixel wide and as long as the box: is it still the print?
bool belongs(const Image<float>& grey, const GrownPatch& patch, int axis, double edge) {
  const int other = 1 - axis;
  const double from = patch.box.low[other], to = patch.box.high[other];
  const double px = (to - from) / (patch.to_phi.inverse() * patch.model.lattice.k).row(other).norm();
  const double step = 1.0 / std::clamp(px, 8.0, kMostInStrip);
  double squares = 0.0;
  int count = 0;
  for (double t = 0.5 * step; t < 1.0; t += step) {
    Eigen::Vector2d s;
    s[axis] = edge;
    s[other] = from + t * (to - from);
    const Eigen::Vector2d phi = patch.to_phi * s;
    const double seen = grey_at(grey, patch.model.lattice.at(phi));
    if (std::isnan(seen)) return false;
    squares += std::pow(seen - patch.model.grey(phi), 2);
    ++count;
  }
  return std::sqrt(squares / count) < kStranger * patch.model.sigma;
}

// Moves every side outwards by pixels until the next two strips are strange or the box has grown by kStretch.
bool grow(const Image<float>& grey, GrownPatch& patch) {
  const Eigen::Vector2d start = patch.box.high - patch.box.low;
  const Eigen::Matrix2d k = patch.to_phi.inverse() * patch.model.lattice.k;
  std::array<bool, 4> stopped{};
  bool any = false;
  while (!(stopped[0] && stopped[1] && stopped[2] && stopped[3])) {
    for (std::size_t side = 0; side < 4; ++side) {
      if (stopped[side]) continue;
      const int axis = side < 2 ? 0 : 1;
      const bool high = side % 2 == 1;
      double& edge = high ? patch.box.high[axis] : patch.box.low[axis];
      const double step = (high ? 1.0 : -1.0) * k.row(axis).norm();
      const bool next = belongs(grey, patch, axis, edge + step);
      if (next || belongs(grey, patch, axis, edge + 2.0 * step)) {
        edge += step;
        any = true;
      } else {
        stopped[side] = true;
      }
      if (patch.box.high[axis] - patch.box.low[axis] > kStretch * start[axis]) stopped[side] = true;
    }
  }
  return any;
}

// Two periods of one print under any usable perspective: neither far apart nor nearly parallel, and on the pixels' scale.
bool is_sound(const GrownPatch& patch) {
  const Eigen::Matrix2d& k = patch.model.lattice.k;
  const double first = k.row(0).norm(), second = k.row(1).norm();
  return k.allFinite() && first < 0.5 && second < 0.5 && first < 2.5 * second && second < 2.5 * first &&
         std::abs(k.determinant()) > 0.5 * first * second && patch.model.lattice.q.norm() < 0.3 * first;
}

bool fit(const Image<float>& grey, GrownPatch& patch, bool perspective, int most = 3) {
  const int order = std::min(most, order_for(patch.model.lattice));
  // The outermost pixels may be the paper's: they would pull at the lattice.
  PhiBox inside = patch.box;
  const Eigen::Matrix2d k = patch.to_phi.inverse() * patch.model.lattice.k;
  for (int axis = 0; axis < 2; ++axis) {
    inside.low[axis] += kInset_px * k.row(axis).norm();
    inside.high[axis] -= kInset_px * k.row(axis).norm();
  }
  return fit_lattice(grey, inside, patch.to_phi, order, perspective, patch.model) && is_sound(patch);
}

}  // namespace

std::optional<GrownPatch> grow_patch(const Image<float>& grey, const LatticeSeed& seed, const GrowthLimits& limits) {
  GrownPatch patch;
  Lattice& lattice = patch.model.lattice;
  lattice.origin = seed.centre;
  lattice.lines = seed.k2.isZero();
  lattice.k.row(0) = seed.k1.transpose();
  lattice.k.row(1) = lattice.lines ? Eigen::RowVector2d(-seed.k1.y(), seed.k1.x()) : Eigen::RowVector2d(seed.k2.transpose());
  patch.box = {{-kCore, -kCore}, {kCore, kCore}};
  // The fundamentals alone find the lattice from farther away; the whole series then makes it sharp.
  if (!fit(grey, patch, false, 1) || explained(patch.model) < 0.4) return std::nullopt;
  if (!fit(grey, patch, false) || explained(patch.model) < limits.min_explained) return std::nullopt;
  if ((lattice.k.row(0).transpose() - seed.k1).norm() > 0.3 * seed.k1.norm()) return std::nullopt;
  name_pattern(patch);
  // The core in the print's own axes: inside the diamond of the diagonals when those are the fundamentals'.
  const double core = patch.pattern == Pattern::kCheckerboard ? 0.5 * kCore : kCore;
  patch.box = {{-core, -core}, {core, core}};
  for (int round = 0; round < kMostRounds; ++round) {
    const GrownPatch before = patch;
    if (!grow(grey, patch)) break;
    const bool large = (patch.box.high - patch.box.low).minCoeff() > 4.0;
    if (fit(grey, patch, large) && explained(patch.model) >= limits.min_explained) continue;
    patch = before;  // beyond this a lattice on a plane no longer follows the print
    break;
  }
  if ((patch.box.high - patch.box.low).minCoeff() < limits.min_periods) return std::nullopt;
  if (patch.model.sigma < limits.min_sigma) return std::nullopt;
  return patch;
}

}  // namespace moiregauge
