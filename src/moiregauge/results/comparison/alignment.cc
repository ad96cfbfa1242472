// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "moiregauge/results/comparison/long_run_covariance.h"
#include "moiregauge/results/comparison/paired_records.h"

namespace moiregauge::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Order of the unknowns. The rate is last, so that a fit without it has one column less.
enum Unknown : Index { kBias, kSlope, kOffset, kRate, kUnknowns };

constexpr int kGaussNewtonSteps = 8;         // Gauss-Newton, in one part of the record
constexpr double kScannedSteps = 1.5;        // first offsets to try, steps to either side
constexpr int kScanParts = 8;                // per step
constexpr std::size_t kFirstPoints = 64;     // least points of the first part
constexpr double kMaxDrift = 3.0;            // steps by which a part may move the offset from its start
constexpr double kMinAlignmentPivot = 1e-9;  // least pivot of the scaled equations; below, an unknown is not determined
constexpr double kSignificantRate = 4.0;     // u by which a rate differs from 0

struct FitState {
  TimeMap map;
  double bias = 0.0, slope = 1.0;
  bool has_rate = false;
};

// Equations of one part: A step = -b, with A = Z' W J and b = Z' W e.
struct FitEquations {
  MatrixXd instruments, jacobian;
  VectorXd error, weight;
};

VectorXd errors_of(const Pairs& at, const FitState& state, double mean_reference) {
  VectorXd error(at.size());
  for (Index k = 0; k < at.size(); ++k) {
    const AlignedPair& pair = at.pairs[static_cast<std::size_t>(k)];
    error(k) = pair.measured - mean_reference - state.bias - state.slope * (pair.reference - mean_reference);
  }
  return error;
}

double mean_reference(const Pairs& at) {
  double sum = 0.0;
  for (const AlignedPair& pair : at.pairs) sum += pair.reference;
  return sum / static_cast<double>(std::max<std::size_t>(1, at.pairs.size()));
}

// Weights are 1 / (noise of the row + what the residuals have beyond the mean noise), at most four times the mean.
VectorXd weights_of(const Pairs& at, const VectorXd& noise, const VectorXd& error) {
  VectorXd variance(at.size());
  for (Index k = 0; k < at.size(); ++k) variance(k) = noise(at.pairs[static_cast<std::size_t>(k)].row);
  const double all = error.squaredNorm() / static_cast<double>(at.size());
  const double floor = std::max(all - variance.mean(), 0.25 * all);
  if (!(floor > 0.0)) return VectorXd::Ones(at.size());
  return (all / (variance.array() + floor)).matrix();
}

FitEquations equations_of(const Pairs& at, const FitState& state, bool is_channel_interpolated, const VectorXd& noise) {
  FitEquations out;
  const double mean = mean_reference(at);
  out.error = errors_of(at, state, mean);
  out.weight = weights_of(at, noise, out.error);
  out.instruments.resize(at.size(), kUnknowns);
  out.jacobian.resize(at.size(), kUnknowns);
  // The measured value is m(t) with dt/d offset = -1 / (1 + rate), or the reference is r(tau) with dtau/d offset = 1.
  const double by_offset = is_channel_interpolated ? -1.0 / (1.0 + state.map.rate) : -state.slope;
  for (Index k = 0; k < at.size(); ++k) {
    const AlignedPair& pair = at.pairs[static_cast<std::size_t>(k)];
    const double since = pair.time_s - state.map.middle_s;
    out.instruments.row(k) << 1.0, at.neighbour_mean(k), at.neighbour_slope(k), at.neighbour_slope(k) * since;
    out.jacobian.row(k) << -1.0, mean - pair.reference, by_offset * at.by_offset(k),
        by_offset * at.by_offset(k) * since;
  }
  return out;
}

// Returns the inverse of Z' W J of the first `unknowns`; nothing if the movement does not determine them.
std::optional<MatrixXd> inverse_of(const FitEquations& equations, Index unknowns) {
  const MatrixXd z = equations.weight.asDiagonal() * equations.instruments.leftCols(unknowns);
  const MatrixXd a = z.transpose() * equations.jacobian.leftCols(unknowns);
  VectorXd left(unknowns), right(unknowns);
  for (Index i = 0; i < unknowns; ++i) {
    left(i) = z.col(i).norm();
    right(i) = equations.jacobian.col(i).norm();
    if (!(left(i) > 0.0) || !(right(i) > 0.0)) return std::nullopt;
  }
  const MatrixXd scaled = left.cwiseInverse().asDiagonal() * a * right.cwiseInverse().asDiagonal();
  const Eigen::FullPivLU<MatrixXd> lu(scaled);
  if (!(std::abs(lu.matrixLU().diagonal().cwiseAbs().minCoeff()) > kMinAlignmentPivot)) return std::nullopt;
  return right.cwiseInverse().asDiagonal() * lu.inverse() * left.cwiseInverse().asDiagonal();
}

VectorXd step_of(const FitEquations& equations, const MatrixXd& inverse) {
  const Index unknowns = inverse.rows();
  return -inverse *
         (equations.instruments.leftCols(unknowns).transpose() * equations.weight.cwiseProduct(equations.error));
}

