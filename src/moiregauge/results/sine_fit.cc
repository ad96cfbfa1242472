// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/sine_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

namespace moiregauge::internal {
namespace {

constexpr int kSinePasses = 10;      // Gauss-Newton steps at most; chosen
constexpr double kConverged = 1e-7;  // rad, over the whole duration
constexpr double kFurthest = 2.0;    // largest change of frequency from the start, in 1 / duration; chosen
constexpr int kLinear = 4;
constexpr int kAll = 6;  // with omega and lambda

using Row = std::array<double, kAll>;

// Normal equations of `size` columns, accumulated sample by sample.
struct Normal {
  std::array<Row, kAll> square{};
  Row right{};
  double square_sum = 0.0;

  void add(const Row& row, int size, double value) {
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j <= i; ++j) square[i][j] += row[i] * row[j];
      right[i] += row[i] * value;
    }
    square_sum += value * value;
  }
  // Scale the columns to length 1 first: c and d tau differ by the duration.
  [[nodiscard]] std::optional<Eigen::VectorXd> solve(int size, Eigen::MatrixXd* inverse = nullptr) const {
    Eigen::MatrixXd m(size, size);
    Eigen::VectorXd r(size), scale(size);
    for (int i = 0; i < size; ++i) {
      if (!(square[i][i] > 0.0)) return std::nullopt;
      scale[i] = 1.0 / std::sqrt(square[i][i]);
    }
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j <= i; ++j) m(i, j) = m(j, i) = square[i][j] * scale[i] * scale[j];
      r[i] = right[i] * scale[i];
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(m);
    if (factor.info() != Eigen::Success) return std::nullopt;
    if (inverse != nullptr)
      *inverse = scale.asDiagonal() * Eigen::MatrixXd(factor.solve(Eigen::MatrixXd::Identity(size, size))) *
                 scale.asDiagonal();
    return Eigen::VectorXd(scale.cwiseProduct(factor.solve(r)));
  }
};

struct Wave {
  double cosine, sine;  // both decaying
};

Wave wave(const SineFit& fit, double tau) {
  const double e = fit.lambda == 0.0 ? 1.0 : std::exp(-fit.lambda * tau);
  return {e * std::cos(fit.omega * tau), e * std::sin(fit.omega * tau)};
}

bool solve_linear(const TimedValues& samples, SineFit& fit) {
  Normal normal;
  for (std::size_t k = 0; k < samples.value.size(); ++k) {
    const double tau = samples.time_s[k] - fit.origin_s;
    const Wave w = wave(fit, tau);
    normal.add({w.cosine, w.sine, 1.0, tau}, kLinear, samples.value[k]);
  }
  const auto solved = normal.solve(kLinear);
  if (!solved) return false;
  std::copy(solved->begin(), solved->end(), fit.linear.begin());
  fit.square_sum = normal.square_sum;
  for (int i = 0; i < kLinear; ++i) fit.square_sum -= (*solved)[i] * normal.right[i];
  return true;
}

// Solves all six (or five) parameters about the current `fit`. Returns the step of omega and lambda, and stores their
// covariance.
std::optional<Eigen::Vector2d> step_of(const TimedValues& samples, Decaying decaying, SineFit& fit) {
  const int size = decaying == Decaying::kYes ? kAll : kAll - 1;
  Normal normal;
  for (std::size_t k = 0; k < samples.value.size(); ++k) {
    const double tau = samples.time_s[k] - fit.origin_s;
    const Wave w = wave(fit, tau);
    const double oscillation = fit.linear[0] * w.cosine + fit.linear[1] * w.sine;
    const double by_omega = tau * (fit.linear[1] * w.cosine - fit.linear[0] * w.sine);
    normal.add({w.cosine, w.sine, 1.0, tau, by_omega, -tau * oscillation}, size,
               samples.value[k] - oscillation - fit.linear[2] - fit.linear[3] * tau);
  }
  Eigen::MatrixXd inverse;
  const auto solved = normal.solve(size, &inverse);
  if (!solved) return std::nullopt;
  fit.spread.setZero();
  fit.spread.topLeftCorner(size - kLinear, size - kLinear) = inverse.bottomRightCorner(size - kLinear, size - kLinear);
  return Eigen::Vector2d((*solved)[kLinear], decaying == Decaying::kYes ? (*solved)[kLinear + 1] : 0.0);
}

