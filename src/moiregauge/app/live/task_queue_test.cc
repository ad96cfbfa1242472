// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/live/task_queue.h"

#include <atomic>
#include <vector>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(TaskQueue, CompletesTasksInOrder) {
  std::vector<int> done;
  TaskQueue queue;
  for (int n = 0; n < 100; ++n) queue.add([&done, n] { done.push_back(n); });
  queue.wait();
  EXPECT_EQ(queue.pending(), 0U);
  ASSERT_EQ(done.size(), 100U);
  for (int n = 0; n < 100; ++n) EXPECT_EQ(done[static_cast<std::size_t>(n)], n);
}

TEST(TaskQueue, CompletesAllTasksAtItsEnd) {
  std::atomic<int> done = 0;
  {
    TaskQueue queue;
    for (int n = 0; n < 50; ++n) queue.add([&done] { ++done; });
  }
  EXPECT_EQ(done, 50);
}

}  // namespace
}  // namespace moiregauge::internal
