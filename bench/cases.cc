// SPDX-License-Identifier: Apache-2.0
#include "cases.h"

#include <cmath>
#include <utility>

namespace moiregauge::internal::bench {
namespace {

// Each repetition continues at the next frame, because a camera does not jump back.
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
    // Another case of the same work may have left the tracking at another frame. Two frames correct that.
    for (int n = 0; n < 2; ++n) frame(now, shots);
    std::size_t lost = 0;
    for (auto _ : state) lost += frame(now, shots) ? 0 : 1;
    state.counters["lost"] = static_cast<double>(lost) / static_cast<double>(state.iterations());
    state.counters["bytes"] = static_cast<double>(now.bytes);
  }
};

struct Errors {
  Error rms{};
  Error scatter{};
};

Errors errors_of(const Work& work, const Recording& recording) {
  const auto n = static_cast<double>(recording.frames());
  Error sum{}, squares{};
  for (std::size_t i = 0; i < recording.frames(); ++i) {
    const Error error = work.error(recording.shots(Memory::kRing)[i]);
    for (std::size_t k = 0; k < 2; ++k) sum[k] += error[k], squares[k] += error[k] * error[k];
  }
  Errors errors;
  for (std::size_t k = 0; k < 2; ++k) {
    errors.rms[k] = std::sqrt(squares[k] / n);
    errors.scatter[k] = std::sqrt((squares[k] - sum[k] * sum[k] / n) / (n - 1.0));
  }
  return errors;
}

// Work shared by the cases of one size, made once, with its errors.
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
        const Errors& errors = shared->errors;
        for (const auto& [axis, k] : {std::pair("x_", 0), std::pair("y_", 1)}) {
          state.counters[std::string("error_") + axis + shared->work->error_unit] = errors.rms[std::size_t(k)];
          state.counters[std::string("scatter_") + axis + shared->work->error_unit] = errors.scatter[std::size_t(k)];
        }
        state.counters["error_frames"] = static_cast<double>(Recording::of(one->size).frames());
      };
      benchmark::RegisterBenchmark((name + "/" + size.name() + "/" + word_for(memory)).c_str(), run)
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

std::shared_ptr<Work> detection_of(const Recording& recording, FindCentres find) {
  auto work = std::make_shared<Work>();
  work->bytes = recording.frame_bytes();
  work->error_unit = "px";
  work->frame = [find](const Shot& shot) { return find(shot).has_value(); };
  work->error = [&recording, find](const Shot& shot) {
    return recording.circle_error(find(shot).value_or(std::vector<ImagePoint>{}), shot.frame);
  };
  return work;
}

}  // namespace moiregauge::internal::bench
