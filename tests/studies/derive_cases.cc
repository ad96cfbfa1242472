// SPDX-License-Identifier: Apache-2.0
#include "studies/derive_cases.h"

#include <cmath>

#include "moiregauge/results/derived/channel_parser.h"
#include "moiregauge/results/derived/layers.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::study {
namespace {

constexpr long kStep = 12;  // every 12th frame of the rig's 161: 14 frames

// Returns samples and positions without error. The truth of the rotations is zero, because the simulated sheets do not
// turn.
struct TrueRun {
  Samples samples;
  JointErrors joint;
};

TrueRun true_run(const simulator::Scenario& scenario, const Site& site, const JointSolution& measured) {
  TrueRun out{measured.solution.samples, measured.joint};
  for (Sample& sample : out.samples) {
    const auto* marker = simulator::find_marker(scenario, site.markers[sample.marker].name);
    const auto now = simulator::truth(scenario, sample.frame, *marker), then = simulator::truth(scenario, 0, *marker);
    sample.displacement = {now.dx_mm - then.dx_mm, now.dy_mm - then.dy_mm};
  }
  for (std::size_t t = 0; t < out.joint.targets.size(); ++t) {
    const auto* marker = simulator::find_marker(scenario, site.markers[out.joint.targets[t]].name);
    const auto place = simulator::true_place(scenario, *marker);
    out.joint.positions[t] = out.joint.positions[t] + Extent<frame::Board>{place.x_mm, place.y_mm};
  }
  for (FrameErrors& errors : out.joint.frames) errors.rotation_rad.setZero();
  return out;
}

// Returns the u that the sum of the variances of all values gives.
double u_by_hand(const Channel& channel, const Sample* frame) {
  double variance = 0.0;
  for (const ChannelTerm& term : channel.terms) {
    for (const std::size_t t : term.targets) {
      const double u = term.kind == TermKind::kDx ? frame[t].u.x : frame[t].u.y;
      variance += term.factor * term.factor * u * u;
    }
  }
  return std::sqrt(variance);
}

simulator::SceneMarker target_at(simulator::SceneMarker marker, const char* name, double x_mm) {
  marker.print.name = name;
  marker.print.grating->centre.x = x_mm;
  marker.print.grating->width_mm = marker.print.grating->height_mm = 30.0;
  marker.paper_margin_mm = 4.0;  // the next reference's grating is 10 mm away: a moving paper must not cover it
  marker.dx = {.amplitude = 0.3, .frequency_hz = 0.11, .phase_deg = x_mm};
  marker.dy = {.amplitude = 1.0, .frequency_hz = 0.07, .phase_deg = 2.0 * x_mm};
  return marker;
}

}  // namespace

const std::vector<std::string>& study_channels() {
  static const std::vector<std::string> channels{
      "difference = mid.dy - left.dy", "sag = sag(left, mid, right)",  "mean = mean(left.dy, mid.dy, right.dy)",
      "tilt = rotation(left, right)",  "strain = strain(left, right)", "own = mid.rotation"};
  return channels;
}

simulator::Scenario derived_scenario(std::uint64_t seed) {
  auto scenario = *simulator::built_in("small-spread-1");
  scenario.seed = seed;
  scenario.known_to = {.position_mm = 0.1, .rotation_rad = 0.0005, .height_mm = 0.5, .print_scale = 0.0005};
  scenario.draw = {.position = true, .rotation = true, .height = true, .print_scale = true};
  const simulator::SceneMarker mid = *simulator::find_marker(scenario, "mid");
  scenario.markers.push_back(target_at(mid, "left", -60.0));
  scenario.markers.push_back(target_at(mid, "right", 60.0));
  return scenario;
}

JointSolution solve_jointly(const test::MeasuredRun& run, const SolveOptions& options) {
  JointSolution out;
  out.solution = solve_precise(run.reference, run.observations, options);
  if (out.solution.joint_errors) out.joint = out.solution.joint_errors();
  return out;
}

DerivedRun derived_run(std::uint64_t seed) {
  const auto scenario = derived_scenario(seed);
  test::RunPlan plan{.method = "precise", .step = kStep, .all_targets = true, .render_threads = 1};
  const test::MeasuredRun run = test::measured(scenario, plan);
  DerivedRun out{run.problem, {}};
  if (!out.problem.empty()) return out;
  const JointSolution solved = solve_jointly(run);
  if (solved.joint.targets.empty()) {
    out.problem = "no scene";
    return out;
  }
  const TrueRun truth = true_run(scenario, run.reference.site, solved);
  std::vector<std::string> names;
  for (const std::size_t i : solved.joint.targets) names.push_back(run.reference.site.markers[i].name);
  for (const std::string& text : study_channels()) {
    const Channel channel = *parse_channel(text, names, {});
    const ChannelSeries measured = *channel_values(channel, solved.solution.samples, solved.joint);
    const ChannelSeries expected = *channel_values(channel, truth.samples, truth.joint);
    ChannelErrors& errors = out.channels[channel.name];
    for (Eigen::Index n = 1; n < measured.size(); ++n) {
      if (!measured.is_ok(n)) continue;
      errors.error.push_back(measured.value(n) - expected.value(n));
      errors.u.push_back(measured.u(n));
      const auto first = static_cast<std::size_t>(n) * names.size();
      errors.u_by_hand.push_back(u_by_hand(channel, solved.solution.samples.data() + first));
    }
  }
  return out;
}

