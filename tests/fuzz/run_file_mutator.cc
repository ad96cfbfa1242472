// SPDX-License-Identifier: Apache-2.0
// Custom mutator of run.mgj. It sometimes inserts a new run in the current layout with all fields filled. Seeds in an
// older layout are refused at their first record.
#include <algorithm>
#include <cstdint>
#include <string>

#include "moiregauge/io/journal/run_file.h"
#include "moiregauge/io/journal/run_layout.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace moiregauge::internal {
namespace {

constexpr std::size_t kUntouched = 16;  // bytes of the file header, which the target adds
constexpr unsigned kOneInSoMany = 200;  // mutations per new run

// Reader for `store` that fills all fields: lists have `count` elements and optional values are present.
class Filler {
 public:
  static constexpr bool kReads = true;
  explicit Filler(std::size_t count) : count_(count) {}
  template <typename Number>
  void number(Number& value) {
    value = std::is_same_v<Number, int> ? Number(1) : static_cast<Number>(++last_);
  }
  [[nodiscard]] static bool flag(bool) { return true; }
  [[nodiscard]] std::size_t count(std::size_t) const { return count_; }
  void text(std::string& value) { value = "t"; }
  [[nodiscard]] static bool good() { return true; }
  void fail() {}
  void open() {}
  void close() {}

 private:
  std::size_t count_;
  long last_ = 0;
};

std::string fresh_run(std::size_t count) {
  StoredRun run;
  Filler filler(count);
  store(filler, run.start.input);
  store(filler, run.options);
  run.options.method = method_named("precise");
  store(filler, run.seen.notes);
  std::vector<Observation> observations;
  store(filler, observations);
  store(filler, run.seen.reference);
  for (CirclePoint& point : run.seen.reference->circles) point.marker = count - 1;
  const NormalMatrix normal = NormalVector::LinSpaced(1.0, 2.0).asDiagonal();
  for (auto& print : run.seen.reference->prints) {
    print->print = PrintTemplate::cosine(0.25, 0.5);
    print->at_rest->system = *PatchSystem::of(normal, 77, {.along_y = false});
  }
  std::string file = head_bytes(run.start, run.options) + reference_bytes(*run.seen.reference, run.seen.notes);
  run.seen.observations.refer_to(*run.seen.reference);
  for (const Observation& seen : observations) run.seen.observations.push_back(seen);
  for (std::size_t n = 0; n < observations.size(); ++n) file += frame_bytes(run.seen.observations.packed(n));
  return file + end_bytes(run.seen, run.options);
}

}  // namespace
}  // namespace moiregauge::internal

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  if (size < 2 || seed % moiregauge::internal::kOneInSoMany == 0) {
    const std::string fresh =
        std::string(1, '\0') + moiregauge::internal::fresh_run(1 + seed / moiregauge::internal::kOneInSoMany % 2)
                                   .substr(moiregauge::internal::kUntouched);
    if (fresh.size() <= most) {
      std::copy(fresh.begin(), fresh.end(), data);
      return fresh.size();
    }
  }
  return LLVMFuzzerMutate(data, size, most);
}
