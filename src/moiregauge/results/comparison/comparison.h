// SPDX-License-Identifier: Apache-2.0
// Compares a measured channel with the record of another sensor, row by row, with the u of the channel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/results/comparison/alignment.h"

namespace moiregauge::internal {

struct ComparedRow {
  double time_s = 0.0;                     // on the recording's clock
  double measured = 0.0, reference = 0.0;  // the reference has the zero of the channel: its bias is added
  double difference = 0.0;                 // measured minus reference
  double u = 0.0;                          // the measured value's, about the mean of all rows
  bool is_in_U = false;                    // |difference| <= 2 u
};

struct Comparison {
  Alignment alignment;
  std::vector<ComparedRow> rows;
  double correlation = 0.0;                     // between the aligned values
  double rms_difference = 0.0;                  // about the bias
  double lower_limit = 0.0, upper_limit = 0.0;  // limits of agreement: bias -+ 1.96 standard deviations
  double rms_u = 0.0;
  double coverage = 0.0;              // share of rows in U
  double explained = 0.0;             // mean square of u relative to that of the difference
  double rms_unexplained = 0.0;       // 0 if u explains all
  std::vector<std::string> warnings;  // for the user
};

struct ComparisonFailure {
  std::string what;    // a full clause
  std::string remedy;  // an imperative
};

inline constexpr double kComparisonCoverage = 2.0;  // coverage factor k of U
inline constexpr double kLimitsOfAgreement = 1.96;  // standard deviations (Bland and Altman, Lancet 1986, 307-310)

// Aligns both records and evaluates the difference of all `ok` rows. Slope and rate are reported, only offset and rate
// are applied. The zeros of two sensors are arbitrary, so the bias is removed from the differences.
// The u is that of a value about the mean of all rows. Errors that all rows share cancel in it.
// `offset_s`: a known offset; it replaces the search over all offsets, and is refined by up to 1.5 steps.
// Not included in u: errors of the reference, its own time stamps, and interpolation.
// Fails: too few rows, no common movement.
[[nodiscard]] tl::expected<Comparison, ComparisonFailure> compare_records(const ChannelSeries& channel,
                                                                          const Series& reference,
                                                                          std::optional<double> offset_s);

}  // namespace moiregauge::internal
