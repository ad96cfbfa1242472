// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/results/series.h"

namespace moiregauge::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Done = tl::expected<void, std::string>;

// Half width of a filter in periods of its frequency. The Hamming window's transition is then as wide as the frequency.
// It goes from half of it to one and a half. Source: Oppenheim and Schafer, section 7.5.
constexpr double kHalfWidth_periods = 1.65;
// Longest step that interpolation crosses, in median intervals: a missing frame is a gap. Chosen.
constexpr double kLongestStep = 1.5;
constexpr double kMaxRows = 4e6;  // after resampling; 11 hours at 100 Hz

tl::unexpected<std::string> refused(std::string text) { return tl::unexpected(std::move(text)); }

// Returns the symmetric kernel of a low pass with half width m, of sum 1. The amplitude at `nu` cycles per row is 1/2.
VectorXd low_pass(double nu, Index m) {
  VectorXd h(2 * m + 1);
  for (Index k = -m; k <= m; ++k) {
    const double x = static_cast<double>(k), angle = 2.0 * std::numbers::pi * nu * x;
    const double window = 0.54 + 0.46 * std::cos(std::numbers::pi * x / static_cast<double>(m + 1));
    h(k + m) = window * (k == 0 ? 2.0 * nu : std::sin(angle) / (std::numbers::pi * x));
  }
  return h / h.sum();
}

// Weights of the central difference of eighth order, from the row after on. Within 0.4 % up to a quarter of the rate,
// and the low pass removes the rest. Source: Fornberg 1988, table 1.
constexpr std::array kDifference{4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};

// Returns the weights of the derivative of that low pass, per row. They are exact for a straight line.
VectorXd low_pass_slope(double nu, Index m) {
  const VectorXd h = low_pass(nu, m);
  const auto reach = static_cast<Index>(kDifference.size());
  VectorXd w = VectorXd::Zero(h.size() + 2 * reach);
  for (Index k = 1; k <= reach; ++k) {
    const double weight = kDifference[static_cast<std::size_t>(k - 1)];
    w.segment(reach + k, h.size()) += weight * h;
    w.segment(reach - k, h.size()) -= weight * h;
  }
  return w;
}

Index half_width(double nu) { return static_cast<Index>(std::ceil(kHalfWidth_periods / nu)); }

// Returns the kernel of a filter at `interval_s` per row.
VectorXd kernel_of(const FilterLayer& filter, double interval_s) {
  const double low = filter.low_hz * interval_s, high = filter.high_hz * interval_s;
  const Index m = std::max(low > 0.0 ? half_width(low) : 1, high > 0.0 ? half_width(high) : 1);
  VectorXd kernel = VectorXd::Zero(2 * m + 1);
  const auto add = [&](double sign, double nu) {
    const Index half = half_width(nu);
    kernel.segment(m - half, 2 * half + 1) += sign * low_pass(nu, half);
  };
  if (high > 0.0)
    add(1.0, high);
  else
    kernel(m) = 1.0;
  if (low > 0.0) add(-1.0, low);
  return kernel;
}

// A series while its layers are applied.
class LayerStack {
 public:
  LayerStack(ChannelSeries series, std::string unit) {
    std::vector<bool> is_ok;
    for (Index n = 0; n < series.size(); ++n) is_ok.push_back(series.is_ok(n));
    out_.time_s = series.time_s;
    out_.frame = series.frame;
    out_.status = series.status;
    out_.unit = std::move(unit);
    out_.by_base = TimeOperator::identity(is_ok);
    out_.base = std::move(series);
  }

  Done add(const Layer& layer) {
    return std::visit([this](const auto& what) { return apply(what); }, layer.what);
  }

  LayeredSeries finished() {
    const ChannelSeries now = present();
    out_.value = now.value;
    out_.u.resize(now.size());
    for (Index n = 0; n < now.size(); ++n) out_.u(n) = now.u(n);
    return std::move(out_);
  }

 private:
  [[nodiscard]] Index rows() const { return out_.by_base.rows(); }

  // Returns the series with all layers so far.
  [[nodiscard]] ChannelSeries present() const {
    ChannelSeries now;
    const ChannelSeries& base = out_.base;
    now.frame = out_.frame;
    now.time_s = out_.time_s;
    now.status = out_.status;
    now.value = out_.by_base.apply(base.value);
    now.noise = out_.by_base.variance(base.noise);
    const VectorXd equal = out_.by_base.apply(base.bounded).cwiseAbs2();
    now.bounded = out_.by_base.variance(base.bounded.cwiseAbs2()).cwiseMax(equal).cwiseSqrt();
    now.loadings = out_.by_base.apply(base.loadings);
    return now;
  }

  void then(const TimeOperator& next) { out_.by_base = next.after(out_.by_base); }

  [[nodiscard]] std::vector<bool> has_values() const {
    std::vector<bool> has;
    for (Index n = 0; n < rows(); ++n) has.push_back(out_.by_base.has_value(n));
    return has;
  }

