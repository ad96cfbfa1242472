// SPDX-License-Identifier: Apache-2.0
#include "studies/slipping_reference.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>

#include <fmt/format.h>

#include "moiregauge/observation/print/print_model.h"
#include "studies/dice.h"
#include "studies/trust_scenarios.h"

namespace moiregauge::internal::study {
namespace {

using simulator::Scenario;
using simulator::SceneMarker;

constexpr long kFrames = 17;  // including the reference frame
constexpr double kMmPerPx = 1200.0 / 3478.26;
constexpr double kReference = 30.0, kTarget = 40.0, kCircle = 16.0;  // mm
constexpr double kCircleDistance = 26.0;  // mm, from a reference's grating to its circle on the right
constexpr simulator::RenderOptions kOneThread{1, simulator::Area::kMarkersOnly};

SceneMarker reference_at(std::size_t k, BoardPoint centre) {
  SceneMarker m;
  m.print.name = fmt::format("R{}", k + 1);
  m.print.grating = {
      .centre = centre, .width_mm = kReference, .height_mm = kReference, .pitch_mm = 10.0, .pattern = Pattern::kGrid};
  m.print.circle = Circle{{centre.x + kCircleDistance, centre.y}, kCircle};
  m.paper_margin_mm = 3.0;
  return m;
}

// Returns positions in two rows from left to right, the upper row first: four are the corners, six are two rows of
// three.
std::vector<BoardPoint> rows(int references) {
  std::vector<BoardPoint> places;
  const int columns = (references + 1) / 2;
  for (int k = 0; k < references; ++k) {
    const int column = k % columns;
    const bool above = k < columns;
    const int in_row = above ? columns : references - columns;
    const double x = in_row == 1 ? 0.0 : -122.0 + 220.0 * column / (in_row - 1);
    places.push_back({x, above ? 42.0 : -42.0});
  }
  return places;
}

// Returns random positions without overlap. A reference with circle and paper has 60 x 36 mm, the target in the middle
// 60 x 60 mm. Positions alternate between above and below, because references on one line are refused.
std::vector<BoardPoint> stratified_points(int references, Dice& dice) {
  std::vector<BoardPoint> places;
  for (int tries = 0; static_cast<int>(places.size()) < references; ++tries) {
    if (tries > 2000) places.clear(), tries = 0;
    const double side = places.size() % 2 == 0 ? 1.0 : -1.0;
    const BoardPoint p{uniform(dice, -130.0, 100.0), side * uniform(dice, 10.0, 49.0)};
    bool is_free = p.x > 48.0 || p.x < -68.0 || std::abs(p.y) > 48.0;
    for (const BoardPoint& q : places) is_free &= std::abs(p.x - q.x) > 58.0 || std::abs(p.y - q.y) > 37.0;
    if (is_free) places.push_back(p);
  }
  return places;
}

void place(Scenario& s, const std::vector<BoardPoint>& places) {
  SceneMarker target = s.markers.back();
  target.dx = target.dy = {};
  s.markers.clear();
  for (std::size_t k = 0; k < places.size(); ++k) s.markers.push_back(reference_at(k, places[k]));
  s.markers.push_back(target);
}

// Moves the camera by 0.1 or 0.8 degrees: as slow sines of 0.1 to 1 Hz, or by random poses in every frame.
void move_camera(simulator::Mount& mount, Dice& dice) {
  const double within = uniform(dice, 0.0, 1.0) < 0.5 ? 0.1 : 0.8;
  const bool sways = uniform(dice, 0.0, 1.0) < 0.5;
  for (auto* track : {&mount.rotation_x, &mount.rotation_y, &mount.rotation_z}) {
    track->knots.clear();
    if (sways) {
      track->amplitude = within;
      track->frequency_hz = uniform(dice, 0.1, 1.0);
      track->phase_deg = uniform(dice, 0.0, 360.0);
    } else {
      track->random = within;
      track->random_seed = dice();
    }
  }
}

void slip(SceneMarker& marker, long when, double mm, double direction, double fps) {
  const double before = (static_cast<double>(when) - 0.6) / fps, after = (static_cast<double>(when) - 0.4) / fps;
  marker.dx.knots = {{before, 0.0}, {after, mm * std::cos(direction)}};
  marker.dy.knots = {{before, 0.0}, {after, mm * std::sin(direction)}};
}

// Simulates the fit of a marker in this frame: the nine points of the reference frame at their new positions. The noise
// follows the Fisher information of the reference frame.
PatchFit read_again(const Scenario& s, long frame, const Marker& marker, const PatchFit& then, Dice& dice) {
  const SceneMarker& truth = *simulator::find_marker(s, marker.name);
  const auto board = print_from_board(*marker.grating, {}).inverse();
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 2 * kPatchPoints, 1> noise;
  for (double& n : noise) n = normal(dice);
  // With information = L L^T, L^-T times unit noise has the inverse of the information as covariance.
  noise = then.information.llt().matrixU().solve(noise);
  PatchFit now = then;
  for (std::size_t n = 0; n < kPatchPoints; ++n) {
    now.image[n] = simulator::project(s, frame, truth, board(then.print[n]));
    now.print[n].x += noise(static_cast<Eigen::Index>(n));
    now.print[n].y += noise(static_cast<Eigen::Index>(n + kPatchPoints));
  }
  return now;
}

std::optional<IdealFromBoard> view_in(const Scenario& s, long frame, const Reference& reference) {
  std::vector<BoardPoint> board;
  std::vector<IdealPoint> ideal;
  for (const Marker& m : reference.site.markers) {
    if (m.role != Role::kReference) continue;
    board.push_back(m.grating->centre);
    ideal.push_back(
        reference.lens.undistort(simulator::project(s, frame, *simulator::find_marker(s, m.name), board.back())));
  }
  const auto h = fit_homography<frame::Ideal, frame::Board>(std::span<const BoardPoint>(board),
                                                            std::span<const IdealPoint>(ideal));
  return h ? std::optional(*h) : std::nullopt;
}

Observation observed_again(const Scenario& s, long frame, const Reference& reference, Dice& dice) {
  Observation seen = reference.seen;
  seen.frame = frame;
  seen.time_s = simulator::time_of(s, frame);
  if (const auto view = view_in(s, frame, reference)) seen.stage1 = seen.stage2 = *view;
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    if (seen.markers[i].points)
      seen.markers[i].points = read_again(s, frame, reference.site.markers[i], *reference.seen.markers[i].points, dice);
  }
  return seen;
}

}  // namespace

