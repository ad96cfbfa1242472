// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/processing_doubt.h"

namespace moiregauge::internal {

void ProcessingDoubt::apply(const CameraProcessing& processing, bool is_lossy, const FrameMovement& movement,
                            Samples& samples) {
  if (samples.empty()) return;
  Samples window;
  for (const Samples& before : last_) window.insert(window.end(), before.begin(), before.end());
  const auto first = static_cast<std::ptrdiff_t>(window.size());
  window.insert(window.end(), samples.begin(), samples.end());
  last_.push_back(samples);
  if (last_.size() > kLagSamples) last_.pop_front();
  if (distrust_processed(
          processing, is_lossy, [&movement] { return std::vector{movement}; }, window))
    samples.assign(window.begin() + first, window.end());
}

long ProcessingDoubt::first_frame() const { return last_.empty() ? 0 : last_.front().front().frame; }

}  // namespace moiregauge::internal
