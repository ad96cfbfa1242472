// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/lag_search.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include <unsupported/Eigen/FFT>

#include "moiregauge/results/comparison/spline_series.h"

namespace moiregauge::internal {
namespace {

constexpr double kMaxCells = 262144.0;   // in one series (chosen: bounds time and memory)
constexpr double kMinOverlap = 0.1;      // share of the shorter series; less is no evidence (chosen)
constexpr double kMinCells = 8.0;        // in an overlap (chosen)
constexpr double kPeakEdge = 0.5;        // share of the correlation at which the peak ends (chosen)
constexpr double kNoCorrelation = 0.05;  // product of autocorrelations below which samples are independent (chosen)
constexpr double kMaxSquare = 1.0 - 1e-12;

// One series on the grid: cell k is around the time start + k step. Mask 0: nothing in the cell.
struct Cells {
  double start_s = 0.0;
  std::vector<double> value, mask;
};

// Averages the samples of a cell. Between samples no further apart than a gap, a cell without one is interpolated.
Cells cells_of(const Series& series, double step_s) {
  Cells cells;
  cells.start_s = series.time_s.front();
  const auto count = static_cast<std::size_t>((series.time_s.back() - cells.start_s) / step_s + 1.5);
  cells.value.assign(count, 0.0);
  cells.mask.assign(count, 0.0);
  double sum = 0.0, values = 0.0;
  for (std::size_t i = 0; i < series.time_s.size(); ++i) {
    if (!std::isfinite(series.value[i])) continue;
    const auto k =
        std::min(count - 1, static_cast<std::size_t>(std::lround((series.time_s[i] - cells.start_s) / step_s)));
    cells.value[k] += series.value[i];
    cells.mask[k] += 1.0;
    sum += series.value[i];
    values += 1.0;
  }
  const SplineSeries between(series);
  for (std::size_t k = 0; k < count; ++k) {
    if (cells.mask[k] == 0.0) {
      cells.value[k] = between.at(cells.start_s + static_cast<double>(k) * step_s).value;
      cells.mask[k] = std::isfinite(cells.value[k]) ? 1.0 : 0.0;
    }
    // Without the mean, sums of squares keep their digits.
    cells.value[k] = cells.mask[k] > 0.0 ? cells.value[k] / cells.mask[k] - sum / values : 0.0;
    cells.mask[k] = cells.mask[k] > 0.0 ? 1.0 : 0.0;
  }
  return cells;
}

// Sums over products at all lags by FFT: result[lag] = sum of a[k] b[k + lag]; negative lags are at the end.
class LagSums {
 public:
  explicit LagSums(std::size_t length) : length_(length) {}
  using Transform = std::vector<std::complex<double>>;
  Transform forward(const std::vector<double>& values) {
    std::vector<std::complex<double>> padded(length_);
    std::copy(values.begin(), values.end(), padded.begin());
    Transform out;
    fft_.fwd(out, padded);
    return out;
  }
  std::vector<double> sums(const Transform& a, const Transform& b) {
    Transform product(length_), back;
    for (std::size_t i = 0; i < length_; ++i) product[i] = std::conj(a[i]) * b[i];
    fft_.inv(back, product);
    std::vector<double> out(length_);
    std::transform(back.begin(), back.end(), out.begin(), [](const auto& z) { return z.real(); });
    return out;
  }

