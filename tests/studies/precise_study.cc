// SPDX-License-Identifier: Apache-2.0
// Prints one row of a Markdown table per case whose name begins with WORD.
//
//     precise_study [--set KEY=VALUE]... [--cases WORD] [--runs N] [--coverage N] [--seed S] [--method M] [--no-draw]
//                   [--noise-free] [--template auto|on|off] [--verbose]
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "common/simulated_run.h"
#include "moiregauge/simulator/scenario/settings.h"
#include "studies/lens.h"
#include "studies/precise_bounds.h"
#include "studies/precise_cases.h"

namespace moiregauge::internal::study {
namespace {

struct Words {
  std::string cases;
  std::string method = "precise";
  std::string template_use = "auto";
  int runs = -1;
  int coverage = -1;
  int seed = 1;
  bool noise_free = false;
  bool no_draw = false;  // no errors are drawn: the site is exact
  bool verbose = false;
  std::vector<std::string> settings;  // applied to all scenarios, "KEY=VALUE" as for moiregauge simulate --set
};

bool apply(const std::string& assignment, simulator::Scenario& scenario) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) return false;
  for (const auto& setting : simulator::settings_of(scenario)) {
    if (setting.name == assignment.substr(0, equals)) return setting.set(assignment.substr(equals + 1));
  }
  return false;
}

constexpr double kUmPerPitch = 10000.0;

struct AxisErrors {
  std::vector<double> about_mean, raw, u, bound;
  int inside = 0;
};

// Sums over many runs of one case.
struct CaseTally {
  AxisErrors x, y;
  int rows = 0, ok = 0, wrong_orders = 0, lies = 0, covered_ok = 0, problems = 0, runs = 0;
  std::map<std::string, int> models, statuses;
  std::map<std::string, std::vector<double>> budget_y, budget_x;
};

void add_axis(AxisErrors& axis, const std::vector<double>& errors, const std::vector<double>& u) {
  double mean = 0.0;
  for (const double e : errors) mean += e / static_cast<double>(errors.size());
  for (std::size_t k = 0; k < errors.size(); ++k) {
    axis.about_mean.push_back(errors[k] - mean);
    axis.raw.push_back(errors[k]);
    axis.u.push_back(u[k]);
    axis.inside += std::abs(errors[k]) < 1.96 * u[k];
  }
}

bool is_covered(const simulator::Scenario& s, const test::MeasuredRun& run, const Sample& sample) {
  const auto* marker = simulator::find_marker(s, run.reference.site.markers[sample.marker].name);
  for (const auto& span : marker->cover.frames) {
    if (sample.frame >= span.from && sample.frame < span.to) return true;
  }
  return false;
}

void add_run(CaseTally& tally, const simulator::Scenario& s, const test::MeasuredRun& run) {
  ++tally.runs;
  tally.problems += !run.problem.empty();
  std::vector<double> ex, ey, ux, uy;
  std::size_t number = 0;
  for (const Sample& sample : run.samples) {
    const bool covered = is_covered(s, run, sample), ok = sample.status == Status::kOk;
    tally.rows += !covered;
    ++tally.statuses[word_for(sample.status)];
    const std::size_t k = number;
    number += has_numbers(sample.status);
    if (!ok) continue;
    if (covered) {
      ++tally.covered_ok;
      continue;
    }
    ++tally.ok;
    ex.push_back(run.error_x_um[k]);
    ey.push_back(run.error_y_um[k]);
    ux.push_back(run.u_x_um[k]);
    uy.push_back(run.u_y_um[k]);
    const auto is_lie = [](double error, double u) { return std::abs(error) > std::max(5.0 * u, 0.5); };
    tally.lies += is_lie(ex.back(), ux.back()) || is_lie(ey.back(), uy.back());
    tally.wrong_orders += std::max(std::abs(ex.back()), std::abs(ey.back())) > 0.5 * kUmPerPitch;
    for (const BudgetPart& part : kBudgetParts) {
      tally.budget_x[part.name].push_back(1000.0 * (sample.budget.*part.value).x);
      tally.budget_y[part.name].push_back(1000.0 * (sample.budget.*part.value).y);
    }
  }
  add_axis(tally.x, ex, ux);
  add_axis(tally.y, ey, uy);
  ++tally.models[run.solution.scene ? run.solution.scene->solved ? run.solution.scene->model.name() : "unsolved" : "-"];
}

test::RunPlan plan_of(const PreciseCase& c, const Words& words) {
  test::RunPlan plan;
  plan.method = words.method;
  plan.grain = words.noise_free ? test::Grain::kNoiseFree : test::Grain::kSensor;
  plan.observe.template_use = template_use_named(words.template_use).value_or(TemplateUse::kAuto);
  plan.frames = c.frames;
  plan.step = c.step;
  plan.solve.rest = c.rest;
  plan.solve.readout_s = c.readout_s;
  if (c.lens_known) plan.lens = lens_of(c.scenario.camera);
  return plan;
}

