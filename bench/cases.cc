// SPDX-License-Identifier: Apache-2.0
#include "cases.h"

#include <cmath>

namespace moiregauge::bench {
namespace {

// Goes on through the frames from repetition to repetition: a camera does not jump back either.
struct Case {
  const Size size;
  const Memory memory;
  const std::function<std::shared_ptr<Work>()> work;
  std::size_t next = 0;

  bool frame(const Work& now, const std::vector<Shot>& shots) {
    const bool seen = now.frame(shots[next]);
    next = (next + 1) % shots.size();
    return seen;
  }

  void run(benchmark::State& state) {
    const std::vector<Shot>& shots = Recording::of(size).shots(memory);
    const Work& now = *work();
    // Another case of the same work may have left its memory of the past elsewhere: two frames bring it here.
    for (int n = 0; n < 2; ++n) frame(now, shots);
    std::size_t lost = 0;
    for (auto _ : state) lost += frame(now, shots) ? 0 : 1;
    state.counters["lost"] = static_cast<double>(lost) / static_cast<double>(state.iterations());
    state.counters["bytes"] = static_cast<double>(now.bytes);
  }
};

struct Errors {
  double rms = 0.0;
  double scatter = 0.0;
};

Errors errors_of(const Work& work, const Recording& recording) {
  const auto n = static_cast<double>(recording.frames());
  double squares = 0.0;
  Error sum{};
  for (std::size_t i = 0; i < recording.frames(); ++i) {
    const Error error = work.error(recording.shots(Memory::kRing)[i]);
    for (std::size_t k = 0; k < 2; ++k) squares += error[k] * error[k], sum[k] += error[k];
  }
  const double mean = (sum[0] * sum[0] + sum[1] * sum[1]) / n;
  return {std::sqrt(squares / (2.0 * n)), std::sqrt((squares - mean) / (2.0 * (n - 1.0)))};
}

// Made once, with its errors.
struct Shared {
  std::shared_ptr<Work> work;
  Errors errors;
};

}  // namespace

void add_cases(const std::string& name, std::initializer_list<Memory> memories, const MakeWork& make) {
  for (const Size& size : kSizes) {
    const auto shared = std::make_shared<Shared>();
    const auto work = [shared, make, size] {
      if (!shared->work) {
        shared->work = make(Recording::of(size));
        if (shared->work->error) shared->errors = errors_of(*shared->work, Recording::of(size));
      }
      return shared->work;
    };
    for (const Memory memory : memories) {
      const auto one = std::make_shared<Case>(Case{size, memory, work});
      const auto run = [one, shared](benchmark::State& state) {
        one->run(state);
        if (!shared->work->error) return;
        state.counters["error_" + shared->work->error_unit] = shared->errors.rms;
        state.counters["scatter_" + shared->work->error_unit] = shared->errors.scatter;
      };
      benchmark::RegisterBenchmark((name + "/" + size.name() + "/" + word_for(memory)).c_str(), run)
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

}  // namespace moiregauge::bench
