// SPDX-License-Identifier: Apache-2.0
// Each stage per frame, at the paper's recording size (4104x1012) and at the sensor's (4096x2168). Frames per second; the
// plain pass over the frame's bytes is the floor that the rest is to be compared with, within one run.
#include <benchmark/benchmark.h>

#include <map>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/phase/sampling_moire.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge {
namespace {

struct Scene {
  simulator::Scenario scenario;
  Image<std::uint8_t> first, second;
  Site site;
  Reference reference;
};

const Scene& scene(int height) {
  static std::map<int, Scene> scenes;
  const auto found = scenes.find(height);
  if (found != scenes.end()) return found->second;
  Scene s;
  s.scenario = *simulator::built_in("rig-1xyz");
  s.scenario.camera.cy += 0.5 * (height - s.scenario.camera.height);
  s.scenario.camera.height = height;
  if (height == 2168) s.scenario.camera.width = 4096;
  s.first = render8(s.scenario, 0);
  s.second = render8(s.scenario, 1);
  s.site = simulator::site_of(s.scenario);
  s.reference = *make_reference({s.first.view(), 8}, s.site, Camera{}, {});
  return scenes.emplace(height, std::move(s)).first->second;
}

void per_frame(benchmark::State& state) {
  state.counters["frames/s"] = benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate);
}

void PassOverTheFrame(benchmark::State& state) {
  const Scene& s = scene(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    std::uint64_t sum = 0;
    for (int y = 0; y < s.first.height(); ++y) {
      for (const std::uint8_t grey : s.first.row(y)) sum += grey;
    }
    benchmark::DoNotOptimize(sum);
  }
  per_frame(state);
}

void FindCirclesInTheWholeFrame(benchmark::State& state) {
  const Scene& s = scene(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(find_circles(s.second.view(), {}));
  per_frame(state);
}

void FindFourCirclesNear(benchmark::State& state) {
  const Scene& s = scene(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    for (const CirclePoint& p : s.reference.circles) {
      const SeenCircle& c = *s.reference.seen.markers[p.marker].circle;
      benchmark::DoNotOptimize(find_circles_near(s.second.view(), c.centre, c.diameter_px, 0.75 * c.diameter_px, {}));
    }
  }
  per_frame(state);
}

void ReadOnePatch(benchmark::State& state) {
  const Scene& s = scene(static_cast<int>(state.range(0)));
  PatchWorkspace work;
  for (auto _ : state)
    benchmark::DoNotOptimize(read_patch(s.second.view(), 8, s.reference.view, s.reference.plans.front(), {}, work));
  per_frame(state);
}

void SamplingMoire160(benchmark::State& state) {
  const Image<double> picture(160, 160, 100.0);
  for (auto _ : state) benchmark::DoNotOptimize(sampling_moire(picture.view(), Axis::kY, 29.0));
  per_frame(state);
}

void SamplingMoireTextbook160(benchmark::State& state) {
  const Image<double> picture(160, 160, 100.0);
  for (auto _ : state) benchmark::DoNotOptimize(sampling_moire_textbook(picture.view(), Axis::kY, 29));
  per_frame(state);
}

void TwoStageFrame(benchmark::State& state) {
  const Scene& s = scene(static_cast<int>(state.range(0)));
  PatchWorkspace work;
  const Follower follower(s.reference);
  for (auto _ : state)
    benchmark::DoNotOptimize(observe_two_stage({s.second.view(), 8}, s.reference, follower.prediction(), work));
  per_frame(state);
}

void ConventionalFrame(benchmark::State& state) {
  const Scene& s = scene(static_cast<int>(state.range(0)));
  PatchWorkspace work;
  for (auto _ : state) benchmark::DoNotOptimize(observe_conventional({s.second.view(), 8}, s.reference, {}, work));
  per_frame(state);
}

void SimulateWholeFrame(benchmark::State& state) {
  const Scene& s = scene(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(render8(s.scenario, 3));
  per_frame(state);
}

void SimulateSmallRigMarkersOnly(benchmark::State& state) {
  const auto scenario = *simulator::built_in("small-1xyz");
  for (auto _ : state) benchmark::DoNotOptimize(render8(scenario, 3, {0, simulator::Area::kMarkersOnly}));
  per_frame(state);
}

#define AT_BOTH_SIZES(stage) BENCHMARK(stage)->Arg(1012)->Arg(2168)->Unit(benchmark::kMillisecond)->UseRealTime()
AT_BOTH_SIZES(PassOverTheFrame);
AT_BOTH_SIZES(FindCirclesInTheWholeFrame);
AT_BOTH_SIZES(FindFourCirclesNear);
AT_BOTH_SIZES(ReadOnePatch);
AT_BOTH_SIZES(TwoStageFrame);
AT_BOTH_SIZES(ConventionalFrame);
AT_BOTH_SIZES(SimulateWholeFrame);
BENCHMARK(SamplingMoire160)->Unit(benchmark::kMillisecond);
BENCHMARK(SamplingMoireTextbook160)->Unit(benchmark::kMillisecond);
BENCHMARK(SimulateSmallRigMarkersOnly)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace moiregauge

BENCHMARK_MAIN();
