// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/jobs/kept_samples.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

using Events = std::vector<std::string>;

Events kept_of_six(KeptSamples::Keep keep) {
  constexpr std::size_t kMaxBytes = 5;
  KeptSamples samples;
  for (const char* event : {"0", "1", "2", "3", "4", "5"}) samples.add(event, keep, kMaxBytes);
  return samples.events();
}

TEST(KeptSamples, KeepEverySecondEventOfALongRun) {
  EXPECT_EQ(kept_of_six(KeptSamples::Keep::kWhole), (Events{"0", "2", "4"}));
}

TEST(KeptSamples, KeepTheNewestHalfOfALiveSource) {
  EXPECT_EQ(kept_of_six(KeptSamples::Keep::kNewest), (Events{"3", "4", "5"}));
}

TEST(KeptSamples, StayBelowTheLimit) {
  constexpr std::size_t kMaxBytes = 100;
  KeptSamples samples;
  for (int n = 0; n < 1000; ++n) {
    samples.add("0123456789", KeptSamples::Keep::kWhole, kMaxBytes);
    EXPECT_LE(samples.events().size() * 10, kMaxBytes);
  }
  samples.clear();
  EXPECT_TRUE(samples.events().empty());
}

}  // namespace
}  // namespace moiregauge::internal