DerivedRun zeroed_run(std::uint64_t seed) {
  const auto scenario = derived_scenario(seed);
  test::RunPlan plan{
      .method = "precise", .frames = kZeroFrames + kFramesAfterZero, .all_targets = true, .render_threads = 1};
  const test::MeasuredRun run = test::measured(scenario, plan);
  DerivedRun out{run.problem, {}};
  if (!out.problem.empty()) return out;
  const JointSolution solved = solve_jointly(run);
  if (solved.joint.targets.empty()) {
    out.problem = "no scene";
    return out;
  }
  const TrueRun truth = true_run(scenario, run.reference.site, solved);
  const Channel channel{"y", "mm", {{TermKind::kDy, {0}, 1.0}}, 0.0, {}};  // mid is the first target
  for (const bool is_zeroed : {false, true}) {
    std::vector<Layer> layers;
    if (is_zeroed) layers.push_back({ZeroLayer{{0, kZeroFrames}}, "zero"});
    const auto measured = *layered(*channel_values(channel, solved.solution.samples, solved.joint), "mm", layers);
    const auto expected = *layered(*channel_values(channel, truth.samples, truth.joint), "mm", layers);
    ChannelErrors& errors = out.channels[is_zeroed ? "zero" : "reference frame"];
    for (Eigen::Index n = kZeroFrames; n < measured.value.size(); ++n) {
      if (measured.status[static_cast<std::size_t>(n)] != Status::kOk) continue;
      errors.error.push_back(measured.value(n) - expected.value(n));
      errors.u.push_back(measured.u(n));
    }
  }
  return out;
}

namespace {

// Returns the Cramér-Rao bound of a print's rotation in one frame, rad.
double rotation_bound(const simulator::Scenario& scenario, long frame, const std::string& name) {
  constexpr double kStep_deg = 0.01;  // moves the outer pixels by 0.015 px
  const auto rotated = [&](double by_deg) {
    simulator::Scenario copy = scenario;
    for (simulator::SceneMarker& marker : copy.markers) {
      if (marker.print.name == name) marker.place.rotation_deg += by_deg;
    }
    return simulator::render_ideal(copy, frame, {1, simulator::Area::kMarkersOnly});
  };
  const Image<double> plus = rotated(kStep_deg), minus = rotated(-kStep_deg);
  constexpr double kQuantised = 1.0 / 12.0;  // variance of rounding to whole grey levels
  const simulator::Sensor& sensor = scenario.sensor;
  double information = 0.0;
  for (int y = 0; y < plus.height(); ++y) {
    for (int x = 0; x < plus.width(); ++x) {
      const double slope = (plus.at(x, y) - minus.at(x, y)) / radians_from_degrees(2.0 * kStep_deg);
      const double level = 0.5 * (plus.at(x, y) + minus.at(x, y));
      information += slope * slope / (sensor.noise_sigma * sensor.noise_sigma + sensor.noise_gain * level + kQuantised);
    }
  }
  return 1.0 / std::sqrt(information);
}

}  // namespace

RotationRun rotation_run(std::uint64_t seed, long frames) {
  const auto scenario = derived_scenario(seed);
  test::RunPlan plan{.method = "precise", .frames = frames, .all_targets = true, .render_threads = 1};
  const test::MeasuredRun run = test::measured(scenario, plan);
  RotationRun out{run.problem, {}, {}, {}, 0.0};
  if (!out.problem.empty()) return out;
  const JointSolution solved = solve_jointly(run);
  if (solved.joint.targets.empty()) {
    out.problem = "no scene";
    return out;
  }
  const std::string name = run.reference.site.markers[solved.joint.targets.front()].name;
  const Channel channel{"own", "mrad", {{TermKind::kRotation, {0}, 1.0}}, 0.0, {}};
  const ChannelSeries measured = *channel_values(channel, solved.solution.samples, solved.joint);
  constexpr double kMrad = 1e-3;
  for (Eigen::Index n = 1; n < measured.size(); ++n) {
    if (!measured.is_ok(n)) continue;
    out.error.push_back(kMrad * measured.value(n));  // the print does not turn
    out.u.push_back(kMrad * measured.u(n));
    out.bound.push_back(rotation_bound(scenario, measured.frame[static_cast<std::size_t>(n)], name));
  }
  out.bound_of_reference = rotation_bound(scenario, 0, name);
  return out;
}

}  // namespace moiregauge::internal::study