Slip drawn_slip(const SlipKind& kind, int number) {
  TrustScenario drawn{"slip", "", *simulator::built_in("small-still"), kind.lens_known};
  drawn.scenario.camera.k1 = -0.37;  // -1 % at the corner of the image
  Dice dice(static_cast<std::uint64_t>(number) * 7919 + 17);
  place(drawn.scenario,
        kind.layout == Layout::kRows ? rows(kind.references) : stratified_points(kind.references, dice));
  move_camera(drawn.scenario.mount, dice);
  const auto who = static_cast<std::size_t>(std::uniform_int_distribution<int>(0, kind.references - 1)(dice));
  const long when = std::uniform_int_distribution<long>(1, kFrames - 1)(dice);
  slip(drawn.scenario.markers[who], when, kind.slip_px * kMmPerPx, uniform(dice, 0.0, 6.283185307179586),
       drawn.scenario.sensor.fps);
  const DrawnRun run = drawn_run(drawn, number);
  Slip out{run.scenario, run.plan, drawn.scenario.markers[who].print.name, when};
  out.plan.first = out.plan.step = 1;
  out.plan.frames = kFrames - 1;
  return out;
}

std::optional<Solution> measured(const Slip& slip, Footage footage) {
  if (footage == Footage::kPictures) {
    test::MeasuredRun run = test::measured(slip.scenario, slip.plan);
    if (!run.problem.empty()) return std::nullopt;
    run.solution.samples = run.samples;
    return run.solution;
  }
  const auto picture = simulator::render(slip.scenario, 0, kOneThread);
  const GreyPicture grey{simulator::view_of(picture), slip.scenario.sensor.bits};
  auto reference = make_reference(grey, simulator::site_of(slip.scenario), slip.plan.lens, slip.plan.observe);
  if (!reference) {
    std::fprintf(stderr, "%s\n", reference.error().message.c_str());
    return std::nullopt;
  }
  const Method* precise = method_named(slip.plan.method);
  precise->prepare(grey, *reference);
  Dice dice(slip.scenario.seed);
  Observations seen(*reference);
  for (long frame = 0; frame <= slip.plan.frames; ++frame) {
    seen.push_back(observed_again(slip.scenario, frame, *reference, dice));
    if (frame == 0) reference->seen.markers = seen.front().markers;
  }
  return precise->solve(*reference, seen, slip.plan.solve);
}

}  // namespace moiregauge::internal::study
