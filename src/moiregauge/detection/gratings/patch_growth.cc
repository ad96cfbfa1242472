// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/detection/gratings/patch_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace moiregauge::internal {
namespace {

constexpr double kCore = 1.1;      // fundamental periods each way from the seed: fits a grating of three periods
constexpr double kCore_px = 8.0;   // px, smallest half width of the core: the effective window of the seed's tile
constexpr double kStranger = 0.6;  // smallest rms residual of a strip off the grating, relative to the pattern (chosen)
constexpr double kStretch = 1.4;   // growth of one side between two fits: the lattice extrapolates no farther (chosen)
constexpr double kCarefulStretch = 1.1;       // the same after a fit that failed (chosen)
constexpr double kMaxBack = 0.5;              // pitches, largest inward move of a side
constexpr double kFinestHarmonic_px = 2.2;    // px, shortest period of a harmonic that pixels can resolve
constexpr double kMaxInStrip = 64.0;          // points per strip
constexpr int kMaxRounds = 16;                // each may double the box: enough for any image
constexpr std::size_t kSeedPixels = 600;      // enough to decide whether a seed is a lattice
constexpr std::size_t kGrowingPixels = 1600;  // enough to place the next strip
constexpr std::size_t kFinalPixels = 20000;   // all pixels of most markers: then the finest harmonics cancel
// Second harmonic of thin lines, relative to the first: cos(pi d) for lines of share d of the pitch, 0.5 at a third.
constexpr double kMinSecondOfThin = 0.4;
// Harmonic (1, 1) of thin lines, relative to the first: 0.18 for a share of 0.16, 0.41 at a third. Dots have more.
constexpr double kMaxDiagonalOfThin = 0.5;
// Share of the variance that a growing lattice of smoothed thin lines must explain, relative to that of its core. In a
// large box uneven ink and curved light leave up to a quarter (tools/ink-study); a wrong lattice leaves more than half.
constexpr double kThinExplained = 0.8;
constexpr double kMinThinPeriods = 4.0;  // along both axes: smoothing makes chance patterns of fewer look periodic

int order_for(const Lattice& lattice) {
  const double finest = std::max(lattice.k.row(0).norm(), lattice.k.row(1).norm());
  return std::clamp(static_cast<int>(1.0 / (finest * kFinestHarmonic_px)), 1, kHighestOrder);
}

// Returns true for crossed lines thinner than a third of the pitch. Their harmonics (2, 0) and (0, 2) are nearly as
// large as the fundamentals; a checkerboard has none.
bool has_thin_lines(const LatticeModel& model) {
  const double x = model.amplitude(1, 0), y = model.amplitude(0, 1);
  return !model.lattice.lines && model.amplitude(2, 0) > kMinSecondOfThin * x &&
         model.amplitude(0, 2) > kMinSecondOfThin * y &&
         std::max(model.amplitude(1, 1), model.amplitude(1, -1)) < kMaxDiagonalOfThin * std::max(x, y);
}

// kYes if the fundamentals are the diagonals of a checkerboard. There the harmonic (1, 1) vanishes and (2, 1) does not.
// A product of square waves has a (1, 1) of 0.6 times its fundamentals. A crossed cosine has neither, nor has a
// checkerboard too fine for the pixels to resolve its (2, 1): kUnclear.
enum class Diagonal { kNo, kYes, kUnclear };

Diagonal is_checkerboard(const LatticeModel& model) {
  if (model.lattice.lines || has_thin_lines(model)) return Diagonal::kNo;
  const double first = 0.5 * (model.amplitude(1, 0) + model.amplitude(0, 1));
  const double diagonal = std::max(model.amplitude(1, 1), model.amplitude(1, -1));
  const double next = std::max(model.amplitude(2, 1), model.amplitude(2, -1));
  if (diagonal > 0.15 * first) return Diagonal::kNo;
  return next > 0.06 * first && next > diagonal ? Diagonal::kYes : Diagonal::kUnclear;
}

bool is_cosine(const LatticeModel& model) {
  const double first = std::max(model.amplitude(1, 0), model.amplitude(0, 1));
  for (const Eigen::Vector2i& h : model.harmonics) {
    if (h.cwiseAbs().maxCoeff() > 1 && model.amplitude(h.x(), h.y()) > 0.05 * first) return false;
  }
  return order_for(model.lattice) > 2 && (model.lattice.lines || is_checkerboard(model) == Diagonal::kUnclear);
}

// Orders and signs the grating's axes: x is nearest to the image's horizontal and points right, y points up.
Eigen::Matrix2d oriented(const Eigen::Matrix2d& to_phi, const Lattice& lattice) {
  Eigen::Matrix2d out = to_phi;
  const Eigen::Matrix2d k = to_phi.inverse() * lattice.k;
  const auto level = [&](int row) { return std::abs(k(row, 0)) / k.row(row).norm(); };
  const int x = level(0) >= level(1) ? 0 : 1;
  out.col(0) = (k(x, 0) > 0.0 ? 1.0 : -1.0) * to_phi.col(x);
  out.col(1) = (k(1 - x, 1) < 0.0 ? 1.0 : -1.0) * to_phi.col(1 - x);
  return out;
}

Eigen::Matrix2d print_axes(const Lattice& lattice, bool diagonal) {
  Eigen::Matrix2d to_phi = Eigen::Matrix2d::Identity();
  if (diagonal) to_phi << 1, 1, 1, -1;
  return oriented(to_phi, lattice);
}

Pattern pattern_of(const LatticeModel& model, const Eigen::Matrix2d& to_phi, bool diagonal) {
  if (model.lattice.lines) return std::abs(to_phi(0, 0)) > 0.5 ? Pattern::kLinesX : Pattern::kLinesY;
  if (diagonal) return Pattern::kCheckerboard;
  return is_cosine(model) ? Pattern::kCosine : Pattern::kAuto;
}

// Returns the pitches per px along the grating's axes.
Eigen::Matrix2d per_px(const GrownPatch& patch) { return patch.to_phi.inverse() * patch.model.lattice.k; }

Eigen::Vector2d extent_of_box(const GrownPatch& patch) { return patch.box.high - patch.box.low; }

double area_px(const GrownPatch& patch) { return extent_of_box(patch).prod() / std::abs(per_px(patch).determinant()); }

// Moves the origin of the lattice to the middle of its box, for a well-conditioned fit.
void recentre(GrownPatch& patch) {
  Lattice& l = patch.model.lattice;
  const Eigen::Vector2d middle = 0.5 * (patch.box.low + patch.box.high), phi = patch.to_phi * middle;
  const ImagePoint to = l.at(phi);
  const double w = 1.0 + l.q.dot(Eigen::Vector2d(to.x - l.origin.x, to.y - l.origin.y));
  l.k = (l.k - phi * l.q.transpose()) / w;
  l.q /= w;
  l.origin = to;
  patch.box.low -= middle;
  patch.box.high -= middle;
}

// Returns true if the lattice may be a grating in a usable perspective. The periods exceed 2 px and differ by less than
// a factor of 2.5, and the axes are not nearly parallel.
bool is_sound(const GrownPatch& patch) {
  const Eigen::Matrix2d& k = patch.model.lattice.k;
  const double first = k.row(0).norm(), second = k.row(1).norm();
  return k.allFinite() && first < 0.5 && second < 0.5 && first < 2.5 * second && second < 2.5 * first &&
         std::abs(k.determinant()) > 0.5 * first * second && patch.model.lattice.q.norm() < 0.3 * first;
}

bool fit_patch(const Image<float>& grey, GrownPatch& patch, std::size_t most_pixels = kGrowingPixels) {
  recentre(patch);
  const LatticeFitOptions options{order_for(patch.model.lattice), true, most_pixels};
  return fit_lattice(grey, patch.box, patch.to_phi, options, patch.model) && is_sound(patch);
}

// A moving side of the box. Along it, grey = base + slope t + gain * (series without mean), with t from 0 to 1. The
// three parameters follow light that changes over the grating. They are learned from the last pitch inside the side.
class Side {
 public:
  Side(const Image<float>& grey, const GrownPatch& patch, int axis, bool high)
      : grey_(grey), patch_(patch), axis_(axis), sign_(high ? 1.0 : -1.0), along_(1 - axis) {
    const Eigen::Matrix2d k = per_px(patch);
    step_ = sign_ * k.row(axis).norm();
    const double px = extent_of_box(patch)[along_] / k.row(along_).norm();
    points_ = static_cast<int>(std::clamp(px, 8.0, kMaxInStrip));
  }
  [[nodiscard]] double step() const { return step_; }
  void learn_light(double edge) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    constexpr int kStrips = 12;
    for (int strip = 0; strip < kStrips; ++strip) {
      walk(edge - sign_ * (strip + 0.5) / kStrips, [&](double t, double model, double seen) {
        const Eigen::Vector3d row(1.0, t, model);
        normal += row * row.transpose();
        right += seen * row;
      });
    }
    const Eigen::Vector3d light = normal.ldlt().solve(right);
    const bool sane = light.allFinite() && light[2] > 0.3 && light[2] < 3.0;
    light_ = sane ? light : Eigen::Vector3d(patch_.model.coefficients[0], 0.0, 1.0);
  }
  // Returns true if the strip at `edge` pitches (as long as the box) is inside the image and matches the model.
  [[nodiscard]] bool belongs(double edge) const {
    double squares = 0.0;
    int count = 0;
    walk(edge, [&](double t, double model, double seen) {
      squares += std::pow(seen - light_.dot(Eigen::Vector3d(1.0, t, model)), 2);
      ++count;
    });
    return count == points_ && std::sqrt(squares / count) < kStranger * light_[2] * patch_.model.sigma;
  }

