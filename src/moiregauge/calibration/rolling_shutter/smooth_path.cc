// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/calibration/rolling_shutter/smooth_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace moiregauge::internal {
namespace {

// Time in units of the median step, and values in units of their spread. One start value then suits all quantities.
struct Scaled {
  std::vector<double> time, value, variance;
  double step_s = 1.0, spread = 1.0;
};

constexpr double kFirstGuess = 100.0;           // prior variance of the first state: practically unknown
constexpr double kMinVariance = 1e-12;          // least variance of a sample, against rounding
constexpr std::size_t kMaxForLikelihood = 400;  // first samples, for the likelihood only; chosen

Scaled scaled(std::span<const double> time, std::span<const double> value, std::span<const double> variance) {
  Scaled out;
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  std::nth_element(steps.begin(), steps.begin() + static_cast<long>(steps.size() / 2), steps.end());
  out.step_s = std::max(steps[steps.size() / 2], 1e-9);
  double mean = 0.0, square = 0.0, noise = 0.0;
  const auto n = static_cast<double>(value.size());
  for (const double v : value) mean += v / n;
  for (const double v : value) square += (v - mean) * (v - mean) / n;
  for (const double v : variance) noise += v / n;
  out.spread = std::max(std::sqrt(std::max(square, noise)), 1e-300);
  for (std::size_t i = 0; i < time.size(); ++i) {
    out.time.push_back((time[i] - time[0]) / out.step_s);
    out.value.push_back((value[i] - mean) / out.spread);
    out.variance.push_back(variance[i] / (out.spread * out.spread) + kMinVariance);
  }
  return out;
}

template <int kOrder>
class Filter {
 public:
  using State = Eigen::Matrix<double, kOrder, 1>;
  using Square = Eigen::Matrix<double, kOrder, kOrder>;
  struct Moment {
    State mean, predicted;
    Square covariance, predicted_covariance, forth, noise;  // forth, noise: since the sample before
  };

  Filter(const Scaled& samples, double strength, double excess)
      : samples_(samples), strength_(strength), excess_(excess) {}

  // Runs the Kalman filter. Returns -2 log likelihood of the first `count` samples.
  double run(std::size_t count, std::vector<Moment>* kept) const {
    double sum = 0.0;
    Moment now;
    now.mean.setZero();
    now.covariance = kFirstGuess * Square::Identity();
    for (std::size_t i = 0; i < count; ++i) {
      if (i > 0) move(now, samples_.time[i] - samples_.time[i - 1]);
      now.predicted = now.mean;
      now.predicted_covariance = now.covariance;
      const double noise = excess_ * samples_.variance[i];
      const double s = now.covariance(0, 0) + noise, off = samples_.value[i] - now.mean(0);
      sum += std::log(s) + off * off / s;
      const State gain = now.covariance.col(0) / s;
      now.mean += gain * off;
      Square keep = Square::Identity();
      keep.col(0) -= gain;
      const Square after = keep * now.covariance * keep.transpose() + noise * gain * gain.transpose();  // Joseph
      now.covariance = 0.5 * (after + after.transpose());
      if (kept != nullptr) kept->push_back(now);
    }
    return sum;
  }

  void smooth(std::vector<Moment>& m) const {
    for (std::size_t i = m.size() - 1; i-- > 0;) {
      const Moment& next = m[i + 1];
      const Square across = m[i].covariance * next.forth.transpose();
      const State scale = next.predicted_covariance.diagonal().cwiseSqrt().cwiseInverse();
      const Square unit = scale.asDiagonal() * next.predicted_covariance * scale.asDiagonal();
      const Square inverse = scale.asDiagonal() * unit.ldlt().solve(Square(scale.asDiagonal()));
      const Square back = across * inverse;
      m[i].mean += back * (next.mean - next.predicted);
      // This sum of two terms stays positive, unlike the usual difference of large numbers.
      const Square keep = Square::Identity() - back * next.forth;
      const Square c =
          keep * m[i].covariance * keep.transpose() + back * (next.covariance + next.noise) * back.transpose();
      m[i].covariance = 0.5 * (c + c.transpose());
    }
  }

