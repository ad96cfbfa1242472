// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/simulator/rendering/background.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "moiregauge/simulator/rendering/print.h"
#include "moiregauge/simulator/rendering/texture.h"
#include "moiregauge/simulator/scenario/gaussian.h"

namespace moiregauge::internal::simulator {
namespace {

bool overlaps(const PrintedMarker& a, const PrintedMarker& b) {
  return a.low().x < b.high().x && b.low().x < a.high().x && a.low().y < b.high().y && b.low().y < a.high().y;
}

// Returns dark discs on white squares at random positions that overlap no marker and no other disc. Returns fewer than
// requested if 50 tries per disc do not suffice.
std::vector<SceneMarker> stratified_points(const Scenario& scenario) {
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
      decoys_(stratified_points(scenario)) {
  const bool is_rolling = scenario.sensor.exposes_row_by_row();
  for (int y = 0; y < (is_rolling ? scenario.camera.height : 1); ++y) {
    const double time = time_of(scenario, frame) + (is_rolling ? delay_of_row(scenario, y) : 0.0);
    board_from_ray_.push_back(inverse(camera_from_print(scenario, SceneMarker{}, time)));
  }
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
    row[x] += texture_ * roughness(seed_, point[0] / point[2], point[1] / point[2]);
  }
}

}  // namespace moiregauge::internal::simulator