 private:
  std::size_t length_;
  Eigen::FFT<double> fft_;
};

std::vector<double> squares(std::vector<double> values) {
  for (double& v : values) v *= v;
  return values;
}

struct LagTable {
  std::vector<double> correlation, overlap;  // by place; NaN: the overlap is too short
  std::ptrdiff_t first_lag = 0;              // lag of place 0
};

LagTable correlate(const Cells& measured, const Cells& reference) {
  const std::size_t f = measured.value.size(), g = reference.value.size();
  std::size_t length = 1;
  while (length < f + g) length *= 2;
  LagSums lag_sums(length);
  const auto a = lag_sums.forward(measured.mask), b = lag_sums.forward(reference.mask);
  const auto x = lag_sums.forward(measured.value), y = lag_sums.forward(reference.value);
  const auto n = lag_sums.sums(a, b), sx = lag_sums.sums(x, b), sy = lag_sums.sums(a, y), sxy = lag_sums.sums(x, y);
  const auto sxx = lag_sums.sums(lag_sums.forward(squares(measured.value)), b);
  const auto syy = lag_sums.sums(a, lag_sums.forward(squares(reference.value)));
  const double least = std::max(kMinCells, kMinOverlap * static_cast<double>(std::min(f, g)));
  const double most_x = *std::max_element(sxx.begin(), sxx.end()), most_y = *std::max_element(syy.begin(), syy.end());
  LagTable table;
  table.first_lag = 1 - static_cast<std::ptrdiff_t>(f);
  for (std::ptrdiff_t lag = table.first_lag; lag < static_cast<std::ptrdiff_t>(g); ++lag) {
    const auto i = static_cast<std::size_t>(lag < 0 ? lag + static_cast<std::ptrdiff_t>(length) : lag);
    const double vx = sxx[i] - sx[i] * sx[i] / n[i], vy = syy[i] - sy[i] * sy[i] / n[i];
    // Below rounding of the transforms a variance is zero.
    constexpr double kRounding = 1e-12;
    const bool has_values = n[i] >= least && vx > kRounding * most_x && vy > kRounding * most_y;
    table.overlap.push_back(n[i]);
    table.correlation.push_back(has_values ? std::clamp((sxy[i] - sx[i] * sy[i] / n[i]) / std::sqrt(vx * vy), -1.0, 1.0)
                                           : kNotMeasured);
  }
  return table;
}

std::vector<double> autocorrelation(const Cells& cells) {
  const LagTable table = correlate(cells, cells);
  return {table.correlation.begin() - table.first_lag, table.correlation.end()};
}

// Returns cells per independent pair: 1 + 2 sum of the products of both autocorrelations, up to the first low one.
double cells_per_pair(const Cells& measured, const Cells& reference) {
  const auto p = autocorrelation(measured), q = autocorrelation(reference);
  double sum = 1.0;
  for (std::size_t k = 1; k < std::min(p.size(), q.size()); ++k) {
    if (!(p[k] * q[k] > kNoCorrelation) || p[k] < 0.0) break;
    sum += 2.0 * p[k] * q[k];
  }
  return sum;
}

double information(double correlation, double overlap) {
  return -0.5 * overlap * std::log1p(-std::min(correlation * correlation, kMaxSquare));
}

// Returns the place with the most information of correlations times `sign`, outside the places from `low` to `high`.
std::ptrdiff_t best_place(const LagTable& table, double sign, std::ptrdiff_t low = 0, std::ptrdiff_t high = -1) {
  std::ptrdiff_t best = -1;
  double most = 0.0;
  for (std::ptrdiff_t i = 0; i < std::ssize(table.correlation); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if ((i >= low && i <= high) || !(sign * table.correlation[at] > 0.0)) continue;
    const double here = information(table.correlation[at], table.overlap[at]);
    if (here > most) best = i, most = here;
  }
  return best;
}

void find_next(const LagTable& table, std::ptrdiff_t best, LagSearch& found) {
  const auto r = [&](std::ptrdiff_t i) { return table.correlation[static_cast<std::size_t>(i)]; };
  const auto n = [&](std::ptrdiff_t i) { return table.overlap[static_cast<std::size_t>(i)]; };
  std::ptrdiff_t low = best, high = best;
  while (low > 0 && r(low - 1) > kPeakEdge * r(best)) --low;
  while (high + 1 < std::ssize(table.correlation) && r(high + 1) > kPeakEdge * r(best)) ++high;
  const std::ptrdiff_t next = best_place(table, 1.0, low, high);
  if (next < 0) return;
  found.next_offset_s = found.offset_s + found.step_s * static_cast<double>(next - best);
  found.next_correlation = r(next);
  const double worse = std::log((1.0 - r(next) * r(next)) / std::max(1.0 - r(best) * r(best), 1.0 - kMaxSquare));
  found.is_ambiguous = n(next) > 0.5 * n(best) && found.independent_rows * worse < -2.0 * std::log(kMaxChance);
}

}  // namespace

tl::expected<LagSearch, std::string> search_lag(const Series& measured, const Series& reference) {
  LagSearch found;
  for (const Series* series : {&measured, &reference}) {
    if (series->time_s.size() < 2) return tl::unexpected(std::string("there are less than two values"));
    const double duration = series->time_s.back() - series->time_s.front();
    found.step_s = std::max({found.step_s, median_step_s(series->time_s), duration / kMaxCells});
  }
  const Cells m = cells_of(measured, found.step_s), r = cells_of(reference, found.step_s);
  const LagTable table = correlate(m, r);
  const std::ptrdiff_t best = best_place(table, 1.0), opposite = best_place(table, -1.0);
  if (best < 0 && opposite < 0) return tl::unexpected(std::string("one of the records does not vary"));
  const double per_pair = cells_per_pair(m, r), lags = static_cast<double>(table.overlap.size()) / per_pair;
  const auto evidence = [&](std::ptrdiff_t i) {
    if (i < 0) return 0.0;
    return information(table.correlation[static_cast<std::size_t>(i)], table.overlap[static_cast<std::size_t>(i)]) /
           per_pair;
  };
  const double needed = std::log(std::max(1.0, lags) / kMaxChance);
  found.is_opposite = evidence(opposite) > needed && evidence(opposite) > 1.2 * evidence(best);
  if (best < 0) return found;
  const double lag = static_cast<double>(best + table.first_lag);
  found.offset_s = r.start_s - m.start_s + lag * found.step_s;
  found.correlation = table.correlation[static_cast<std::size_t>(best)];
  found.independent_rows = table.overlap[static_cast<std::size_t>(best)] / per_pair;
  found.is_significant = evidence(best) > needed;
  find_next(table, best, found);
  return found;
}

}  // namespace moiregauge::internal
