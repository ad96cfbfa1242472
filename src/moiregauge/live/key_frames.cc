// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/key_frames.h"

#include <utility>

namespace moiregauge::internal {

bool KeyFrames::add(const Observation& seen, bool is_wanted) {
  if (seen_++ % stride_ != 0 && !is_wanted) return false;
  frames_.push_back(seen);
  ++added_;
  if (frames_.size() <= limits_.max_frames) return true;
  // Without times the age is NaN and never too large.
  if (seen.time_s - frames_.front().time_s > limits_.max_age_s)
    drop_oldest();
  else
    thin();
  return true;
}

void KeyFrames::thin() {
  Observations half = frames_;
  half.clear();
  for (std::size_t k = 0; k < frames_.size(); k += 2) half.append(frames_, k, k + 1);
  frames_ = std::move(half);
  stride_ *= 2;
}

void KeyFrames::drop_oldest() {
  Observations rest = frames_;
  rest.clear();
  rest.append(frames_, 1, frames_.size());
  frames_ = std::move(rest);
}

}  // namespace moiregauge::internal