// Covariance of the unknowns from the residuals. In a short record few rows decide it, and by chance it can be far too
// small. The variances are therefore at least those of residuals that are alike in all rows.
MatrixXd covariance_of(const FitEquations& equations, const MatrixXd& inverse) {
  const Index unknowns = inverse.rows(), n = equations.error.size();
  const MatrixXd z = equations.weight.asDiagonal() * equations.instruments.leftCols(unknowns);
  const MatrixXd moments = equations.error.asDiagonal() * z;
  const double lost = static_cast<double>(n) / static_cast<double>(n - unknowns);
  MatrixXd covariance = lost * inverse * long_run_covariance(moments, equations.error) * inverse.transpose();
  const double variance = lost * equations.error.squaredNorm() / static_cast<double>(n);
  const MatrixXd by_rows = inverse * z.transpose();
  for (Index i = 0; i < unknowns; ++i)
    covariance(i, i) = std::max(covariance(i, i), variance * by_rows.row(i).squaredNorm());
  return covariance;
}

class AlignmentFit {
 public:
  AlignmentFit(const ChannelSeries& channel, const Series& measured, const Series& reference, double step_s)
      : channel_(channel), records_(measured, reference), noise_(channel.noise), step_s_(step_s) {
    noise_ += channel.bounded.cwiseAbs2();
  }

  tl::expected<Alignment, std::string> fit(double offset_s);

 private:
  [[nodiscard]] Pairs pairs(const FitState& state) const { return records_.at(state.map, first_, last_); }
  void choose_part(const Pairs& all, std::size_t points);
  void scan(FitState& state) const;
  [[nodiscard]] bool iterate(FitState& state, Index unknowns) const;
  [[nodiscard]] bool refine(FitState& state) const;
  [[nodiscard]] Alignment result(const FitState& state) const;
  void put_estimates(const FitState& state, const FitEquations& equations, Alignment& out) const;

  const ChannelSeries& channel_;
  PairedRecords records_;
  VectorXd noise_;
  double step_s_;
  std::size_t first_ = 0, last_ = 0;  // points of the slower record in the present part
  std::vector<double> energy_;        // sum of squared slopes up to each pair of the whole record
};

// Chooses a part of the record around the middle of its movement.
void AlignmentFit::choose_part(const Pairs& all, std::size_t points) {
  const double half = 0.5 * all.neighbour_slope.squaredNorm();
  double sum = 0.0;
  Index k = 0;
  while (k + 1 < all.size() && sum < half) sum += std::pow(all.neighbour_slope(k++), 2.0);
  const std::size_t count = records_.points();
  const double share = static_cast<double>(k) / static_cast<double>(std::max<Index>(1, all.size()));
  const auto centre = static_cast<std::size_t>(share * static_cast<double>(count));
  const std::size_t length = std::min(points, count);
  first_ = std::min(centre > length / 2 ? centre - length / 2 : 0, count - length);
  last_ = first_ + length;
}

// Tries offsets around the start and keeps the one with the largest correlation.
void AlignmentFit::scan(FitState& state) const {
  const double start = state.map.offset_s;
  double best = -1.0;
  FitState kept = state;
  for (int i = static_cast<int>(-kScannedSteps * kScanParts); i <= static_cast<int>(kScannedSteps * kScanParts); ++i) {
    FitState trial = state;
    trial.map.offset_s = start + step_s_ * i / kScanParts;
    const Pairs at = pairs(trial);
    if (at.pairs.size() < kMinPairs) continue;
    double m = 0.0, r = 0.0, mm = 0.0, rr = 0.0, mr = 0.0;
    const double mean = mean_reference(at), n = static_cast<double>(at.size());
    for (const AlignedPair& pair : at.pairs) {
      const double x = pair.measured - at.pairs.front().measured, y = pair.reference - mean;
      m += x, r += y, mm += x * x, rr += y * y, mr += x * y;
    }
    const double correlation = (mr - m * r / n) / std::sqrt((mm - m * m / n) * (rr - r * r / n));
    if (!(correlation > best)) continue;
    best = correlation;
    kept = trial;
    kept.slope = (mr - m * r / n) / (rr - r * r / n);
  }
  state = kept;
}

bool AlignmentFit::iterate(FitState& state, Index unknowns) const {
  for (int i = 0; i < kGaussNewtonSteps; ++i) {
    const Pairs at = pairs(state);
    if (at.pairs.size() < kMinPairs) return false;
    const FitEquations equations = equations_of(at, state, records_.is_channel_interpolated(), noise_);
    const auto inverse = inverse_of(equations, unknowns);
    if (!inverse) return false;
    const VectorXd step = step_of(equations, *inverse);
    state.bias += step(kBias);
    state.slope += step(kSlope);
    state.map.offset_s += std::clamp(step(kOffset), -step_s_, step_s_);
    if (unknowns > kRate) state.map.rate += std::clamp(step(kRate), -0.1, 0.1);
  }
  return std::isfinite(state.map.offset_s) && std::isfinite(state.slope);
}

