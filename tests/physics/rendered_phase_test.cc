// SPDX-License-Identifier: Apache-2.0
// Tests the phase of a rendered grating against an exact computation that shares no code with the instrument. The
// simulator's projection gives the grating's centre. A raster there must read the phase of the centre.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "common/simulated_run.h"
#include "moiregauge/observation/raster/patch.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

using simulator::Scenario;

constexpr double kPhaseGate_px = 0.001;

Scenario tilted(double x_deg, double y_deg, double k1, double p1, Pattern pattern) {
  Scenario s = *simulator::built_in("small-0.1x");
  s.mount.board_x_deg = x_deg;
  s.mount.board_y_deg = y_deg;
  s.mount.rotation_x = s.mount.rotation_y = s.mount.rotation_z = {};
  s.camera.k1 = k1;
  s.camera.p1 = p1;
  for (auto& marker : s.markers) {
    marker.dx = marker.dy = marker.dz = {};
    if (marker.print.grating) marker.print.grating->pattern = pattern;
  }
  return s;
}

// Returns the view of a frame from the simulator's projection alone. Points without the lens determine the homography.
View exact_view(const Scenario& scenario) {
  Scenario pinhole = scenario;
  pinhole.camera.k1 = pinhole.camera.k2 = pinhole.camera.k3 = pinhole.camera.p1 = pinhole.camera.p2 = 0.0;
  std::vector<BoardPoint> board;
  std::vector<IdealPoint> ideal;
  for (const double x : {-130.0, 0.0, 130.0}) {
    for (const double y : {-50.0, 0.0, 50.0}) {
      board.push_back({x, y});
      const ImagePoint p = project(pinhole, 0, board.back());
      ideal.push_back({p.x, p.y});
    }
  }
  const auto& c = scenario.camera;
  return {*fit_homography<frame::Ideal, frame::Board>(board, ideal),
          Camera{c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3}};
}

// Returns the largest apparent displacement (image px) of the gratings, which are fixed at their site positions.
double worst_phase_px(const Scenario& scenario) {
  const Image<double> light = render_ideal(scenario, 0, {0, simulator::Area::kMarkersOnly});
  Image<std::uint16_t> fine(light.width(), light.height());
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x)
      fine.at(x, y) = static_cast<std::uint16_t>(std::lround(256.0 * light.at(x, y)));
  }
  const View view = exact_view(scenario);
  double worst = 0.0;
  for (const Marker& marker : simulator::site_of(scenario).markers) {
    if (!marker.grating) continue;
    const double mm_per_px = view.mm_per_px(marker.grating->centre);
    const auto plan = plan_raster(*marker.grating, view.finest_mm_per_px(marker.grating->centre), {});
    EXPECT_TRUE(plan) << marker.name;
    if (!plan) continue;
    const PatchReading reading = read_patch(fine.view(), 16, view, *plan, {});
    EXPECT_TRUE(reading.valid) << marker.name;
    // A cosine has its crest at the centre, a grid the crossing of two dark lines.
    const double there = marker.grating->pattern == Pattern::kCosine ? 0.0 : kPi;
    for (const double phase : reading.phase_rad)
      worst = std::max(worst, std::abs(wrapped(phase - there)) / kTwoPi * plan->pitch_mm / mm_per_px);
  }
  return worst;
}

struct Lens {
  double k1, p1;
};

TEST(RenderedPhase, AGratingSeenAtAnAngleThroughALensReadsWhereItIs) {
  for (const Pattern pattern : {Pattern::kGrid, Pattern::kCosine}) {
    for (const auto& [k1, p1] : {Lens{0.0, 0.0}, Lens{-0.37, 0.0}, Lens{-0.37, 5e-4}}) {
      for (const double tilt : {0.0, 8.0, 20.0, 40.0}) {
        for (const bool sideways : {false, true}) {
          const double worst = worst_phase_px(tilted(sideways ? 0.0 : tilt, sideways ? tilt : 0.0, k1, p1, pattern));
          EXPECT_LE(worst, kPhaseGate_px) << word_for(pattern) << ", k1 " << k1 << ", p1 " << p1 << ", tilt " << tilt
                                          << (sideways ? " about y" : " about x");
          RecordProperty(std::string(word_for(pattern)) + "_k1_" + std::to_string(k1) + "_tilt_" + std::to_string(tilt),
                         std::to_string(worst));
        }
      }
    }
  }
}

}  // namespace
}  // namespace moiregauge::internal