 private:
  // Calls visit(t, series without mean, grey level) for the strip's points inside the image.
  template <typename Visit>
  void walk(double edge, Visit visit) const {
    for (int i = 0; i < points_; ++i) {
      const double t = (i + 0.5) / points_;
      Eigen::Vector2d s;
      s[axis_] = edge;
      s[along_] = patch_.box.low[along_] + t * extent_of_box(patch_)[along_];
      const Eigen::Vector2d phi = patch_.to_phi * s;
      const double seen = grey_at(grey_, patch_.model.lattice.at(phi));
      if (!std::isnan(seen)) visit(t, patch_.model.grey(phi) - patch_.model.coefficients[0], seen);
    }
  }

  const Image<float>& grey_;
  const GrownPatch& patch_;
  int axis_;
  double sign_;
  int along_;
  double step_ = 0.0;
  int points_ = 0;
  Eigen::Vector3d light_{0, 0, 1};
};

bool is_taken(const GrownPatch& patch, const GrowthLimits& limits) {
  if (!limits.taken) return false;
  for (int i = 0; i < 9; ++i) {
    const int column = i % 3, row = i / 3;
    const Eigen::Vector2d t(0.5 * column, 0.5 * row);
    if (limits.taken(patch.model.lattice.at(patch.to_phi * (patch.box.low + t.cwiseProduct(extent_of_box(patch))))))
      return true;
  }
  return false;
}