// Fits one part of the record, with the rate if this part determines it.
bool AlignmentFit::refine(FitState& state) const {
  const FitState start = state;
  FitState with_rate = state;
  if (!iterate(state, kRate)) return false;
  if (std::abs(state.map.offset_s - start.map.offset_s) > kMaxDrift * step_s_) return false;
  with_rate = state;
  if (!iterate(with_rate, kUnknowns)) return true;
  const FitEquations equations = equations_of(pairs(with_rate), with_rate, records_.is_channel_interpolated(), noise_);
  const auto inverse = inverse_of(equations, kUnknowns);
  if (!inverse) return true;
  const double u = std::sqrt(std::max(0.0, covariance_of(equations, *inverse)(kRate, kRate)));
  const bool is_determined = u < kMaxRateU || std::abs(with_rate.map.rate) > kSignificantRate * u;
  with_rate.has_rate = true;
  if (is_determined && std::abs(with_rate.map.offset_s - start.map.offset_s) <= kMaxDrift * step_s_) state = with_rate;
  return true;
}

void AlignmentFit::put_estimates(const FitState& state, const FitEquations& equations, Alignment& out) const {
  const auto inverse = inverse_of(equations, state.has_rate ? kUnknowns : kRate);
  if (!inverse) return;
  const MatrixXd covariance = covariance_of(equations, *inverse);
  MatrixXd shared(equations.error.size(), channel_.loadings.cols());
  for (Index k = 0; k < shared.rows(); ++k)
    shared.row(k) = channel_.loadings.row(out.pairs[static_cast<std::size_t>(k)].row);
  const MatrixXd z = equations.weight.asDiagonal() * equations.instruments.leftCols(inverse->rows());
  const MatrixXd moved = *inverse * (z.transpose() * shared);
  // A rate that is fixed at 0 has an error, which moves the other unknowns.
  const VectorXd by_rate = *inverse * (z.transpose() * equations.jacobian.col(kRate));
  const double u_rate = state.has_rate ? 0.0 : kFixedRateU;
  const std::array<std::pair<Estimate*, Index>, 4> all{
      {{&out.bias, kBias}, {&out.slope, kSlope}, {&out.offset_s, kOffset}, {&out.rate, kRate}}};
  for (const auto& [estimate, i] : all) {
    if (i >= covariance.rows()) continue;
    estimate->u = std::hypot(std::sqrt(std::max(0.0, covariance(i, i))), u_rate * by_rate(i));
    estimate->u_channel = moved.row(i).norm();
  }
}

Alignment AlignmentFit::result(const FitState& state) const {
  Alignment out;
  Pairs at = pairs(state);
  const FitEquations equations = equations_of(at, state, records_.is_channel_interpolated(), noise_);
  out.pairs = std::move(at.pairs);
  out.middle_s = state.map.middle_s;
  out.has_rate = state.has_rate;
  out.is_channel_interpolated = records_.is_channel_interpolated();
  out.offset_s.value = state.map.offset_s;
  out.rate.value = state.map.rate;
  out.slope.value = state.slope;
  out.bias.value = state.bias;
  out.residual_rms = std::sqrt(equations.error.squaredNorm() / static_cast<double>(equations.error.size()));
  out.residual_autocorrelation = first_autocorrelation(equations.error);
  put_estimates(state, equations, out);
  return out;
}

tl::expected<Alignment, std::string> AlignmentFit::fit(double offset_s) {
  const auto none = [](const char* why) { return tl::unexpected(std::string(why)); };
  FitState state;
  state.map.offset_s = offset_s;
  last_ = records_.points();
  const Pairs all = pairs(state);
  if (all.pairs.size() < kMinPairs) return none("the two records have too few rows in common");
  state.map.middle_s = 0.5 * (all.pairs.front().time_s + all.pairs.back().time_s);
  std::size_t points = std::max(kFirstPoints, records_.points() / 64);
  for (bool has_fit = false;; points *= 2) {
    choose_part(all, points);
    FitState trial = state;
    if (!has_fit) scan(trial);
    const bool is_fitted = refine(trial), is_whole = points >= records_.points();
    if (is_fitted) state = trial;
    has_fit |= is_fitted;
    if (is_whole && is_fitted) return result(state);
    if (is_whole) return none("the movement does not determine the time offset");
  }
}

}  // namespace

Series ok_series(const ChannelSeries& channel) {
  Series series;
  for (Index n = 0; n < channel.size(); ++n) {
    series.time_s.push_back(channel.time_s[static_cast<std::size_t>(n)]);
    series.value.push_back(channel.is_ok(n) ? channel.value(n) : kNotMeasured);
  }
  return series;
}

tl::expected<Alignment, std::string> fit_alignment(const ChannelSeries& channel, const Series& reference,
                                                   double offset_s, double step_s) {
  return AlignmentFit(channel, ok_series(channel), reference, step_s).fit(offset_s);
}

}  // namespace moiregauge::internal
