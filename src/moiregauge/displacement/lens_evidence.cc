// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/lens_evidence.h"

#include <cmath>

#include <Eigen/Dense>

#include "moiregauge/displacement/reading_noise.h"
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

// Displacement x and y, then four gradients, of each marker.
constexpr std::size_t kPerMarker = 6;
constexpr std::size_t channel_of(std::size_t marker, std::size_t k) { return marker * kPerMarker + k; }

// Evidence of one run, built frame by frame.
class EvidenceOfRun {
 public:
  EvidenceOfRun(const Reference& reference, const Observations& observations, double excess)
      : reference_(reference),
        observations_(observations),
        excess_(excess),
        markers_(reference.site.markers),
        fit_(kLargestDistortion * std::hypot(0.5 * (reference.width - 1), 0.5 * (reference.height - 1)),
             markers_.size() * kPerMarker),
        u_then_(markers_.size() * kPerMarker, 0.0),
        predicted_(observations.size(), std::vector<Vector2d>(markers_.size(), Vector2d::Zero())) {
    const ResidualField then(reference, reference.seen.stage1);
    for (const CirclePoint& p : reference.circles) circles_.push_back(p.board);
    for (const Marker& m : markers_) {
      const BoardPoint p = m.grating ? m.grating->centre : m.circle->centre;
      then_at_.push_back(then(p));
      then_gradient_.push_back(then.gradient(p));
    }
  }

  LensEvidence evidence() {
    LensEvidence out;
    for (std::size_t n = 0; n < observations_.size(); ++n) {
      out.sensitivity.emplace_back(markers_.size());
      const Observation now = with_noise(observations_[n], excess_);
      if (!now.references_seen) continue;
      add_frame(n, now);
      for (std::size_t t = 0; t < markers_.size(); ++t) {
        if (markers_[t].grating && markers_[t].role == Role::kTarget) out.sensitivity[n][t] = sensitivity(n, t);
      }
    }
    out.kappa_px = fit_.kappa();
    out.u_kappa_px = fit_.u(u_then_);
    for (std::size_t n = 0; n < observations_.size(); ++n) out.unexplained_mm.push_back(unexplained(n, out.kappa_px));
    return out;
  }

 private:
  void add_frame(std::size_t n, const Observation& now) {
    const ResidualField field(reference_, now.stage1);
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      const MarkerObservation& seen = now.markers[i];
      if (markers_[i].grating && seen.loss == Loss::kNone) add_marker(n, i, field, seen);
    }
  }

  void add_marker(std::size_t n, std::size_t i, const ResidualField& field, const MarkerObservation& seen) {
    const BoardPoint p = markers_[i].grating->centre;
    predicted_[n][i] = field(p) - then_at_[i];
    const RasterPlan& plan = reference_.plans[i];
    const PatchReading& then = reference_.seen.markers[i].patch;
    const double floor_mm = kFloorPx * reference_.view.mm_per_px(p);
    u_then_[channel_of(i, 0)] = u_then_[channel_of(i, 1)] = std::hypot(u_patch_mm(plan, then), floor_mm);
    if (markers_[i].role == Role::kReference) {
      const auto moved = displacement_between(plan, then, seen.patch);
      const double u = std::hypot(u_patch_mm(plan, seen.patch), floor_mm);
      fit_.add(channel_of(i, 0), predicted_[n][i].x(), moved.x, u);
      fit_.add(channel_of(i, 1), predicted_[n][i].y(), moved.y, u);
    }
    const Matrix2 expected = field.gradient(p) - then_gradient_[i];
    const Matrix2 observed = board_gradient(plan, seen.patch) - board_gradient(plan, then);
    const double u = std::hypot(seen.patch.u_gradient, kGradientFloor);
    for (int k = 0; k < 4; ++k) {
      const std::size_t channel = channel_of(i, 2 + static_cast<std::size_t>(k));
      u_then_[channel] = std::hypot(then.u_gradient, kGradientFloor);
      fit_.add(channel, expected(k / 2, k % 2), observed(k / 2, k % 2), u);
    }
  }

  // Returns the error of target `t` per unit of distortion: its own residual less that of the references' homography.
  [[nodiscard]] Extent<frame::Board> sensitivity(std::size_t n, std::size_t t) const {
    Vector2d e = predicted_[n][t];
    const auto weights = reference_weights(circles_, markers_[t].grating->centre);
    for (std::size_t k = 0; k < circles_.size(); ++k) e -= weights[k] * predicted_[n][reference_.circles[k].marker];
    return {e.x(), e.y()};
  }

  // Returns the rms displacement of the references that neither the lens nor noise explains, mm.
  [[nodiscard]] double unexplained(std::size_t n, double kappa_px) const {
    double sum = 0.0;
    int count = 0;
    const Observation now = with_noise(observations_[n], excess_);
    for (const CirclePoint& p : reference_.circles) {
      if (!now.references_seen) continue;
      const std::size_t i = p.marker;
      const MarkerObservation& seen = now.markers[i];
      if (!markers_[i].grating || !seen.patch.valid || seen.loss != Loss::kNone) continue;
      const RasterPlan& plan = reference_.plans[i];
      const auto moved = displacement_between(plan, reference_.seen.markers[i].patch, seen.patch);
      const double u2 = std::pow(u_patch_mm(plan, seen.patch), 2) + std::pow(u_then_[channel_of(i, 0)], 2) +
                        2.0 * std::pow(p.u_px * reference_.view.mm_per_px(p.board), 2);
      for (int a = 0; a < 2; ++a) {
        const double r = (a == 0 ? moved.x : moved.y) - kappa_px * predicted_[n][i](a);
        if (!std::isfinite(r)) continue;
        sum += r * r - u2;
        ++count;
      }
    }
    return count > 0 ? std::sqrt(std::fmax(0.0, sum / count)) : 0.0;
  }

  const Reference& reference_;
  const Observations& observations_;
  double excess_;
  const std::vector<Marker>& markers_;
  std::vector<BoardPoint> circles_;
  std::vector<Vector2d> then_at_;
  std::vector<Matrix2> then_gradient_;
  KappaFit fit_;
  std::vector<double> u_then_;
  std::vector<std::vector<Vector2d>> predicted_;  // by frame and marker, mm per unit of distortion
};

}  // namespace

LensEvidence lens_evidence(const Reference& reference, const Observations& observations, double excess) {
  return EvidenceOfRun(reference, observations, excess).evidence();
}

}  // namespace moiregauge::internal