// Moves one side outwards by steps of 1 px until two successive strips do not match or the box has grown by `stretch`.
// Moves it inwards, by kMaxBack at most, if the core around a seed near the edge reaches beyond the grating.
// Returns true if the side moved.
bool grow_side(const Image<float>& grey, GrownPatch& patch, int axis, bool high, double stretch) {
  double& edge = high ? patch.box.high[axis] : patch.box.low[axis];
  const double start = edge, most = (stretch - 1.0) * extent_of_box(patch)[axis];
  Side side(grey, patch, axis, high);
  side.learn_light(edge);
  while (std::abs(edge - start) < kMaxBack && !side.belongs(edge) && !side.belongs(edge - side.step()))
    edge -= side.step();
  if (edge != start) return true;
  double learnt = edge;
  while (std::abs(edge - start) < most) {
    if (!side.belongs(edge + side.step()) && !side.belongs(edge + 2.0 * side.step())) break;
    edge += side.step();
    if (std::abs(edge - learnt) > 0.5) {
      learnt = edge;
      side.learn_light(edge);
    }
  }
  return edge != start;
}

bool grow(const Image<float>& grey, GrownPatch& patch, double stretch) {
  bool any = false;
  for (int side = 0; side < 4; ++side) any |= grow_side(grey, patch, side / 2, side % 2 == 1, stretch);
  return any;
}