 private:
  void move(Moment& m, double dt) const {
    m.forth.setIdentity();
    for (int i = 0; i < kOrder; ++i) {
      for (int j = i + 1; j < kOrder; ++j) m.forth(i, j) = m.forth(i, j - 1) * dt / (j - i);
    }
    constexpr std::array kFactorial{1.0, 1.0, 2.0, 6.0};
    std::array<double, 2 * kOrder> power{};
    for (std::size_t p = 1; p < power.size(); ++p) power[p] = std::pow(dt, p);
    for (int i = 0; i < kOrder; ++i) {
      for (int j = 0; j < kOrder; ++j) {
        const auto a = static_cast<std::size_t>(kOrder - 1 - i), b = static_cast<std::size_t>(kOrder - 1 - j);
        const std::size_t p = a + b + 1;
        m.noise(i, j) = strength_ * power[p] / (static_cast<double>(p) * kFactorial[a] * kFactorial[b]);
      }
    }
    m.mean = m.forth * m.mean;
    m.covariance = m.forth * m.covariance * m.forth.transpose() + m.noise;
  }

  const Scaled& samples_;
  double strength_, excess_;
};

struct Likely {
  double minus_two_log = std::numeric_limits<double>::infinity();
  double strength = 1.0, excess = 1.0;
};

template <int kOrder>
Likely most_likely(const Scaled& samples) {
  const std::size_t count = std::min(samples.time.size(), kMaxForLikelihood);
  Likely best;
  const auto look = [&](double log_strength, double excess) {
    const double strength = std::exp(log_strength);
    const double l = Filter<kOrder>(samples, strength, excess).run(count, nullptr);
    if (l < best.minus_two_log) best = {l, strength, excess};
  };
  for (const double excess : {1.0, 10.0, 100.0, 1000.0}) {
    for (double s = -24.0; s <= 8.0; s += 2.0) look(s, excess);
  }
  for (double half = 1.0; half > 0.1; half *= 0.5) {
    const Likely middle = best;
    for (const double side : {-half, half}) look(std::log(middle.strength) + side, middle.excess);
  }
  return best;
}

template <int kOrder>
std::vector<PathPoint> path_of(const Scaled& samples, const Likely& likely) {
  const Filter<kOrder> filter(samples, likely.strength, likely.excess);
  std::vector<typename Filter<kOrder>::Moment> moments;
  filter.run(samples.time.size(), &moments);
  filter.smooth(moments);
  std::vector<PathPoint> out;
  for (const auto& m : moments) {
    std::array<double, 4> unit{};
    for (std::size_t k = 0; k < unit.size(); ++k) unit[k] = samples.spread / std::pow(samples.step_s, k);
    PathPoint p;
    p.rate = m.mean(1) * unit[1];
    p.covariance(0, 0) = m.covariance(1, 1) * unit[1] * unit[1];
    if constexpr (kOrder > 2) {
      p.acceleration = m.mean(2) * unit[2];
      p.covariance(0, 1) = p.covariance(1, 0) = m.covariance(1, 2) * unit[1] * unit[2];
      p.covariance(1, 1) = m.covariance(2, 2) * unit[2] * unit[2];
    } else {
      // With m = 2 the rate is a random walk: take its variance after one step.
      p.covariance(1, 1) = likely.strength * unit[2] * unit[2];
    }
    if constexpr (kOrder > 3) p.jerk = m.mean(3) * unit[3];
    out.push_back(p);
  }
  return out;
}

}  // namespace

std::vector<PathPoint> smooth_path(std::span<const double> time_s, std::span<const double> value,
                                   std::span<const double> variance) {
  if (time_s.size() < 2) return std::vector<PathPoint>(time_s.size());
  const Scaled samples = scaled(time_s, value, variance);
  const Likely two = most_likely<2>(samples), three = most_likely<3>(samples), four = most_likely<4>(samples);
  if (four.minus_two_log < three.minus_two_log && four.minus_two_log < two.minus_two_log)
    return path_of<4>(samples, four);
  return three.minus_two_log < two.minus_two_log ? path_of<3>(samples, three) : path_of<2>(samples, two);
}

}  // namespace moiregauge::internal
