// SPDX-License-Identifier: Apache-2.0
// Runs independent parts of a study on two threads. The results do not depend on the number of threads.
#pragma once

#include <atomic>
#include <cstdio>
#include <thread>
#include <utility>
#include <vector>

namespace moiregauge::internal::study {

// Returns the results of run(0) to run(count - 1) in order. Reports the progress on stderr in steps of 10 %.
template <typename Run>
auto in_parallel(const char* what, int count, Run run) {
  std::vector<decltype(run(0))> results(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 2; ++t) {
      threads.emplace_back([&] {
        for (int n = next++; n < count; n = next++) {
          results[static_cast<std::size_t>(n)] = run(n);
          if (count >= 10 && n % (count / 10) == 0) std::fprintf(stderr, "%s: %d of %d\n", what, n, count);
        }
      });
    }
  }
  return results;
}

}  // namespace moiregauge::internal::study