void tell_case(const simulator::Scenario& s, const test::MeasuredRun& run) {
  std::fprintf(stderr, "  seed %llu: scatter %.3f %.3f raw %.3f %.3f u %.3f %.3f ",
               static_cast<unsigned long long>(s.seed), test::scatter(run.error_x_um), test::scatter(run.error_y_um),
               test::rms(run.error_x_um), test::rms(run.error_y_um), test::rms(run.u_x_um), test::rms(run.u_y_um));
  if (run.solution.scene) {
    const Scene& scene = *run.solution.scene;
    const auto u = [&](int i) { return i < scene.covariance.rows() ? std::sqrt(scene.covariance(i, i)) : 0.0; };
    std::fprintf(stderr, "%s chi2/dof %.2f f %.1f+-%.1f c %.1f+-%.1f %.1f k %.4f+-%.4f %.3f p %.5f+-%.5f %.5f %s",
                 scene.model.name().c_str(), scene.chi2_dof, scene.camera.fx, u(0), scene.camera.cx, u(1),
                 scene.camera.cy, scene.camera.k1, u(3), scene.camera.k2, scene.camera.p1, u(5), scene.camera.p2,
                 scene.problem.c_str());
  }
  std::fprintf(stderr, "%s\n", run.problem.c_str());
  for (const std::string& note : run.solution.notes) std::fprintf(stderr, "    %s\n", note.c_str());
}

// Returns u of a lens that is known to a millionth.
std::array<double, kCameraParameters> exact_lens(const Camera& lens) {
  std::array<double, kCameraParameters> u{};
  u.fill(1e-6);
  for (std::size_t k = 0; k < 3; ++k) u[k] *= lens.fx;  // f and the principal point, px
  return u;
}

// Makes the long runs. Only positions are drawn; gratings and heights are exact, so that the remaining errors are those of
// the method. In frames of large rotations an uncertain height of the target would dominate. A lens that is known to its
// usual u would be solved within it. The bound is that of the measured frames. The full bound requires four images per
// marker, so it is computed for every tenth frame only.
CaseTally long_runs(const PreciseCase& c, const Words& words) {
  CaseTally tally;
  const int runs = words.runs >= 0 ? words.runs : c.runs;
  for (int n = 0; n < runs; ++n) {
    simulator::Scenario s = redrawn(c.scenario, words.seed + n);
    s.draw.position = !words.no_draw;
    if (c.heights_known) state_heights(s, 0.001);
    test::RunPlan plan = plan_of(c, words);
    if (c.lens_known) plan.solve.u_camera = exact_lens(lens_of(s.camera));
    const test::MeasuredRun run = test::measured(s, plan);
    if (words.verbose) tell_case(s, run);
    add_run(tally, s, run);
    const bool full = c.bound == Bound::kFull;
    for (std::size_t k = 0; k < run.samples.size(); k += full ? 10 : 1) {
      const auto bound = full ? full_bound_um(s, run.samples[k].frame) : phase_bound_um(s, run.samples[k].frame);
      tally.x.bound.push_back(bound.x);
      tally.y.bound.push_back(bound.y);
    }
  }
  return tally;
}

// Makes the short runs. All values of [known_to] are drawn.
CaseTally short_runs(const PreciseCase& c, const Words& words) {
  CaseTally tally;
  const int runs = words.coverage >= 0 ? words.coverage : c.coverage_runs;
  for (int n = 0; n < runs; ++n) {
    simulator::Scenario s = redrawn(c.scenario, 100000 + words.seed + n);
    if (!words.no_draw) s.draw = {.position = true, .rotation = true, .height = true, .print_scale = true};
    test::RunPlan plan = plan_of(c, words);
    plan.frames = c.coverage_frames;
    plan.step = c.coverage_step;
    const test::MeasuredRun run = test::measured(s, plan);
    if (words.verbose) tell_case(s, run);
    add_run(tally, s, run);
  }
  return tally;
}

std::string models_of(const CaseTally& tally) {
  std::string text;
  for (const auto& [name, count] : tally.models) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  return text;
}

std::string share(int part, std::size_t whole) {
  return whole == 0 ? "-" : fmt::format("{:.1f}", 100.0 * part / static_cast<double>(whole));
}

