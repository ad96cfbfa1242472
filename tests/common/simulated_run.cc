// SPDX-License-Identifier: Apache-2.0
#include "common/simulated_run.h"

#include <algorithm>
#include <cmath>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/simulator/recorder.h"

namespace moiregauge::internal::test {
namespace {

using simulator::Scenario;

// Rounds to 1/256 of a grey level: 0.001 grey levels rms, a thousandth of the sensor's noise.
Image<std::uint16_t> finely_quantised(const Image<double>& light) {
  Image<std::uint16_t> out(light.width(), light.height());
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x)
      out.at(x, y) = static_cast<std::uint16_t>(std::lround(std::clamp(256.0 * light.at(x, y), 0.0, 65535.0)));
  }
  return out;
}

struct Shot {
  simulator::Picture picture;
  int bits = 8;
  [[nodiscard]] GreyPicture view() const { return {simulator::view_of(picture), bits}; }
};

simulator::RenderOptions options_of(const RunPlan& plan) {
  return {plan.render_threads, simulator::Area::kMarkersOnly};
}

Shot shot(const Scenario& scenario, long frame, const RunPlan& plan, simulator::Recorder& recorder) {
  if (plan.grain == Grain::kNoiseFree) return {finely_quantised(render_ideal(scenario, frame, options_of(plan))), 16};
  return {recorder.frame(frame), scenario.sensor.bits};
}

void compare(const Scenario& scenario, const Sample& sample, long reference_frame, MeasuredRun& run) {
  if (!has_numbers(sample.status)) return;
  const auto* marker = simulator::find_marker(scenario, run.reference.site.markers[sample.marker].name);
  const auto now = truth(scenario, sample.frame, *marker);
  const auto then = truth(scenario, reference_frame, *marker);
  run.error_x_um.push_back(1000.0 * (sample.displacement.x - (now.dx_mm - then.dx_mm)));
  run.error_y_um.push_back(1000.0 * (sample.displacement.y - (now.dy_mm - then.dy_mm)));
  run.u_x_um.push_back(1000.0 * sample.u.x);
  run.u_y_um.push_back(1000.0 * sample.u.y);
}

}  // namespace

MeasuredRun measured(const Scenario& scenario, const RunPlan& plan) {
  MeasuredRun run;
  simulator::Recorder recorder(scenario, options_of(plan));
  const Shot first = shot(scenario, plan.reference_frame, plan, recorder);
  auto reference =
      make_reference(first.view(), plan.site.value_or(simulator::site_of(scenario)), plan.lens, plan.observe);
  if (!reference) {
    run.problem = reference.error().message;
    return run;
  }
  run.reference = std::move(*reference);
  run.reference.seen.frame = plan.reference_frame;
  run.reference.seen.time_s = simulator::time_of(scenario, plan.reference_frame);
  const Method* method = method_named(plan.method);
  if (method->prepare != nullptr) method->prepare(first.view(), run.reference);
  run.observations.refer_to(run.reference);
  Follower follower(run.reference);
  long count = 0;
  for (long frame = plan.first; frame < scenario.frames && (plan.frames < 0 || count < plan.frames);
       frame += plan.step, ++count) {
    const Shot now = shot(scenario, frame, plan, recorder);
    Observation seen = method->observe(now.view(), run.reference, follower.prediction());
    seen.frame = frame;
    seen.time_s = simulator::time_of(scenario, frame);
    run.observations.push_back(seen);
    (void)follower.follow(run.reference, run.observations.back());
  }
  std::size_t first_target = 0;
  while (run.reference.site.markers[first_target].role != Role::kTarget) ++first_target;
  run.solution = method->solve(run.reference, run.observations, plan.solve);
  const Samples all = std::move(run.solution.samples);
  for (const Sample& sample : all) {
    if ((sample.marker != first_target && !plan.all_targets) || sample.frame == plan.reference_frame) continue;
    run.samples.push_back(sample);
    compare(scenario, sample, plan.reference_frame, run);
  }
  return run;
}

bool notes(const MeasuredRun& run, const std::string& what) {
  const auto says = [&](const std::string& n) { return n.find(what) != std::string::npos; };
  return std::ranges::any_of(run.solution.notes, says) || std::ranges::any_of(run.solution.findings, says);
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? std::nan("") : std::sqrt(sum / double(values.size()));
}

double scatter(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / double(values.size());
  std::vector<double> about;
  for (const double v : values) about.push_back(v - mean);
  return rms(about);
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

}  // namespace moiregauge::internal::test