  // Subtracts combinations of the columns of `u`: row by row minus u v^T.
  void subtract(const MatrixXd& u, const MatrixXd& v) {
    std::vector<BandRow> band(static_cast<std::size_t>(rows()));
    for (Index n = 0; n < rows(); ++n) {
      if (out_.by_base.has_value(n)) band[static_cast<std::size_t>(n)] = {n, VectorXd::Ones(1), true};
    }
    then(TimeOperator(std::move(band), -u, v));
  }

  Done apply(const ZeroLayer& zero) {
    if (out_.frame.empty() && !zero.frames.seconds)
      return refused("the rows are no frames after resampling: give --zero in seconds");
    FrameSelector selector(zero.frames);
    VectorXd in = VectorXd::Zero(rows());
    for (Index n = 0; n < rows(); ++n) {
      const auto at = static_cast<std::size_t>(n);
      const bool is_in = selector.holds(out_.frame.empty() ? n : out_.frame[at], out_.time_s[at]);
      in(n) = is_in && out_.by_base.has_value(n) ? 1.0 : 0.0;
    }
    if (in.sum() == 0.0) return refused("no row of --zero is ok: choose other frames");
    subtract(VectorXd::Ones(rows()), in / in.sum());
    return {};
  }

  Done apply(const DetrendLayer&) {
    const auto has = has_values();
    const bool is_timed =
        std::all_of(out_.time_s.begin(), out_.time_s.end(), [](double t) { return std::isfinite(t); });
    MatrixXd line = MatrixXd::Zero(rows(), 2);
    double count = 0.0, sum = 0.0;
    const auto place = [&](Index n) { return is_timed ? out_.time_s[static_cast<std::size_t>(n)] : double(n); };
    for (Index n = 0; n < rows(); ++n) {
      if (has[static_cast<std::size_t>(n)]) count += 1.0, sum += place(n);
    }
    if (count < 3.0) return refused("fewer than three rows have a value: omit --detrend");
    for (Index n = 0; n < rows(); ++n) line.row(n) << 1.0, place(n) - sum / count;
    MatrixXd used = line;
    for (Index n = 0; n < rows(); ++n) {
      if (!has[static_cast<std::size_t>(n)]) used.row(n).setZero();
    }
    const double spread = used.col(1).squaredNorm();
    if (!(spread > 0.0)) return refused("all rows have the same time: omit --detrend");
    used.col(0) /= count;
    used.col(1) /= spread;
    subtract(line, used);
    return {};
  }

  // Applies a kernel to every row that has its whole width between gaps.
  Done convolve(const EvenTimes& times, const VectorXd& kernel) {
    const Index m = kernel.size() / 2;
    std::vector<BandRow> band(static_cast<std::size_t>(rows()));
    bool has_any = false;
    for (const Stretch& stretch : times.stretches) {
      const auto first = static_cast<Index>(stretch.first), end = first + static_cast<Index>(stretch.count);
      for (Index n = first + m; n + m < end; ++n) {
        band[static_cast<std::size_t>(n)] = {n - m, kernel, true};
        has_any = true;
      }
    }
    if (!has_any)
      return refused(
          fmt::format("the filter needs {} rows without a gap, and the longest part has {}: give a higher "
                      "frequency",
                      kernel.size(), times.longest().count));
    then(TimeOperator(std::move(band), MatrixXd(rows(), 0), MatrixXd(rows(), 0)));
    return {};
  }

  // Returns the even times of the rows. Fails: the times are not even, or `hz` is beyond half the rate.
  [[nodiscard]] tl::expected<EvenTimes, std::string> times_for(double hz) const {
    Series series{out_.time_s, {}};
    for (const bool has : has_values()) series.value.push_back(has ? 0.0 : kNotMeasured);
    auto times = even_times(series);
    if (!times) return refused(times.error() + ": resample first with --resample");
    if (hz * times->interval_s >= 0.5)
      return refused(fmt::format("a frequency of {:g} Hz is beyond half the frame rate: give less than {:g} Hz", hz,
                                 0.5 / times->interval_s));
    if (kHalfWidth_periods / (hz * times->interval_s) > kMaxRows)
      return refused(fmt::format("a frequency of {:g} Hz is too low: give a higher one", hz));
    return times;
  }

  Done apply(const FilterLayer& filter) {
    for (const double hz : {filter.low_hz, filter.high_hz}) {
      if (hz == 0.0) continue;
      const auto times = times_for(hz);
      if (!times) return tl::unexpected(times.error());
    }
    const auto times = times_for(std::max(filter.low_hz, filter.high_hz));
    return convolve(*times, kernel_of(filter, times->interval_s));
  }

  Done apply(const VelocityLayer& velocity) {
    const auto times = times_for(velocity.below_hz);
    if (!times) return tl::unexpected(times.error());
    const double nu = velocity.below_hz * times->interval_s;
    out_.unit += "/s";
    return convolve(*times, low_pass_slope(nu, half_width(nu)) / times->interval_s);
  }

