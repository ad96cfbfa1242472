// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/background.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "moiregauge/simulator/gaussian.h"
#include "moiregauge/simulator/print.h"

namespace moiregauge::simulator {
namespace {

// Uniform numbers at the knots of a square net, smoothly joined; rms about 0.19 of their full range.
double value_noise(std::uint64_t seed, double x, double y) {
  const double x0 = std::floor(x), y0 = std::floor(y), u = x - x0, v = y - y0;
  const auto knot = [&](double kx, double ky) {
    const auto ix = static_cast<std::uint64_t>(static_cast<std::int64_t>(kx));
    const auto iy = static_cast<std::uint64_t>(static_cast<std::int64_t>(ky));
    return hashed_unit(seed, ix * 0x100000001b3U + iy) - 0.5;
  };
  const double su = u * u * (3.0 - 2.0 * u), sv = v * v * (3.0 - 2.0 * v);
  const double low = knot(x0, y0) + su * (knot(x0 + 1, y0) - knot(x0, y0));
  const double high = knot(x0, y0 + 1) + su * (knot(x0 + 1, y0 + 1) - knot(x0, y0 + 1));
  return low + sv * (high - low);
}

bool overlaps(const PrintedMarker& a, const PrintedMarker& b) {
  return a.low().x < b.high().x && b.low().x < a.high().x && a.low().y < b.high().y && b.low().y < a.high().y;
}

// Dark discs on white squares wherever no marker stands; a place that is taken is given up after some tries.
std::vector<SceneMarker> strewn(const Scenario& scenario) {
  std::vector<PrintedMarker> taken;
  for (const SceneMarker& marker : scenario.markers) taken.emplace_back(marker);
  const double half_x = 0.5 * scenario.camera.width / scenario.camera.fx * scenario.mount.distance_mm;
  const double half_y = 0.5 * scenario.camera.height / scenario.camera.fy * scenario.mount.distance_mm;
  std::vector<SceneMarker> decoys;
  std::uint64_t draw = 0;
  const auto between = [&](double low, double high) {
    return low + (high - low) * hashed_unit(scenario.seed + 77, draw++);
  };
  for (int tries = 0; tries < 50 * scenario.decoys && static_cast<int>(decoys.size()) < scenario.decoys; ++tries) {
    SceneMarker decoy;
    decoy.listed = false;
    decoy.paper_margin_mm = 4.0;
    const double x = between(-half_x, half_x), y = between(-half_y, half_y);
    decoy.print.circle = Circle{{x, y}, between(6.0, 24.0)};
    const PrintedMarker print(decoy);
    if (std::any_of(taken.begin(), taken.end(), [&](const PrintedMarker& other) { return overlaps(print, other); }))
      continue;
    taken.push_back(print);
    decoys.push_back(decoy);
  }
  return decoys;
}

}  // namespace

Background::Background(const Scenario& scenario, long frame)
    : camera_(scenario.camera),
      grey_(scenario.light.background),
      texture_(scenario.light.texture),
      seed_(scenario.seed),
      decoys_(strewn(scenario)) {
  const bool is_rolling = scenario.sensor.readout_s > 0.0;
  for (int y = 0; y < (is_rolling ? scenario.camera.height : 1); ++y) {
    const double time = time_of(scenario, frame) + (is_rolling ? delay_of_row(scenario, y) : 0.0);
    board_from_ray_.push_back(inverse(camera_from_print(scenario, SceneMarker{}, time)));
  }
}

// Three sizes of grain, coarse ones stronger, as on concrete; scaled to an rms of 1.
double Background::roughness(double x_mm, double y_mm) const {
  return 3.0 * value_noise(seed_, x_mm / 40.0, y_mm / 40.0) + 2.5 * value_noise(seed_ + 1, x_mm / 9.0, y_mm / 9.0) +
         2.5 * value_noise(seed_ + 2, x_mm / 2.0, y_mm / 2.0);
}

void Background::fill(int y, std::span<double> row) const {
  std::fill(row.begin(), row.end(), grey_);
  if (texture_ == 0.0) return;
  const Matrix3& board_from_ray = board_from_ray_[board_from_ray_.size() > 1 ? static_cast<std::size_t>(y) : 0];
  Ray start{-camera_.cx / camera_.fx, (y - camera_.cy) / camera_.fy};
  for (std::size_t x = 0; x < row.size(); ++x) {
    const RayPatch sight = ray_through(camera_, {static_cast<double>(x), static_cast<double>(y)}, start);
    start = {sight.ray.x + sight.dx_du, sight.ray.y + sight.dy_du};
    const Vector3 point = product(board_from_ray, Vector3{sight.ray.x, sight.ray.y, 1.0});
    row[x] += texture_ * roughness(point[0] / point[2], point[1] / point[2]);
  }
}

}  // namespace moiregauge::simulator
