// SPDX-License-Identifier: Apache-2.0
// Times the writing of report.html for a long synthetic run, and writes the page. Prints JSON: seconds and bytes.
//
//     report_bench FRAMES TARGETS FILE
//
// The targets vibrate at 1.7 Hz on a slow drift, with noise and gaps. The page has no overlay image.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include <fmt/format.h>

#include "moiregauge/io/run_dir/run_json.h"
#include "moiregauge/report/report_page.h"

#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

constexpr double kFps = 100.0;
constexpr double kNoise = 0.001;  // mm
constexpr long kReferences = 4;
constexpr double kModulation = 60.0;  // grey levels

MarkerObservation seen_marker(double noise) {
  MarkerObservation marker;
  marker.patch.valid = true;
  marker.patch.modulation = {kModulation * (1.0 + noise), kModulation * (1.0 - noise)};
  return marker;
}

Measurement made_up(long frames, long targets) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> normal;
  Measurement m;
  Reference reference;
  for (long i = 0; i < kReferences + targets; ++i) {
    const bool is_target = i >= kReferences;
    Marker marker{fmt::format("{}{}", is_target ? "T" : "R", is_target ? i - kReferences + 1 : i + 1),
                  is_target ? Role::kTarget : Role::kReference, Circle{}, Grating{}, std::nullopt};
    reference.site.markers.push_back(marker);
    reference.seen.markers.push_back(seen_marker(0.0));
    if (!is_target) reference.circles.push_back({});
  }
  m.reference = reference;
  m.input.path = "made-up.mkv";
  m.input.frames = frames;
  m.input.width = 4096;
  m.input.height = 2168;
  m.input.fps = kFps;
  m.input.time_source = "stream";
  m.exit = Exit::kMeasured;
  for (long n = 0; n < frames; ++n) {
    Observation seen;
    seen.frame = n;
    seen.time_s = static_cast<double>(n) / kFps;
    seen.references_seen = true;
    for (std::size_t i = 0; i < reference.site.markers.size(); ++i)
      seen.markers.push_back(seen_marker(0.001 * normal(rng)));
    for (long t = 0; t < targets; ++t) {
      const double swing = 0.5 * std::sin(2.0 * std::numbers::pi * 1.7 * seen.time_s + static_cast<double>(t));
      Sample sample{n, seen.time_s, static_cast<std::size_t>(kReferences + t), {}, {kNoise, kNoise}, {}, Status::kOk};
      sample.displacement = {0.1 * swing + kNoise * normal(rng),
                             swing + 0.3 * std::sin(0.01 * seen.time_s) + kNoise * normal(rng)};
      if (n % 4999 > 4990) {
        sample.status = Status::kLost;
        sample.displacement = sample.u = {kNotMeasured, kNotMeasured};
      }
      m.samples.push_back(sample);
    }
    m.chi2_dof.push_back(1.0 + 0.1 * normal(rng));
    m.observations.push_back(seen);
  }
  m.targets = summarise(*m.reference, m.samples);
  return m;
}

int run(long frames, long targets, const char* path) {
  Measurement m = made_up(frames, targets);
  MeasureOptions options;
  options.method = method_named("precise");
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  m.spectra = spectra_of(m.samples, m.targets);
  const std::string run = run_json(m, options).dump(2);
  const std::string page = report_page(m, options, run, {});
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  std::ofstream(path) << page;
  fmt::print("{{\"frames\": {}, \"targets\": {}, \"seconds\": {:.3f}, \"bytes\": {}}}\n", frames, targets, seconds,
             page.size());
  return 0;
}

}  // namespace
}  // namespace moiregauge::internal

int main(int count, char** words) {
  if (count != 4) {
    fmt::print(stderr, "usage: report_bench FRAMES TARGETS FILE\n");
    return 2;
  }
  return moiregauge::internal::run(std::atol(words[1]), std::atol(words[2]), words[3]);
}