  Done apply(const ResampleLayer& resample) {
    const std::vector<double>& t = out_.time_s;
    const auto is_later = [](double a, double b) { return !(b > a); };
    if (t.size() < 2 || std::adjacent_find(t.begin(), t.end(), is_later) != t.end())
      return refused("the frames have no ascending times: measure or solve with --fps");
    const double count = std::floor((t.back() - t.front()) * resample.rate_hz + 1e-9) + 1.0;
    if (!(count <= kMaxRows))
      return refused(fmt::format("there would be {:.3g} rows, more than {:g}: give a lower rate", count, kMaxRows));
    std::vector<double> steps;
    for (std::size_t n = 1; n < t.size(); ++n) steps.push_back(t[n] - t[n - 1]);
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    interpolate(static_cast<std::size_t>(count), resample.rate_hz, kLongestStep * steps[steps.size() / 2]);
    return {};
  }

  void interpolate(std::size_t count, double rate_hz, double longest_s) {
    const std::vector<double> t = out_.time_s;
    const std::vector<Status> status = out_.status;
    std::vector<BandRow> band(count);
    out_.time_s.clear(), out_.frame.clear(), out_.status.clear();
    std::size_t n = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double at = t.front() + static_cast<double>(k) / rate_hz;
      while (n + 2 < t.size() && t[n + 1] <= at) ++n;
      const double step = t[n + 1] - t[n], share = std::clamp((at - t[n]) / step, 0.0, 1.0);
      const auto row = static_cast<Index>(n);
      const bool has =
          (share == 1.0 || out_.by_base.has_value(row)) && (share == 0.0 || out_.by_base.has_value(row + 1));
      out_.time_s.push_back(at);
      out_.status.push_back(share < 1.0 && status[n] != Status::kOk ? status[n]
                            : share > 0.0                           ? status[n + 1]
                                                                    : status[n]);
      if (has && (step <= longest_s || share == 0.0 || share == 1.0))
        band[k] = {row, Eigen::Vector2d(1.0 - share, share), true};
    }
    const auto size = static_cast<Index>(count);
    then(TimeOperator(std::move(band), MatrixXd(size, 0), MatrixXd(t.size(), 0)));
  }

  // A median is not linear. Its errors are those of the row in the middle, equal, independent or anything between.
  Done apply(const MedianLayer& median) {
    ChannelSeries now = present();
    const ChannelSeries before = now;
    const Index m = median.rows / 2;
    std::vector<bool> has(static_cast<std::size_t>(rows()), false);
    for (Index n = m; n + m < rows(); ++n) {
      VectorXd window = before.value.segment(n - m, median.rows);
      if (!window.allFinite()) continue;
      std::nth_element(window.begin(), window.begin() + m, window.end());
      now.value(n) = window(m);
      has[static_cast<std::size_t>(n)] = true;
    }
    if (std::find(has.begin(), has.end(), true) == has.end())
      return refused(fmt::format("no {} rows follow each other without a gap: give a smaller --median", median.rows));
    now.bounded = (before.noise + before.bounded.cwiseAbs2()).cwiseSqrt();
    now.noise.setZero();
    out_.base = std::move(now);
    out_.by_base = TimeOperator::identity(has);
    out_.is_u_of_median = true;
    return {};
  }

  LayeredSeries out_;
};

}  // namespace

tl::expected<LayeredSeries, std::string> layered(ChannelSeries series, const std::string& unit,
                                                 const std::vector<Layer>& layers) {
  if (layers.empty()) {  // rows that are not `ok` keep their values
    LayeredSeries out = LayerStack(series, unit).finished();
    for (Index n = 0; n < series.size(); ++n) {
      out.value(n) = series.value(n);
      out.u(n) = std::isnan(series.value(n)) ? kNotMeasured : series.u(n);
    }
    return out;
  }
  LayerStack stack(std::move(series), unit);
  for (const Layer& layer : layers) {
    if (auto done = stack.add(layer); !done) return tl::unexpected(done.error());
  }
  return stack.finished();
}

ValueWithU weighted_sum(const LayeredSeries& series, const VectorXd& weights) {
  ValueWithU out{0.0, 0.0};
  for (Index n = 0; n < weights.size(); ++n) {
    if (weights(n) != 0.0) out.value += weights(n) * series.value(n);
  }
  const VectorXd w = series.by_base.transposed(weights);
  const ChannelSeries& base = series.base;
  const auto clean = [](double value) { return std::isfinite(value) ? value : 0.0; };
  const double noise = w.cwiseAbs2().dot(base.noise.unaryExpr(clean));
  const VectorXd bounded = w.cwiseProduct(base.bounded.unaryExpr(clean));
  const double equal = bounded.sum();
  const VectorXd shared = base.loadings.unaryExpr(clean).transpose() * w;
  out.u = std::sqrt(noise + std::max(bounded.squaredNorm(), equal * equal) + shared.squaredNorm());
  return out;
}

}  // namespace moiregauge::internal
