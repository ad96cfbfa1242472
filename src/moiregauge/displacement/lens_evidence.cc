// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/lens_evidence.h"

#include <cmath>

#include <Eigen/Dense>

#include "moiregauge/planning/reference_weights.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using Eigen::Vector2d;

// Prior u of kappa, relative to the half diagonal. It fixes kappa if nothing moves. A lens with more distortion is a
// fisheye, which no homography describes. Chosen.
constexpr double kLargestDistortion = 0.05;  // relative to the half diagonal
// Least noise of the evidence, from ellipse fits and interpolation. Chosen.
constexpr double kFloorPx = 0.003;
constexpr double kGradientFloor = 3e-5;
constexpr double kProbe_mm = 4.0;  // half distance of the field's difference quotient

// Apparent displacement on the board per px of kappa that remains after the homography through the circles.
class ResidualField {
 public:
  ResidualField(const Reference& reference, const IdealFromBoard& view) : view_(view) {
    centre_ = {0.5 * (reference.width - 1), 0.5 * (reference.height - 1)};
    corner_px_ = std::hypot(centre_.x, centre_.y);
    for (const CirclePoint& p : reference.circles) {
      circles_.push_back(p.board);
      at_circles_.push_back(on_board(p.board));
    }
  }
  [[nodiscard]] Vector2d operator()(BoardPoint p) const {
    Vector2d left = on_board(p);
    const auto weights = reference_weights(circles_, p);
    for (std::size_t i = 0; i < weights.size(); ++i) left -= weights[i] * at_circles_[i];
    return left;
  }
  // Returns the derivative of the residual by the board point.
  [[nodiscard]] Matrix2 gradient(BoardPoint p) const {
    Matrix2 g;
    g.col(0) = ((*this)({p.x + kProbe_mm, p.y}) - (*this)({p.x - kProbe_mm, p.y})) / (2 * kProbe_mm);
    g.col(1) = ((*this)({p.x, p.y + kProbe_mm}) - (*this)({p.x, p.y - kProbe_mm})) / (2 * kProbe_mm);
    return g;
  }

 private:
  [[nodiscard]] Vector2d on_board(BoardPoint p) const {
    const IdealPoint seen = view_(p);
    const Vector2d r((seen.x - centre_.x) / corner_px_, (seen.y - centre_.y) / corner_px_);
    return view_.jacobian(p).inverse() * (r * r.squaredNorm());
  }
  IdealFromBoard view_;
  IdealPoint centre_;
  double corner_px_ = 1.0;
  std::vector<BoardPoint> circles_;
  std::vector<Vector2d> at_circles_;
};

// Returns the gradient of the phase field, which is along the raster's axes, as a tensor on the board.
Matrix2 board_gradient(const RasterPlan& plan, const PatchReading& patch) {
  Matrix2 g;
  g << patch.gradient[0][0], patch.gradient[0][1], patch.gradient[1][0], patch.gradient[1][1];
  const double c = std::cos(plan.angle_rad), s = std::sin(plan.angle_rad);
  const Matrix2 r = (Matrix2() << c, -s, s, c).finished();
  return r * g * r.transpose();
}

double u_patch_mm(const RasterPlan& plan, const PatchReading& patch) {
  return plan.pitch_mm / kTwoPi * std::fmax(patch.u_phase_rad[0], patch.u_phase_rad[1]);
}

// Weighted sums for kappa over one run. The reference frame's noise is the same in all differences.
class KappaFit {
 public:
  KappaFit(double prior_u, std::size_t channels) : weight_(1.0 / (prior_u * prior_u)), shared_(channels, 0.0) {}
  void add(std::size_t channel, double predicted, double observed, double u) {
    if (!std::isfinite(observed) || !std::isfinite(predicted) || !(u > 0.0)) return;
    const double w = predicted / (u * u);
    weight_ += w * predicted;
    sum_ += w * observed;
    variance_ += w * w * u * u;
    shared_[channel] += w;
  }
  [[nodiscard]] double kappa() const { return sum_ / weight_; }
  [[nodiscard]] double u(const std::vector<double>& u_shared) const {
    double variance = variance_;
    for (std::size_t c = 0; c < shared_.size(); ++c) {
      if (shared_[c] != 0.0) variance += shared_[c] * shared_[c] * u_shared[c] * u_shared[c];
    }
    return std::sqrt(variance) / weight_;
  }

 private:
  double weight_, sum_ = 0.0, variance_ = 0.0;
  std::vector<double> shared_;
};

}  // namespace

