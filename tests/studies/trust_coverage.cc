// SPDX-License-Identifier: Apache-2.0
#include "studies/trust_coverage.h"

#include <cmath>
#include <cstdio>
#include <map>

#include <fmt/format.h>

#include "studies/in_parallel.h"
#include "studies/trust_scenarios.h"

namespace moiregauge::internal::study {
namespace {

constexpr double kInterval = 1.96;  // coverage factor k for 95 % of a normal distribution

struct Axis {
  std::vector<double> error, u;  // um
  int inside = 0;                // number of errors below kInterval u
  std::vector<double> share;     // coverage per run
};

// Returns the standard error of the coverage from the scatter between runs. Frames of one run are not independent,
// because they share the drawn values.
double standard_error(const Axis& axis) { return test::scatter(axis.share) / std::sqrt(double(axis.share.size())); }

struct Tally {
  Axis x, y;
  int rows = 0, ok = 0, lies = 0, refused = 0;
  std::map<std::string, int> words;  // models, problems, statuses
  std::map<std::string, std::vector<double>> budget_x, budget_y;
};

bool is_lie(double error, double u) { return std::abs(error) > std::max(5.0 * u, 0.5); }

void add(Axis& axis, const std::vector<double>& error, const std::vector<double>& u,
         const std::vector<std::size_t>& ok) {
  int inside = 0;
  for (const std::size_t k : ok) {
    axis.error.push_back(error[k]);
    axis.u.push_back(u[k]);
    inside += std::abs(error[k]) < kInterval * u[k];
  }
  axis.inside += inside;
  if (!ok.empty()) axis.share.push_back(inside / static_cast<double>(ok.size()));
}

void add(Tally& tally, const test::MeasuredRun& run) {
  if (!run.problem.empty()) {
    ++tally.refused, ++tally.words[run.problem];
    return;
  }
  std::vector<std::size_t> ok;
  std::size_t number = 0;
  for (const Sample& sample : run.samples) {
    ++tally.rows;
    const std::size_t k = number;
    number += has_numbers(sample.status);
    if (sample.status != Status::kOk) {
      ++tally.words[word_for(sample.status)];
      continue;
    }
    ++tally.ok;
    ok.push_back(k);
    tally.lies += is_lie(run.error_x_um[k], run.u_x_um[k]) || is_lie(run.error_y_um[k], run.u_y_um[k]);
    for (const BudgetPart& part : kBudgetParts) {
      tally.budget_x[part.name].push_back(1000.0 * (sample.budget.*part.value).x);
      tally.budget_y[part.name].push_back(1000.0 * (sample.budget.*part.value).y);
    }
  }
  add(tally.x, run.error_x_um, run.u_x_um, ok);
  add(tally.y, run.error_y_um, run.u_y_um, ok);
  ++tally.words[run.solution.scene
                    ? run.solution.scene->solved ? run.solution.scene->model.name() : run.solution.scene->problem
                    : "-"];
}

std::string coverage(const Axis& axis) {
  return fmt::format("{:.1f} +- {:.1f}", 100.0 * axis.inside / double(axis.error.size()), 100.0 * standard_error(axis));
}

void tell(const TrustScenario& kind, const Tally& tally) {
  std::fprintf(stderr, "%s:", kind.name.c_str());
  for (const BudgetPart& part : kBudgetParts) {
    const auto x = tally.budget_x.find(part.name), y = tally.budget_y.find(part.name);
    if (x != tally.budget_x.end())
      std::fprintf(stderr, " %s %.2f/%.2f", part.name, test::rms(x->second), test::rms(y->second));
  }
  for (const auto& [word, count] : tally.words) std::fprintf(stderr, "; %d %s", count, word.c_str());
  std::fprintf(stderr, "\n");
}

void tell(const TrustScenario& kind, int number, const test::MeasuredRun& run) {
  const Scene scene = run.solution.scene.value_or(Scene{});
  std::fprintf(stderr, "  %s %d: error %.2f %.2f u %.2f %.2f; %s chi2/dof %.2f f %.0f k1 %.3f k2 %.2f, %zu rows %s\n",
               kind.name.c_str(), number, test::rms(run.error_x_um), test::rms(run.error_y_um), test::rms(run.u_x_um),
               test::rms(run.u_y_um), scene.model.name().c_str(), scene.chi2_dof, scene.camera.fx, scene.camera.k1,
               scene.camera.k2, run.error_x_um.size(), scene.problem.c_str());
}

}  // namespace

void print_coverage(int runs, const std::string& only, bool verbose) {
  fmt::print(
      "| scenario | what | runs | rows, ok | % inside 1.96 u: dx | dy | dx: rms error, rms u, um | dy | lies | refused "
      "|\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const TrustScenario& kind : trust_scenarios()) {
    if (!kind.name.starts_with(only)) continue;
    const auto measured = in_parallel(kind.name.c_str(), runs, [&](int n) {
      const DrawnRun run = drawn_run(kind, n);
      return test::measured(run.scenario, run.plan);
    });
    Tally tally;
    for (std::size_t n = 0; n < measured.size(); ++n) {
      add(tally, measured[n]);
      if (verbose) tell(kind, static_cast<int>(n), measured[n]);
    }
    const auto size = [](const Axis& a) { return fmt::format("{:.2f}, {:.2f}", test::rms(a.error), test::rms(a.u)); };
    fmt::print("| {} | {} | {} | {}, {:.1f} % | {} | {} | {} | {} | {} | {} |\n", kind.name, kind.what, runs,
               tally.rows, 100.0 * tally.ok / std::max(1, tally.rows), coverage(tally.x), coverage(tally.y),
               size(tally.x), size(tally.y), tally.lies, tally.refused);
    std::fflush(stdout);
    if (verbose) tell(kind, tally);
  }
}

}  // namespace moiregauge::internal::study