void print_budget(const char* what, const CaseTally& tally) {
  std::fprintf(stderr, "  %s budget x / y, rms um:", what);
  for (const BudgetPart& part : kBudgetParts) {
    const auto x = tally.budget_x.find(part.name), y = tally.budget_y.find(part.name);
    if (x != tally.budget_x.end())
      std::fprintf(stderr, " %s %.3f/%.3f", part.name, test::rms(x->second), test::rms(y->second));
  }
  for (const auto& [status, count] : tally.statuses) std::fprintf(stderr, " %s: %d", status.c_str(), count);
  std::fprintf(stderr, "\n");
}

void print_row(const PreciseCase& c, const Words& words) {
  const CaseTally run = long_runs(c, words), brief = short_runs(c, words);
  const double bx = test::rms(run.x.bound), by = test::rms(run.y.bound);
  const double sx = test::rms(run.x.about_mean), sy = test::rms(run.y.about_mean);
  fmt::print(
      "| {} | {} | {} x {} | {} | {:.2f} | {:.2f} | {:.3f} / {:.3f} | {:.3f} / {:.3f} | {:.2f} / {:.2f} | {:.2f} / "
      "{:.2f} | "
      "{} / {} ({}) | {:.2f} / {:.2f} | {:.2f} / {:.2f} | {} | {} | {}; {} |\n",
      c.name, c.gate, run.runs, c.frames, share(run.ok, static_cast<std::size_t>(run.rows)), sy / by, sx / bx, sy, sx,
      by, bx, test::rms(run.y.raw), test::rms(run.x.raw), test::rms(run.y.u), test::rms(run.x.u),
      share(brief.y.inside, brief.y.raw.size()), share(brief.x.inside, brief.x.raw.size()), brief.runs,
      test::rms(brief.y.raw), test::rms(brief.x.raw), test::rms(brief.y.u), test::rms(brief.x.u),
      share(brief.ok, static_cast<std::size_t>(brief.rows)), run.lies + brief.lies,
      fmt::format("{} wrong orders, {} covered ok, {} refused", run.wrong_orders + brief.wrong_orders, run.covered_ok,
                  run.problems + brief.problems),
      models_of(run));
  std::fflush(stdout);
  if (!words.verbose) return;
  print_budget("long", run);
  print_budget("short", brief);
}

Words words_of(int argc, char** argv) {
  Words words;
  const std::map<std::string, int*> numbers{
      {"--runs", &words.runs}, {"--coverage", &words.coverage}, {"--seed", &words.seed}};
  const std::map<std::string, std::string*> texts{
      {"--cases", &words.cases}, {"--method", &words.method}, {"--template", &words.template_use}};
  const std::map<std::string, bool*> flags{
      {"--noise-free", &words.noise_free}, {"--no-draw", &words.no_draw}, {"--verbose", &words.verbose}};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (const auto flag = flags.find(word); flag != flags.end()) {
      *flag->second = true;
    } else if (word == "--set" && has_value) {
      words.settings.emplace_back(argv[++i]);
    } else if (const auto number = numbers.find(word); number != numbers.end() && has_value) {
      *number->second = std::atoi(argv[++i]);
    } else if (const auto text = texts.find(word); text != texts.end() && has_value) {
      *text->second = argv[++i];
    } else {
      std::fprintf(stderr,
                   "error: bad option: %s: --cases WORD, --runs N, --coverage N, --seed S, --method M, --template "
                   "WORD, --noise-free or "
                   "--verbose\n",
                   word.c_str());
      std::exit(2);
    }
  }
  return words;
}

int study(const Words& words) {
  if (method_named(words.method) == nullptr) {
    std::fprintf(stderr, "error: no such method: %s: name one of moiregauge measure --help\n", words.method.c_str());
    return 2;
  }
  fmt::print(
      "| case | gate | runs x frames | % ok | dy ratio | dx ratio | dy / dx scatter, um | bound | dy / dx raw rms | "
      "mean u | "
      "% inside 1.96 u, dy / dx (short runs) | short: raw rms | u | % ok | lies | rows; models |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  int found = 0;
  for (PreciseCase c : precise_cases()) {
    if (!c.name.starts_with(words.cases)) continue;
    ++found;
    for (const std::string& setting : words.settings) {
      if (apply(setting, c.scenario)) continue;
      std::fprintf(stderr, "error: bad setting: --set %s: see docs/cli/simulate.md\n", setting.c_str());
      return 2;
    }
    print_row(c, words);
  }
  if (found > 0) return 0;
  std::fprintf(stderr, "error: no such case: %s: known are", words.cases.c_str());
  for (const PreciseCase& c : precise_cases()) std::fprintf(stderr, " %s", c.name.c_str());
  std::fprintf(stderr, "\n");
  return 2;
}

}  // namespace
}  // namespace moiregauge::internal::study

int main(int argc, char** argv) {
  return moiregauge::internal::study::study(moiregauge::internal::study::words_of(argc, argv));
}