double duration(const TimedValues& samples) { return samples.time_s.back() - samples.time_s.front(); }

}  // namespace

double SineFit::amplitude() const { return std::hypot(linear[0], linear[1]); }

double SineFit::oscillation(double t) const {
  const Wave w = wave(*this, t - origin_s);
  return linear[0] * w.cosine + linear[1] * w.sine;
}

double SineFit::operator()(double t) const { return oscillation(t) + linear[2] + linear[3] * (t - origin_s); }

std::optional<SineFit> fit_sine(const TimedValues& samples, double omega, Decaying decaying) {
  if (samples.value.size() < 2 * kAll) return std::nullopt;
  SineFit fit;
  fit.origin_s = samples.time_s.front();
  fit.omega = omega;
  if (!solve_linear(samples, fit)) return std::nullopt;
  for (int pass = 0; pass < kSinePasses; ++pass) {
    auto step = step_of(samples, decaying, fit);
    if (!step) return std::nullopt;
    SineFit next = fit;
    for (int half = 0; half < 6; ++half, *step *= 0.5) {  // halve a step that is too long
      next.omega = fit.omega + (*step)[0];
      next.lambda = fit.lambda + (*step)[1];
      if (!(next.omega > 0.0) || next.lambda * duration(samples) < -3.0 || !solve_linear(samples, next)) continue;
      if (next.square_sum <= fit.square_sum) break;
    }
    if (!(next.square_sum <= fit.square_sum)) break;  // no further improvement
    const double went = std::hypot(next.omega - fit.omega, next.lambda - fit.lambda);
    fit = next;
    if (went * duration(samples) < kConverged) break;
  }
  if (!step_of(samples, decaying, fit)) return std::nullopt;
  if (std::abs(fit.omega - omega) * duration(samples) > kFurthest * 2.0 * std::numbers::pi) return std::nullopt;
  return fit;
}

double best_omega(const TimedValues& samples, double lowest, double highest) {
  SineFit fit;
  fit.origin_s = samples.time_s.front();
  const double step = 2.0 * std::numbers::pi / (4.0 * duration(samples));
  double best = 0.5 * (lowest + highest), least = INFINITY;
  for (double omega = lowest; omega <= highest; omega += step) {
    fit.omega = omega;
    if (!solve_linear(samples, fit) || fit.square_sum >= least) continue;
    least = fit.square_sum;
    best = omega;
  }
  return best;
}

std::vector<double> slow_part(const TimedValues& samples, double spacing_s) {
  const auto spans = static_cast<std::size_t>(std::max(1.0, std::floor(duration(samples) / spacing_s)));
  const double spacing = duration(samples) / static_cast<double>(spans);
  struct At {
    std::size_t knot;
    double share;  // weight of the next knot
  };
  const auto at = [&](double t) -> At {
    const double place = std::max(0.0, (t - samples.time_s.front()) / spacing);
    const std::size_t knot = std::min(spans - 1, static_cast<std::size_t>(place));
    return {knot, place - static_cast<double>(knot)};
  };
  // The normal equations have three diagonals. A small weight on straightness determines knots inside a gap.
  constexpr double kTrace = 1e-6;
  std::vector<double> middle(spans + 1, 2.0 * kTrace), above(spans + 1, -kTrace), right(spans + 1, 0.0);
  for (std::size_t k = 0; k < samples.value.size(); ++k) {
    const auto [knot, share] = at(samples.time_s[k]);
    middle[knot] += (1.0 - share) * (1.0 - share);
    middle[knot + 1] += share * share;
    above[knot] += share * (1.0 - share);
    right[knot] += (1.0 - share) * samples.value[k];
    right[knot + 1] += share * samples.value[k];
  }
  for (std::size_t k = 1; k <= spans; ++k) {
    const double factor = above[k - 1] / middle[k - 1];
    middle[k] -= factor * above[k - 1];
    right[k] -= factor * right[k - 1];
  }
  std::vector<double> knots(spans + 1);
  knots[spans] = right[spans] / middle[spans];
  for (std::size_t k = spans; k-- > 0;) knots[k] = (right[k] - above[k] * knots[k + 1]) / middle[k];
  std::vector<double> slow;
  for (const double t : samples.time_s) {
    const auto [knot, share] = at(t);
    slow.push_back((1.0 - share) * knots[knot] + share * knots[knot + 1]);
  }
  return slow;
}

}  // namespace moiregauge::internal
