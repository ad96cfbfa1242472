// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/batch/batch_display.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

namespace moiregauge::internal::cli {
namespace {

BatchTotals totals_of(const std::map<Lamp, std::size_t>& count) {
  BatchTotals totals;
  totals.count = count;
  for (const auto& [lamp, clips] : count) totals.clips += clips;
  return totals;
}

TEST(BatchDisplay, TheExitCodeIsThatOfAllClips) {
  EXPECT_EQ(exit_of_batch(totals_of({{Lamp::kMeasured, 3}})), Exit::kMeasured);
  EXPECT_EQ(exit_of_batch(totals_of({{Lamp::kMeasured, 3}, {Lamp::kFailed, 1}})), Exit::kIncomplete);
  EXPECT_EQ(exit_of_batch(totals_of({{Lamp::kMeasured, 3}, {Lamp::kWaiting, 1}})), Exit::kIncomplete);
  EXPECT_EQ(exit_of_batch(totals_of({{Lamp::kIncomplete, 2}})), Exit::kIncomplete);
  EXPECT_EQ(exit_of_batch(totals_of({{Lamp::kRefused, 1}, {Lamp::kFailed, 1}})), Exit::kRefused);
  EXPECT_EQ(exit_of_batch(totals_of({{Lamp::kRefused, 1}, {Lamp::kWaiting, 1}})), Exit::kIncomplete)
      << "one may still be measured";
}

TEST(BatchDisplay, TheRemainingTimeCountsOnlyClipsMeasuredNow) {
  // 10 clips in 20 s, and 30 of 100 are left: 60 s. The 60 skipped clips took no time.
  const BatchProgress progress{.clips = 100, .skipped = 60, .ended = 10, .failed = 3, .running = 2};
  EXPECT_EQ(batch_line(progress, 20.0),
            "batch [################........] 70/100 clips, 3 failed, 2 running, 60 s left");
  EXPECT_EQ(batch_line({.clips = 4, .skipped = 0, .ended = 0, .failed = 0, .running = 2}, 1.0),
            "batch [........................] 0/4 clips, 2 running");
}

TEST(BatchDisplay, AClipThatAnotherProcessMeasuresIsNamed) {
  EXPECT_EQ(busy_text({}, "out"), "");
  EXPECT_EQ(busy_text({"a"}, "out"),
            "warning: a is not measured so far: another process is measuring into out/a.unfinished. Repeat the command "
            "when it has ended.\n");
  const std::string many = busy_text(std::vector<std::string>(7, "a"), "out");
  EXPECT_EQ(std::count(many.begin(), many.end(), '\n'), 6);
  EXPECT_NE(many.find("2 more clips"), std::string::npos);
}

TEST(BatchDisplay, TheFinalLinesNameOutcomesAndFailures) {
  BatchTotals totals = totals_of({{Lamp::kMeasured, 2}, {Lamp::kFailed, 1}});
  totals.exit_codes = {{3, 1}};
  totals.failures = {{"a", "no frame"}};
  EXPECT_EQ(totals_text(totals, 1, "out"),
            "found: 3 clips in out (1 finished before)\nresult: 2 measured, 1 failed\n"
            "        exit 3: 1 clip (input unreadable or unsupported)\n        a: no frame\n"
            "next: open out/index.html in a browser; out/batch.csv has one row per clip and target\n");
}

}  // namespace
}  // namespace moiregauge::internal::cli
