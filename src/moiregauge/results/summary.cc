// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/summary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace moiregauge::internal {
namespace {

using BoardExtent = Extent<frame::Board>;

// Root mean square of the measured values.
class Rms {
 public:
  void add(BoardExtent e) {
    add(x_, e.x);
    add(y_, e.y);
  }
  [[nodiscard]] BoardExtent value() const { return {of(x_), of(y_)}; }

 private:
  struct Sum {
    double squares = 0.0;
    long count = 0;
  };
  static void add(Sum& sum, double v) {
    if (std::isnan(v)) return;
    sum.squares += v * v;
    ++sum.count;
  }
  static double of(const Sum& sum) { return sum.count > 0 ? std::sqrt(sum.squares / double(sum.count)) : kNotMeasured; }
  Sum x_, y_;
};

class Sums {
 public:
  void add(const Sample& sample) {
    u_.add(sample.u);
    for (std::size_t k = 0; k < kBudgetParts.size(); ++k) parts_[k].add(sample.budget.*kBudgetParts[k].value);
    ++rows_;
  }
  [[nodiscard]] bool is_empty() const { return rows_ == 0; }
  void put(TargetSummary& s) const {
    s.u = u_.value();
    for (std::size_t k = 0; k < kBudgetParts.size(); ++k) s.budget.*kBudgetParts[k].value = parts_[k].value();
  }

 private:
  Rms u_;
  std::array<Rms, kBudgetParts.size()> parts_;
  long rows_ = 0;
};

// Standard deviation of the measured values of one axis (Welford 1962).
class Scatter {
 public:
  void add(double v) {
    if (std::isnan(v)) return;
    ++count_;
    const double from_mean = v - mean_;
    mean_ += from_mean / double(count_);
    squares_ += from_mean * (v - mean_);
  }
  [[nodiscard]] double rms() const { return count_ > 0 ? std::sqrt(squares_ / double(count_)) : kNotMeasured; }

 private:
  long count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

void widen(double& lowest, double& highest, double v) {
  lowest = std::fmin(lowest, v);  // fmin and fmax ignore NaN
  highest = std::fmax(highest, v);
}

}  // namespace

double TargetSummary::largest_movement_mm() const {
  const BoardExtent movement = peak_to_peak();
  return std::fmax(0.0, std::fmax(movement.x, movement.y));  // fmax ignores NaN
}

std::vector<std::size_t> by_movement(const std::vector<TargetSummary>& targets) {
  std::vector<std::size_t> order(targets.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return targets[a].largest_movement_mm() > targets[b].largest_movement_mm();
  });
  return order;
}

std::vector<TargetSummary> summarise(const Reference& reference, const Samples& samples) {
  std::vector<TargetSummary> summaries;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (reference.site.markers[i].role != Role::kTarget) continue;
    TargetSummary s;
    s.marker = i;
    s.lowest = s.highest = {kNotMeasured, kNotMeasured};
    Sums of_ok, of_all;
    Scatter x, y;
    for (const Sample& sample : samples) {
      if (sample.marker != i) continue;
      ++s.frames;
      s.ok += sample.status == Status::kOk;
      ++s.status_counts[word_for(sample.status)];
      if (!has_numbers(sample.status)) continue;
      if (sample.status == Status::kOk) {
        widen(s.lowest.x, s.highest.x, sample.displacement.x);
        widen(s.lowest.y, s.highest.y, sample.displacement.y);
        x.add(sample.displacement.x);
        y.add(sample.displacement.y);
      }
      if (sample.frame == reference.seen.frame) continue;
      of_all.add(sample);
      if (sample.status == Status::kOk) of_ok.add(sample);
    }
    s.rms = {x.rms(), y.rms()};
    (of_ok.is_empty() ? of_all : of_ok).put(s);
    summaries.push_back(std::move(s));
  }
  return summaries;
}

Exit exit_of(const Samples& samples, long reference_frame, bool input_damaged) {
  long rows = 0, ok = 0;
  for (const Sample& sample : samples) {
    if (sample.frame == reference_frame) continue;
    ++rows;
    ok += sample.status == Status::kOk;
  }
  if (ok == 0) return Exit::kRefused;
  if (input_damaged || double(rows - ok) > kNotOkShare * double(rows)) return Exit::kIncomplete;
  return Exit::kMeasured;
}

}  // namespace moiregauge::internal