LensEvidence lens_evidence(const Reference& reference, const Observations& observations) {
  const auto& markers = reference.site.markers;
  const ResidualField then(reference, reference.seen.stage1);
  std::vector<Vector2d> then_at;
  std::vector<Matrix2> then_gradient;
  std::vector<BoardPoint> circles;
  for (const CirclePoint& p : reference.circles) circles.push_back(p.board);
  for (const Marker& m : markers) {
    const BoardPoint p = m.grating ? m.grating->centre : m.circle->centre;
    then_at.push_back(then(p));
    then_gradient.push_back(then.gradient(p));
  }
  const double corner_px = std::hypot(0.5 * (reference.width - 1), 0.5 * (reference.height - 1));
  const std::size_t per_marker = 6;  // displacement x, y; four gradients
  KappaFit fit(kLargestDistortion * corner_px, markers.size() * per_marker);
  std::vector<double> u_then(markers.size() * per_marker, 0.0);
  LensEvidence evidence;
  std::vector<std::vector<Vector2d>> predicted_all(observations.size());
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation& now = observations[n];
    evidence.sensitivity.emplace_back(markers.size());
    predicted_all[n].assign(markers.size(), Vector2d::Zero());
    if (!now.references_seen) continue;
    const ResidualField field(reference, now.stage1);
    for (std::size_t i = 0; i < markers.size(); ++i) {
      const MarkerObservation& seen = now.markers[i];
      if (!markers[i].grating || seen.loss != Loss::kNone) continue;
      const BoardPoint p = markers[i].grating->centre;
      predicted_all[n][i] = field(p) - then_at[i];
      const PatchReading& patch0 = reference.seen.markers[i].patch;
      const double floor_mm = kFloorPx * reference.view.mm_per_px(p);
      u_then[i * per_marker] = u_then[i * per_marker + 1] =
          std::hypot(u_patch_mm(reference.plans[i], patch0), floor_mm);
      if (markers[i].role == Role::kReference) {
        const auto moved = displacement_between(reference.plans[i], patch0, seen.patch);
        const double u = std::hypot(u_patch_mm(reference.plans[i], seen.patch), floor_mm);
        fit.add(i * per_marker, predicted_all[n][i].x(), moved.x, u);
        fit.add(i * per_marker + 1, predicted_all[n][i].y(), moved.y, u);
      }
      const Matrix2 expected = field.gradient(p) - then_gradient[i];
      const Matrix2 observed =
          board_gradient(reference.plans[i], seen.patch) - board_gradient(reference.plans[i], patch0);
      const double u = std::hypot(seen.patch.u_gradient, kGradientFloor);
      for (int k = 0; k < 4; ++k) {
        const std::size_t channel = i * per_marker + 2 + static_cast<std::size_t>(k);
        u_then[channel] = std::hypot(patch0.u_gradient, kGradientFloor);
        fit.add(channel, expected(k / 2, k % 2), observed(k / 2, k % 2), u);
      }
    }
    for (std::size_t t = 0; t < markers.size(); ++t) {
      if (!markers[t].grating || markers[t].role != Role::kTarget) continue;
      Vector2d e = predicted_all[n][t];
      const auto weights = reference_weights(circles, markers[t].grating->centre);
      for (std::size_t k = 0; k < circles.size(); ++k) e -= weights[k] * predicted_all[n][reference.circles[k].marker];
      evidence.sensitivity[n][t] = {e.x(), e.y()};
    }
  }
  evidence.kappa_px = fit.kappa();
  evidence.u_kappa_px = fit.u(u_then);
  for (std::size_t n = 0; n < observations.size(); ++n) {
    double sum = 0.0;
    int count = 0;
    const Observation& now = observations[n];
    for (const CirclePoint& p : reference.circles) {
      if (!now.references_seen) continue;
      const std::size_t i = p.marker;
      const MarkerObservation& seen = now.markers[i];
      if (!markers[i].grating || !seen.patch.valid || seen.loss != Loss::kNone) continue;
      const auto moved = displacement_between(reference.plans[i], reference.seen.markers[i].patch, seen.patch);
      const double u2 = std::pow(u_patch_mm(reference.plans[i], seen.patch), 2) + std::pow(u_then[i * per_marker], 2) +
                        2.0 * std::pow(p.u_px * reference.view.mm_per_px(p.board), 2);
      for (int a = 0; a < 2; ++a) {
        const double r = (a == 0 ? moved.x : moved.y) - evidence.kappa_px * predicted_all[n][i](a);
        if (!std::isfinite(r)) continue;
        sum += r * r - u2;
        ++count;
      }
    }
    evidence.unexplained_mm.push_back(count > 0 ? std::sqrt(std::fmax(0.0, sum / count)) : 0.0);
  }
  return evidence;
}

}  // namespace moiregauge::internal