// Grows the core with the grating's axes along the fundamentals or along their diagonals.
Grown grown(const Image<float>& grey, GrownPatch patch, bool diagonal, const GrowthLimits& limits) {
  // A box along the diagonals must be inside the core: half its size in pitches.
  if (diagonal) patch.box = {0.5 * patch.box.low, 0.5 * patch.box.high};
  patch.to_phi = print_axes(patch.model.lattice, diagonal);
  double stretch = kStretch;
  for (int round = 0; round < kMaxRounds; ++round) {
    const GrownPatch before = patch;
    if (!grow(grey, patch, stretch)) break;
    if (is_taken(patch, limits)) return {Growth::kTaken, patch};
    if (fit_patch(grey, patch) && patch.model.explained() >= limits.min_explained) continue;
    // Either the lattice extrapolated too far for the fit to converge, or the larger box is not on a plane.
    patch = before;
    if (stretch < kStretch) break;
    stretch = kCarefulStretch;
  }
  if (extent_of_box(patch).minCoeff() < limits.min_periods || patch.model.sigma < limits.min_sigma)
    return {Growth::kTooSmall, patch};
  const GrownPatch before = patch;
  if (!fit_patch(grey, patch, kFinalPixels)) patch = before;
  patch.pattern = pattern_of(patch.model, patch.to_phi, diagonal);
  return {Growth::kPatch, patch};
}

// Returns a box of a few periods around the seed.
GrownPatch core_at(const LatticeSeed& seed) {
  GrownPatch core;
  Lattice& lattice = core.model.lattice;
  lattice.origin = seed.centre;
  lattice.lines = seed.k2.isZero();
  lattice.k.row(0) = seed.k1.transpose();
  lattice.k.row(1) =
      lattice.lines ? Eigen::RowVector2d(-seed.k1.y(), seed.k1.x()) : Eigen::RowVector2d(seed.k2.transpose());
  const Eigen::Vector2d half = (kCore_px * lattice.k.rowwise().norm()).cwiseMax(kCore);
  core.box = {-half, half};
  return core;
}

bool has_moved(const GrownPatch& patch, const LatticeSeed& seed) {
  return (patch.model.lattice.k.row(0).transpose() - seed.k1).norm() > 0.3 * seed.k1.norm();
}

}  // namespace

Grown grow_patch(const Image<float>& grey, const LatticeSeed& seed, const GrowthLimits& limits) {
  GrownPatch core = core_at(seed);
  // A fit of the fundamentals alone converges from farther away. The whole series then refines it.
  if (!fit_lattice(grey, core.box, core.to_phi, {1, false, kSeedPixels}, core.model) || !is_sound(core)) return {};
  if (!fit_patch(grey, core) || core.model.explained() < limits.min_explained) return {};
  if (has_moved(core, seed)) return {};
  if (is_taken(core, limits)) return {Growth::kTaken, core};
  const Diagonal diagonal = is_checkerboard(core.model);
  if (diagonal != Diagonal::kUnclear) return grown(grey, core, diagonal == Diagonal::kYes, limits);
  // Sheets are cut along the grating's axes, so the rectangle along the true axes is the larger one.
  const Grown straight = grown(grey, core, false, limits), turned = grown(grey, core, true, limits);
  if (straight.outcome != Growth::kPatch || turned.outcome != Growth::kPatch)
    return turned.outcome == Growth::kPatch ? turned : straight;
  return area_px(turned.patch) > area_px(straight.patch) ? turned : straight;
}

Grown grow_thin_lines(const Image<float>& grey, const SmoothedPicture& smoothed_for, const LatticeSeed& seed,
                      const GrowthLimits& limits) {
  GrownPatch core = core_at(seed);
  if (!fit_lattice(grey, core.box, core.to_phi, {1, false, kSeedPixels}, core.model) || !is_sound(core)) return {};
  if (!fit_patch(grey, core) || !has_thin_lines(core.model) || has_moved(core, seed)) return {};
  if (is_taken(core, limits)) return {Growth::kTaken, core};
  const Image<float>& smoothed = smoothed_for(1.0 / core.model.lattice.k.row(0).norm());
  if (!fit_patch(smoothed, core) || core.model.explained() < limits.min_explained || has_moved(core, seed)) return {};
  GrowthLimits thin = limits;
  thin.min_periods = std::max(limits.min_periods, kMinThinPeriods);
  thin.min_explained = kThinExplained * limits.min_explained;
  thin.min_sigma = 0.0;  // smoothing lowers the modulation; the limit is applied to `grey` below
  Grown out = grown(smoothed, core, false, thin);
  if (out.outcome != Growth::kPatch) return out;
  if (!fit_patch(grey, out.patch, kFinalPixels) || !has_thin_lines(out.patch.model)) return {};
  if (out.patch.model.sigma < limits.min_sigma) out.outcome = Growth::kTooSmall;
  out.patch.pattern = pattern_of(out.patch.model, out.patch.to_phi, false);
  return out;
}

}  // namespace moiregauge::internal
