// SPDX-License-Identifier: Apache-2.0
// One of our methods, frame by frame, as `measure` and `solve` run it.
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
  // For a method that solves a scene, that of the recording is solved here; what is left then is one frame's part.
  ProductChain(const Recording& recording, const Method& method);

  void observe(const Shot& shot);  // the pixels: looks, and remembers where to look next
  void track(const Shot& shot);    // of that only discs and the phases of all prints, from some of their rows
  struct Reading {
    Extent<frame::Board> displacement{kNotMeasured, kNotMeasured};
    Extent<frame::Board> u{kNotMeasured, kNotMeasured};
  };
  [[nodiscard]] Reading solve() const { return solve(seen_); }  // of the frame observed last, with its uncertainty
  [[nodiscard]] Reading solve(const Observations& one) const;

  [[nodiscard]] bool is_lost() const { return seen_.front().markers[target_].loss != Loss::kNone; }
  [[nodiscard]] std::size_t target() const { return target_; }
  [[nodiscard]] const Reference& reference() const { return reference_; }
  [[nodiscard]] const Observations& seen() const { return seen_; }  // one: the last

 private:
  void keep(Observation seen, long frame);
  [[nodiscard]] Reading solve_in_scene(const Observations& one) const;

  const Method& method_;
  Reference reference_;
  std::size_t target_ = 0;
  Follower follower_;
  PatchWorkspace work_;
  Observations seen_;
  std::optional<Scene> scene_;
  std::unique_ptr<PreciseBudget> budget_;
};

}  // namespace moiregauge::internal::bench
