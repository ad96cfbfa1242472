// SPDX-License-Identifier: Apache-2.0
// Tests true and false statements of the user on simulated footage. Prints a Markdown table with the number of runs in
// which the program contradicts the statement, one row per case.
//
//     statement_study [--runs N] [--only WORD] [--seed S] [--verbose]
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "common/simulated_run.h"

namespace moiregauge::internal {
namespace {

using simulator::Scenario;

struct StudyArgs {
  int runs = 40;
  std::string only;
  int seed = 1;
  bool verbose = false;
};

struct RestCase {
  std::string name;
  Scenario scenario;
  FrameRange rest;
  bool is_true = true;
  long frames = 40;
};

Scenario still_target(const char* name) {
  Scenario s = *simulator::built_in(name);
  s.camera.k1 = -0.37;
  for (auto& marker : s.markers) marker.dx = marker.dy = simulator::Track{};
  return s;
}

Scenario with_dy(Scenario s, const simulator::Track& dy) {
  s.markers.back().dy = dy;
  return s;
}

std::vector<RestCase> rest_cases() {
  std::vector<RestCase> all;
  const auto add = [&](std::string name, Scenario s, long first, long end, bool is_true) {
    all.push_back({"rest " + std::move(name), std::move(s), {.first = first, .end = end}, is_true, end + 2});
  };
  for (const char* name : {"small-still", "small-0.1x", "small-1xyz", "small-travel-5", "small-travel-50"}) {
    const std::string word = std::string(name).substr(6);
    add(word + ", 10 frames", still_target(name), 0, 10, true);
    add(word + ", 40 frames", still_target(name), 0, 40, true);
  }
  Scenario vague = still_target("small-travel-50");
  vague.known_to.print_scale = 0.005;
  vague.markers.back().place.print_scale = 0.005;
  add("travel-50, print 0.5 % large and known to that", vague, 0, 10, true);
  Scenario haze = still_target("small-1xyz");
  haze.haze.rms_mm = 0.005;
  add("1xyz in hot air (5 um)", haze, 0, 40, true);
  for (const char* name : {"small-still", "small-0.1x", "small-1xyz", "small-travel-5", "small-travel-50"}) {
    const std::string word = std::string(name).substr(6);
    simulator::Track paper = simulator::paper_motion(), swing, small, drift;
    swing.amplitude = 0.5, swing.frequency_hz = 1.7;
    small.amplitude = 0.02, small.frequency_hz = 1.3;
    drift.knots = {{0.0, 0.0}, {4.0, 0.02}};
    add(word + ", paper's motion", with_dy(still_target(name), paper), 0, 40, false);
    add(word + ", swings 0.5 mm", with_dy(still_target(name), swing), 0, 40, false);
    add(word + ", swings 20 um", with_dy(still_target(name), small), 0, 40, false);
    add(word + ", drifts 20 um", with_dy(still_target(name), drift), 0, 40, false);
  }
  return all;
}

bool is_lie(double error_um, double u_um) { return std::abs(error_um) > std::fmax(5.0 * u_um, 0.5); }

struct StatementTally {
  int runs = 0, contradicted = 0, refused = 0;
  long rows = 0, lies = 0;  // ok rows of runs without a contradiction
};

void count_rows(const test::MeasuredRun& run, StatementTally& tally) {
  std::size_t k = 0;
  for (const Sample& sample : run.samples) {
    if (!has_numbers(sample.status)) continue;
    if (sample.status == Status::kOk) {
      ++tally.rows;
      tally.lies += is_lie(run.error_x_um[k], run.u_x_um[k]) || is_lie(run.error_y_um[k], run.u_y_um[k]);
    }
    ++k;
  }
}

void print_row(const std::string& name, bool is_true, const StatementTally& t) {
  fmt::print("| {} | {} | {} | {} | {} of {} |\n", name, is_true ? "true" : "false", t.runs, t.contradicted, t.lies,
             t.rows);
  std::fflush(stdout);
}

Scenario with_seed(Scenario s, int seed) {
  s.seed = static_cast<std::uint64_t>(seed);
  auto& m = s.mount;
  for (auto* track : {&m.rotation_x, &m.rotation_y, &m.rotation_z, &m.shift_x, &m.shift_y, &m.shift_z})
    track->random_seed += 10 * seed;
  return s;
}

void study_rest(const StudyArgs& words) {
  for (const RestCase& c : rest_cases()) {
    if (c.name.find(words.only) == std::string::npos) continue;
    StatementTally tally;
    for (int n = 0; n < words.runs; ++n) {
      const Scenario s = with_seed(c.scenario, words.seed + n);
      test::RunPlan plan{.method = "precise", .frames = c.frames};
      plan.solve.rest = c.rest;
      const test::MeasuredRun run = test::measured(s, plan);
      ++tally.runs;
      const auto& moved = run.solution.moved_at_rest;
      tally.contradicted += moved.has_value();
      if (words.verbose && moved)
        std::fprintf(stderr, "  %s seed %d: moves by %.4f mm (u %.4f), frames %ld and %ld\n", c.name.c_str(), n,
                     moved->mm, moved->u_mm, moved->from, moved->to);
      if (!moved) count_rows(run, tally);
    }
    print_row(c.name, c.is_true, tally);
  }
}

struct CameraCase {
  std::string name;
  Scenario scenario;
  void (*misstate)(Camera&);
  std::optional<std::array<double, kCameraParameters>> u{};  // stated u of the camera; none: the default values
  bool is_true = true;
  bool is_drawn = false;  // the stated camera is drawn from the true one with u
};

Camera camera_of(const Scenario& s) {
  Camera camera;
  camera.width = s.camera.width, camera.height = s.camera.height;
  camera.fx = s.camera.fx, camera.fy = s.camera.fy, camera.cx = s.camera.cx, camera.cy = s.camera.cy;
  camera.k1 = s.camera.k1, camera.k2 = s.camera.k2, camera.p1 = s.camera.p1, camera.p2 = s.camera.p2;
  return camera;
}

std::vector<CameraCase> camera_cases() {
  std::vector<CameraCase> all;
  constexpr double kNot = std::numeric_limits<double>::quiet_NaN();
  constexpr std::array<double, kCameraParameters> kTight{1.0, 1.0, 1.0, 0.001, 0.01, 1e-5, 1e-5, kNot},
      kBoard{7.0, 4.0, 4.0, 0.01, 0.3, 2e-4, 2e-4, kNot};
  struct Wrong {
    const char* name;
    void (*misstate)(Camera&);
  };
  constexpr std::array kWrong{Wrong{"k1 + 0.3", [](Camera& c) { c.k1 += 0.3; }},
                              Wrong{"k1 - 0.37", [](Camera& c) { c.k1 -= 0.37; }},
                              Wrong{"k1 + 0.1", [](Camera& c) { c.k1 += 0.1; }},
                              Wrong{"k1 + 0.03", [](Camera& c) { c.k1 += 0.03; }},
                              Wrong{"f + 20 %", [](Camera& c) { c.fx = c.fy = 1.2 * c.fx; }},
                              Wrong{"f + 4 %", [](Camera& c) { c.fx = c.fy = 1.04 * c.fx; }},
                              Wrong{"c + 60 px", [](Camera& c) { c.cx += 60.0; }},
                              Wrong{"p1 + 0.002", [](Camera& c) { c.p1 += 0.002; }}};
  for (const char* name : {"small-still", "small-0.1x", "small-1xyz", "small-spread-1", "small-travel-50"}) {
    Scenario s = *simulator::built_in(name);
    const std::string word = "camera " + std::string(name).substr(6) + ", ";
    const auto none = [](Camera&) {};
    all.push_back({word + "right, tight", s, none, kTight});
    all.push_back({word + "right, usual", s, none});
    s.camera.k1 = -0.37;
    all.push_back({word + "right, bent, tight", s, none, kTight});
    all.push_back({word + "right, bent, usual", s, none});
    all.push_back({word + "drawn, bent", s, none, kBoard, true, true});
    for (const Wrong& wrong : kWrong) {
      s.camera.k1 = 0.0;
      all.push_back({word + wrong.name, s, wrong.misstate, kTight, false});
    }
  }
  return all;
}

void study_camera(const StudyArgs& words) {
  for (const CameraCase& c : camera_cases()) {
    if (c.name.find(words.only) == std::string::npos) continue;
    StatementTally tally;
    for (int n = 0; n < words.runs; ++n) {
      const Scenario s = with_seed(c.scenario, words.seed + n);
      test::RunPlan plan{.method = "precise", .step = 4, .frames = 40};
      plan.lens = camera_of(s);
      c.misstate(plan.lens);
      plan.solve.u_camera = c.u;
      if (c.is_drawn) {
        std::mt19937_64 rng(static_cast<std::uint64_t>(words.seed + n));
        std::normal_distribution<double> normal;
        const auto& u = *c.u;
        plan.lens.fx = plan.lens.fy = plan.lens.fx + u[0] * normal(rng);
        const std::array<double*, 6> rest{&plan.lens.cx, &plan.lens.cy, &plan.lens.k1,
                                          &plan.lens.k2, &plan.lens.p1, &plan.lens.p2};
        for (std::size_t k = 0; k < rest.size(); ++k) *rest[k] += u[k + 1] * normal(rng);
      }
      const test::MeasuredRun run = test::measured(s, plan);
      ++tally.runs;
      if (words.verbose)
        for (const auto& note : run.solution.notes) std::fprintf(stderr, "  %s: %s\n", c.name.c_str(), note.c_str());
      const bool said = test::notes(run, "with --camera, displacements would be wrong");
      tally.contradicted += said;
      if (!said) count_rows(run, tally);
    }
    print_row(c.name, c.is_true, tally);
  }
}

}  // namespace
}  // namespace moiregauge::internal

int main(int argc, char** argv) {
  moiregauge::internal::StudyArgs words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--verbose") {
      words.verbose = true;
    } else if (i + 1 < argc && word == "--runs") {
      words.runs = std::atoi(argv[++i]);
    } else if (i + 1 < argc && word == "--seed") {
      words.seed = std::atoi(argv[++i]);
    } else if (i + 1 < argc && word == "--only") {
      words.only = argv[++i];
    } else {
      std::fprintf(stderr, "error: bad option: %s: --runs N, --only WORD, --seed S, --verbose\n", word.c_str());
      return 2;
    }
  }
  fmt::print("| statement | is | runs | contradicted | lies among ok rows |\n|---|---|---|---|---|\n");
  moiregauge::internal::study_rest(words);
  moiregauge::internal::study_camera(words);
  return 0;
}
