// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/zeroed_samples.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/results/derived/channel_values.h"

namespace moiregauge::internal {
namespace {

using Eigen::Index;
using Eigen::RowVectorXd;
using Axis = double Extent<frame::Board>::*;

// Mean of one coordinate of a target over the frames of the zero, with its errors.
struct Zero {
  Eigen::VectorXd weight;  // one per row
  double value = 0.0, noise = 0.0, bounded = 0.0, bounded_noise = 0.0;
  RowVectorXd loadings;
};

std::optional<Zero> zero_of(const ChannelSeries& series, const FrameRange& range) {
  Zero zero;
  zero.weight = Eigen::VectorXd::Zero(series.size());
  for (Index n = 0; n < series.size(); ++n)
    zero.weight(n) = range.holds(series.frame[static_cast<std::size_t>(n)]) && series.is_ok(n) ? 1.0 : 0.0;
  if (zero.weight.sum() == 0.0) return std::nullopt;
  zero.weight /= zero.weight.sum();
  zero.loadings = RowVectorXd::Zero(series.loadings.cols());
  for (Index n = 0; n < series.size(); ++n) {
    const double w = zero.weight(n);
    if (w == 0.0) continue;
    zero.value += w * series.value(n);
    zero.noise += w * w * series.noise(n);
    zero.bounded += w * series.bounded(n);
    zero.bounded_noise += w * w * series.bounded(n) * series.bounded(n);
    zero.loadings += w * series.loadings.row(n);
  }
  return zero;
}

// Variances of one value minus the zero.
struct ZeroedVariance {
  double noise = 0.0, bounded = 0.0, shared = 0.0;
  double scene_share = 0.0;  // factor of the scene's u
  [[nodiscard]] double sum() const { return noise + bounded + shared; }
};

// The row's own noise is also in the mean if the row is.
ZeroedVariance variance_of(const ChannelSeries& series, const Zero& zero, Index n, Index constant) {
  const double own = 1.0 - 2.0 * zero.weight(n), b = series.bounded(n), off = b - zero.bounded;
  const RowVectorXd loadings = series.loadings.row(n) - zero.loadings;
  ZeroedVariance out;
  out.noise = std::max(0.0, own * series.noise(n) + zero.noise);
  out.bounded = std::max({0.0, own * b * b + zero.bounded_noise, off * off});
  out.shared = loadings.squaredNorm();
  const Index varying = loadings.size() - constant;
  const double before = series.loadings.row(n).tail(varying).norm();
  out.scene_share = before > 0.0 ? loadings.tail(varying).norm() / before : 0.0;
  return out;
}

// Divides the variance among the parts, so that their squares sum up to it.
void divide(const ZeroedVariance& variance, double own, Axis axis, Budget& budget) {
  for (const auto part : {&Budget::noise, &Budget::references}) (budget.*part).*axis *= std::sqrt(std::max(0.0, own));
  for (const auto part : {&Budget::lens, &Budget::geometry, &Budget::axis, &Budget::print_scale})
    (budget.*part).*axis *= variance.scene_share;
  budget.reference_frame.*axis = 0.0;
  double sum = 0.0;
  for (const BudgetPart& part : kBudgetParts) sum += (budget.*part.value).*axis * ((budget.*part.value).*axis);
  if (sum <= variance.sum()) {
    budget.reference_frame.*axis = std::sqrt(variance.sum() - sum);
    return;
  }
  for (const BudgetPart& part : kBudgetParts) (budget.*part.value).*axis *= std::sqrt(variance.sum() / sum);
}

// Returns false if the target has no ok row in the range.
bool subtract_along(const JointErrors& joint, const FrameRange& range, std::size_t target, TermKind kind,
                    Samples& samples) {
  const Axis axis = kind == TermKind::kDx ? &Extent<frame::Board>::x : &Extent<frame::Board>::y;
  const Channel channel{"zero", "mm", {{kind, {target}, 1.0}}, 0.0, {}};
  const ChannelSeries series = *channel_values(channel, samples, joint);  // one target needs no line
  // An axis that the grating does not show has no values and no zero.
  if (!series.value.array().isFinite().any()) return true;
  const auto zero = zero_of(series, range);
  const Index frames = series.size();
  const bool shows_only_reference = (series.value.array().isFinite()).count() == 1;
  if (!zero) return shows_only_reference;
  for (Index n = 0; n < frames; ++n) {
    Sample& sample = samples[static_cast<std::size_t>(n) * joint.targets.size() + target];
    if (std::isnan(series.value(n))) continue;
    const ZeroedVariance variance = variance_of(series, *zero, n, joint.constant.cols());
    sample.displacement.*axis -= zero->value;
    sample.u.*axis = std::sqrt(variance.sum());
    divide(variance, 1.0 - 2.0 * zero->weight(n), axis, sample.budget);
  }
  return true;
}

}  // namespace

std::optional<std::size_t> subtract_zero(const JointErrors& joint, const FrameRange& zero, Samples& samples) {
  for (std::size_t target = 0; target < joint.targets.size(); ++target) {
    for (const TermKind kind : {TermKind::kDx, TermKind::kDy}) {
      if (!subtract_along(joint, zero, target, kind, samples)) return joint.targets[target];
    }
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
