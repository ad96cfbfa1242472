// SPDX-License-Identifier: Apache-2.0
// identity_study [SCENES [FIRST_SEED]]: counts the identification results in random crowded scenes, with and without
// the site file. Every fifth scene is repeated with a missing reference circle, which must be refused.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "common/identity_verdict.h"

namespace moiregauge::internal::test {
namespace {

struct Counts {
  std::array<int, 4> of_verdict{};
  double worst_error_mm = 0.0;  // mm, over correctly identified scenes
  int not_measured = 0;
};

void count(const IdentityVerdict& v, Counts& counts) {
  ++counts.of_verdict[static_cast<std::size_t>(v.verdict)];
  if (v.verdict != Verdict::kRight) return;
  if (std::isnan(v.error_mm))
    ++counts.not_measured;
  else
    counts.worst_error_mm = std::max(counts.worst_error_mm, v.error_mm);
}

void print_counts(const char* name, const Counts& c) {
  std::printf("| %s | %d | %d | %d | %d | %.3f mm | %d |\n", name, c.of_verdict[0], c.of_verdict[1], c.of_verdict[2],
              c.of_verdict[3], c.worst_error_mm, c.not_measured);
}

void look_at(const CrowdedScene& scene, const Shots& shots, Knowledge knowledge, const char* name, Counts& counts) {
  const IdentityVerdict v = judged(scene, shots, knowledge);
  count(v, counts);
  if (v.verdict != Verdict::kRight)
    std::fprintf(stderr, "seed %d, %s: %s: %s (roll %.0f deg, error %.3f mm, u %.3f mm)\n",
                 static_cast<int>(scene.scenario.seed), name, word_for(v.verdict), v.words.c_str(), scene.roll_deg,
                 v.error_mm, v.u_mm);
}

}  // namespace
}  // namespace moiregauge::internal::test

int main(int argc, char** argv) {
  using namespace moiregauge::internal::test;
  const int scenes = argc > 1 ? std::atoi(argv[1]) : 1000;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  std::array<Counts, 4> counts;
  constexpr std::array kNames{"site", "pitch only", "site, a circle missing", "pitch only, a circle missing"};
  for (int i = 0; i < scenes; ++i) {
    const auto seed = static_cast<std::uint64_t>(first + i);
    const CrowdedScene scene = crowded_scene(seed);
    const Shots shots = shots_of(scene);
    look_at(scene, shots, Knowledge::kSite, kNames[0], counts[0]);
    look_at(scene, shots, Knowledge::kPitchOnly, kNames[1], counts[1]);
    if (i % 5 != 0) continue;
    const CrowdedScene faulty = crowded_scene(seed, Fault::kCircleMissing);
    const Shots faulty_shots = shots_of(faulty);
    look_at(faulty, faulty_shots, Knowledge::kSite, kNames[2], counts[2]);
    look_at(faulty, faulty_shots, Knowledge::kPitchOnly, kNames[3], counts[3]);
  }
  std::printf(
      "Seeds %d to %d.\n\n| known | right | refused | look-alike among the references | silently wrong | worst error | "
      "not measured |\n"
      "|---|---|---|---|---|---|---|\n",
      first, first + scenes - 1);
  int wrong = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    print_counts(kNames[i], counts[i]);
    wrong += counts[i].of_verdict[static_cast<std::size_t>(Verdict::kWrong)];
  }
  return wrong == 0 ? 0 : 1;
}
