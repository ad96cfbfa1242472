// SPDX-License-Identifier: Apache-2.0
// Pairs the values of two records for a given offset and clock rate, with the instruments of the fit.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "moiregauge/results/comparison/alignment.h"
#include "moiregauge/results/comparison/spline_series.h"

namespace moiregauge::internal {

struct TimeMap {
  double offset_s = 0.0, rate = 0.0, middle_s = 0.0;
  [[nodiscard]] double reference_time(double t) const { return t + offset_s + rate * (t - middle_s); }
  [[nodiscard]] double recording_time(double tau) const {
    return middle_s + (tau - middle_s - offset_s) / (1.0 + rate);
  }
};

struct Pairs {
  std::vector<AlignedPair> pairs;
  Eigen::VectorXd by_offset;        // derivative of the interpolated value by the offset, per s
  Eigen::VectorXd neighbour_mean;   // the reference's, about its mean; 0 without both neighbours
  Eigen::VectorXd neighbour_slope;  // the slower record's, per s; 0 without both neighbours
  [[nodiscard]] Eigen::Index size() const { return by_offset.size(); }
};

class PairedRecords {
 public:
  PairedRecords(const Series& measured, const Series& reference);
  [[nodiscard]] bool is_channel_interpolated() const { return is_channel_interpolated_; }
  // Returns the pairs of the points from `first` to `last` of the slower record.
  [[nodiscard]] Pairs at(const TimeMap& map, std::size_t first, std::size_t last) const;
  [[nodiscard]] std::size_t points() const { return slower().time_s.size(); }

 private:
  [[nodiscard]] const Series& slower() const { return is_channel_interpolated_ ? reference_ : measured_; }
  [[nodiscard]] Eigen::Index nearest_row(double time_s) const;
  Series measured_, reference_;
  bool is_channel_interpolated_;
  SplineSeries spline_;  // through the faster record
};

}  // namespace moiregauge::internal
