// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/comparison/comparison.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/results/comparison/lag_search.h"
#include "moiregauge/results/comparison/long_run_covariance.h"
#include "moiregauge/results/comparison/spline_series.h"

namespace moiregauge::internal {
namespace {

using Eigen::Index;

struct Start {
  double offset_s = 0.0, step_s = 0.0;
};

tl::unexpected<ComparisonFailure> no_comparison(std::string what, std::string remedy) {
  return tl::unexpected(ComparisonFailure{std::move(what), std::move(remedy)});
}

std::size_t values_in(const Series& series) {
  return static_cast<std::size_t>(
      std::count_if(series.value.begin(), series.value.end(), [](double v) { return std::isfinite(v); }));
}

// Drops values before the first and after the last one, so that both records begin and end with a value.
Series trimmed(const Series& series) {
  const auto is_value = [](double v) { return std::isfinite(v); };
  const auto first = std::find_if(series.value.begin(), series.value.end(), is_value) - series.value.begin();
  const auto after = series.value.rend() - std::find_if(series.value.rbegin(), series.value.rend(), is_value);
  return {{series.time_s.begin() + first, series.time_s.begin() + after},
          {series.value.begin() + first, series.value.begin() + after}};
}

tl::expected<void, ComparisonFailure> check_records(const Series& measured, const Series& reference) {
  for (std::size_t i = 0; i < measured.time_s.size(); ++i) {
    if (!std::isfinite(measured.time_s[i]))
      return no_comparison("the run has no times", "give it times with `moiregauge solve --fps`");
    if (i > 0 && !(measured.time_s[i] > measured.time_s[i - 1]))
      return no_comparison(fmt::format("the times of the run do not increase at {:.6f} s", measured.time_s[i]),
                           "give it times with `moiregauge solve --fps`");
  }
  if (const std::size_t ok = values_in(measured); ok < kMinPairs)
    return no_comparison(fmt::format("the channel has {} ok rows, and {} are needed", ok, kMinPairs),
                         "measure more frames");
  if (const std::size_t given = values_in(reference); given < kMinPairs)
    return no_comparison(fmt::format("the reference has {} values, and {} are needed", given, kMinPairs),
                         "give a longer record");
  return {};
}

// Finds the offset to start with. A stated one is not searched for.
tl::expected<Start, ComparisonFailure> start_of(const Series& measured, const Series& reference,
                                                std::optional<double> stated_s, std::vector<std::string>& warnings) {
  if (stated_s) return Start{*stated_s, std::max(median_step_s(measured.time_s), median_step_s(reference.time_s))};
  const auto found = search_lag(measured, reference);
  if (!found)
    return no_comparison("no common movement was found: " + found.error(), "give the records of one movement");
  if (found->is_opposite)
    return no_comparison("the two records move in opposite directions", "give --sign -1 if their axes are opposite");
  if (!found->is_significant)
    return no_comparison(fmt::format("no common movement was found: the largest correlation is {:.2f}, which chance "
                                     "gives too",
                                     found->correlation),
                         "give the records of one movement, or the known offset with --offset");
  if (found->is_ambiguous)
    warnings.push_back(fmt::format(
        "the time offset may be wrong, because an offset of {:.6g} s fits as well (correlation {:.4f} instead of "
        "{:.4f}). Give the known offset with --offset",
        found->next_offset_s, found->next_correlation, found->correlation));
  return Start{found->offset_s, found->step_s};
}

double correlation_of(const std::vector<AlignedPair>& pairs) {
  Eigen::VectorXd m(std::ssize(pairs)), r(std::ssize(pairs));
  for (std::size_t k = 0; k < pairs.size(); ++k)
    m(static_cast<Index>(k)) = pairs[k].measured, r(static_cast<Index>(k)) = pairs[k].reference;
  m.array() -= m.mean(), r.array() -= r.mean();
  return m.dot(r) / std::sqrt(m.squaredNorm() * r.squaredNorm());
}

// u of the values about their mean: the mean of the factors cancels, and the mean of the noise is 1/n of it.
std::vector<double> u_about_mean(const ChannelSeries& channel, const std::vector<AlignedPair>& pairs) {
  const double n = static_cast<double>(pairs.size());
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(channel.loadings.cols());
  double noise = 0.0;
  for (const AlignedPair& pair : pairs) {
    mean += channel.loadings.row(pair.row) / n;
    noise += channel.noise(pair.row) / n;
  }
  std::vector<double> u;
  for (const AlignedPair& pair : pairs) {
    const double shared = (channel.loadings.row(pair.row) - mean).squaredNorm();
    const double codec = channel.bounded(pair.row) * channel.bounded(pair.row);
    u.push_back(std::sqrt(channel.noise(pair.row) * (1.0 - 2.0 / n) + noise / n + codec + shared));
  }
  return u;
}

void put_rows(const ChannelSeries& channel, Comparison& out) {
  const auto& pairs = out.alignment.pairs;
  const auto n = static_cast<Index>(pairs.size());
  Eigen::VectorXd difference(n);
  for (Index k = 0; k < n; ++k)
    difference(k) = pairs[static_cast<std::size_t>(k)].measured - pairs[static_cast<std::size_t>(k)].reference;
  const double bias = difference.mean();
  difference.array() -= bias;
  out.alignment.bias.value = bias;
  const double lost = static_cast<double>(n) / static_cast<double>(n - 1);
  out.alignment.bias.u = std::sqrt(lost * long_run_covariance(difference, difference)(0, 0)) / static_cast<double>(n);
  const std::vector<double> u = u_about_mean(channel, pairs);
  double squares_u = 0.0, inside = 0.0;
  for (Index k = 0; k < n; ++k) {
    const AlignedPair& pair = pairs[static_cast<std::size_t>(k)];
    const double u_k = u[static_cast<std::size_t>(k)];
    const bool is_inside = std::abs(difference(k)) <= kComparisonCoverage * u_k;
    out.rows.push_back({pair.time_s, pair.measured, pair.reference + bias, difference(k), u_k, is_inside});
    squares_u += u_k * u_k;
    inside += is_inside ? 1.0 : 0.0;
  }
  const double count = static_cast<double>(n), squares = difference.squaredNorm();
  const double deviation = std::sqrt(squares / (count - 1.0));
  out.rms_difference = std::sqrt(squares / count);
  out.lower_limit = bias - kLimitsOfAgreement * deviation;
  out.upper_limit = bias + kLimitsOfAgreement * deviation;
  out.rms_u = std::sqrt(squares_u / count);
  out.coverage = inside / count;
  out.explained = squares > 0.0 ? squares_u / squares : 1.0;
  out.rms_unexplained = std::sqrt(std::max(0.0, squares - squares_u) / count);
}

}  // namespace

tl::expected<Comparison, ComparisonFailure> compare_records(const ChannelSeries& channel, const Series& reference,
                                                            std::optional<double> offset_s) {
  const Series measured = ok_series(channel);
  if (const auto checked = check_records(measured, reference); !checked) return tl::unexpected(checked.error());
  Comparison out;
  const auto start = start_of(trimmed(measured), trimmed(reference), offset_s, out.warnings);
  if (!start) return tl::unexpected(start.error());
  auto alignment = fit_alignment(channel, reference, start->offset_s, start->step_s);
  if (!alignment)
    return no_comparison(alignment.error(), offset_s ? "correct --offset, or give the records of one movement"
                                                     : "give records that overlap and show one movement");
  out.alignment = *std::move(alignment);
  out.correlation = correlation_of(out.alignment.pairs);
  put_rows(channel, out);
  if (!out.alignment.has_rate)
    out.warnings.push_back("note: the record is too short to determine the clock rate, which is fixed at 0");
  return out;
}

}  // namespace moiregauge::internal
