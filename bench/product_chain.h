// SPDX-License-Identifier: Apache-2.0
// One of our methods, frame by frame, as run by `measure` and `solve`.
#pragma once

#include <memory>
#include <optional>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/displacement/precise/precise_budget.h"
#include "recording.h"

namespace moiregauge::internal::bench {

class ProductChain {
 public:
  // Prepares the method. A method with a scene solves the scene of the recording here, so that it is not timed.
  ProductChain(const Recording& recording, const Method& method);

  void observe(const Shot& shot);  // reads the pixels and predicts the next frame
  void track(const Shot& shot);    // as observe, but only discs and phases of all gratings, from some of their rows
  struct Reading {
    Extent<frame::Board> displacement{kNotMeasured, kNotMeasured};
    Extent<frame::Board> u{kNotMeasured, kNotMeasured};
  };
  // Returns displacement and u of the frame observed last.
  [[nodiscard]] Reading solve() const { return solve(seen_); }
  [[nodiscard]] Reading solve(const Observations& one) const;

  [[nodiscard]] bool is_lost() const { return seen_.front().markers[target_].loss != Loss::kNone; }
  [[nodiscard]] std::size_t target() const { return target_; }
  [[nodiscard]] const Reference& reference() const { return reference_; }
  [[nodiscard]] const Observations& seen() const { return seen_; }  // one observation: the last

 private:
  void keep(Observation seen, long frame);
  [[nodiscard]] Reading solve_in_scene(const Observations& one) const;

  const Method& method_;
  Reference reference_;
  std::size_t target_ = 0;
  Follower follower_;
  Observations seen_;
  std::optional<Scene> scene_;
  std::unique_ptr<PreciseBudget> budget_;
};

}  // namespace moiregauge::internal::bench
