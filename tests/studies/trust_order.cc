// SPDX-License-Identifier: Apache-2.0
#include "studies/trust_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include <fmt/format.h>

#include "studies/in_parallel.h"
#include "studies/jumping_targets.h"

namespace moiregauge::internal::study {
namespace {

constexpr double kWrong = 0.25;  // pitches; a larger error is a wrong fringe order

struct OrderRow {
  const char* name;
  JumpKind kind;
  double share;  // among all samples
};

constexpr std::array kRows{
    OrderRow{"grid, 29 px", {.pattern = Pattern::kGrid, .pitch_mm = 10.0, .pitches = 3}, 0.03},
    OrderRow{"grid, 14 px", {.pattern = Pattern::kGrid, .pitch_mm = 5.0}, 0.12},
    OrderRow{"grid, 10 px", {.pattern = Pattern::kGrid, .pitch_mm = 3.5}, 0.15},
    OrderRow{"squares, 10 px, 6 pitches", {.pattern = Pattern::kSquares, .pitch_mm = 3.5, .pitches = 6}, 0.1},
    OrderRow{"dots, 10 px", {.pattern = Pattern::kDots, .pitch_mm = 3.5}, 0.15},
    OrderRow{"checkerboard, 14 px", {.pattern = Pattern::kCheckerboard, .pitch_mm = 5.0, .noise = 3.0}, 0.1},
    OrderRow{"cosine, 10 px, noise 3", {.pattern = Pattern::kCosine, .pitch_mm = 3.5, .noise = 3.0}, 0.1},
    OrderRow{"grid, 14 px, blur 2 px", {.pattern = Pattern::kGrid, .pitch_mm = 5.0, .noise = 3.0, .psf_px = 2.0}, 0.1},
    OrderRow{"grid, 10 px, half of them covered at times",
             {.pattern = Pattern::kGrid, .pitch_mm = 3.5, .covered = 0.5},
             0.15},
};

struct Count {
  int samples = 0, ok = 0, wrong = 0, wrong_with_numbers = 0;
  std::map<std::string, int> words;
};

test::MeasuredRun run_of(const simulator::Scenario& scenario) {
  test::RunPlan plan{.method = "precise", .first = 1, .frames = kJumps};
  plan.all_targets = true;
  plan.render_threads = 1;
  return test::measured(scenario, plan);
}

Count count_of(const JumpKind& kind, int number, bool verbose) {
  Count count;
  const auto run = run_of(jumping_targets(kind, number));
  if (!run.problem.empty()) {
    ++count.words["runs refused"];
    if (verbose) std::fprintf(stderr, "  run %d refused: %s\n", number, run.problem.c_str());
    return count;
  }
  if (run.solution.scene && !run.solution.scene->solved) ++count.words[run.solution.scene->problem];
  std::size_t k = 0;
  for (const Sample& sample : run.samples) {
    ++count.samples;
    const bool ok = sample.status == Status::kOk;
    count.ok += ok;
    if (!ok) ++count.words[word_for(sample.status)];
    if (!has_numbers(sample.status)) continue;
    const double off_um = std::max(std::abs(run.error_x_um[k]), std::abs(run.error_y_um[k]));
    ++k;
    if (!(off_um > kWrong * 1000.0 * kind.pitch_mm)) continue;
    ++(ok ? count.wrong : count.wrong_with_numbers);
    if (verbose)
      std::fprintf(stderr, "  run %d frame %ld %s off by %.2f %.2f pitches, %s\n", number, sample.frame,
                   run.reference.site.markers[sample.marker].name.c_str(), 1e-3 * run.error_x_um[k - 1] / kind.pitch_mm,
                   1e-3 * run.error_y_um[k - 1] / kind.pitch_mm, word_for(sample.status));
  }
  return count;
}

void add_count(Count& sum, const Count& one) {
  sum.samples += one.samples, sum.ok += one.ok, sum.wrong += one.wrong;
  sum.wrong_with_numbers += one.wrong_with_numbers;
  for (const auto& [word, n] : one.words) sum.words[word] += n;
}

void print_order(const char* name, int targets, const Count& c) {
  std::string words;
  for (const auto& [word, n] : c.words) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", n, word);
  fmt::print("| {} | {} | {} | {} | {} | {} | {} |\n", name, targets, c.samples, c.ok, c.wrong, c.wrong_with_numbers,
             words);
  std::fflush(stdout);
}

}  // namespace

void print_orders(int samples, const std::string& only, bool verbose) {
  fmt::print(
      "| print | targets | samples | ok | ok and off by over P/4 | off and not called ok | not ok "
      "|\n|---|---|---|---|---|---|---|\n");
  Count all;
  for (const OrderRow& row : kRows) {
    if (!std::string(row.name).starts_with(only)) continue;
    const auto markers = jumping_targets(row.kind, 0).markers.size();
    const int targets = static_cast<int>(markers) - 4;
    const int runs = static_cast<int>(std::ceil(samples * row.share / static_cast<double>(targets * kJumps)));
    Count sum;
    for (const Count& c : in_parallel(row.name, runs, [&](int n) { return count_of(row.kind, n, verbose); }))
      add_count(sum, c);
    print_order(row.name, targets, sum);
    add_count(all, sum);
  }
  print_order("all", 0, all);
}

}  // namespace moiregauge::internal::study
