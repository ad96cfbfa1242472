// SPDX-License-Identifier: Apache-2.0
// Tests that the centre detected for a tilted circle is that of the imaged ellipse. It is not the image of the circle's
// centre. The difference is the textbook's, computed here from the outline's exact projections.
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "common/simulated_run.h"
#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/geometry/conic.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr double kCircleGate_px = 0.005;

simulator::Scenario tilted_by(double x_deg, double y_deg) {
  simulator::Scenario s = *simulator::built_in("small-0.1x");
  s.mount.board_x_deg = x_deg;
  s.mount.board_y_deg = y_deg;
  s.mount.rotation_x = s.mount.rotation_y = s.mount.rotation_z = {};
  return s;
}

// Returns the centre of the ellipse through exact projections of the rim: a conic a x^2 + b xy + c y^2 + d x + e y = 1.
ImagePoint exact_ellipse_centre(const simulator::Scenario& scenario, const Circle& circle, ImagePoint near) {
  constexpr int kRim = 24;
  Eigen::Matrix<double, kRim, 5> a;
  for (int i = 0; i < kRim; ++i) {
    const double t = kTwoPi * i / kRim, r = 0.5 * circle.diameter_mm;
    const ImagePoint p = project(scenario, 0, {circle.centre.x + r * std::cos(t), circle.centre.y + r * std::sin(t)});
    const double x = (p.x - near.x) / 10.0, y = (p.y - near.y) / 10.0;
    a.row(i) << x * x, x * y, y * y, x, y;
  }
  const Eigen::Matrix<double, 5, 1> c = a.colPivHouseholderQr().solve(Eigen::Matrix<double, kRim, 1>::Ones());
  const double det = 4.0 * c(0) * c(2) - c(1) * c(1);
  return {near.x + 10.0 * (c(1) * c(4) - 2.0 * c(2) * c(3)) / det,
          near.y + 10.0 * (c(1) * c(3) - 2.0 * c(0) * c(4)) / det};
}

TEST(RenderedCircle, TheCentreFoundIsTheImagedEllipsesCentre) {
  for (const double tilt : {0.0, 8.0, 20.0, 40.0}) {
    for (const bool sideways : {false, true}) {
      const auto scenario = tilted_by(sideways ? 0.0 : tilt, sideways ? tilt : 0.0);
      const Image<double> light = render_ideal(scenario, 0, {0, simulator::Area::kMarkersOnly});
      Image<std::uint16_t> fine(light.width(), light.height());
      for (int y = 0; y < light.height(); ++y) {
        for (int x = 0; x < light.width(); ++x)
          fine.at(x, y) = static_cast<std::uint16_t>(std::lround(256.0 * light.at(x, y)));
      }
      const CircleSearch search = find_circles(fine.view(), {});
      for (const Marker& marker : simulator::site_of(scenario).markers) {
        if (!marker.circle) continue;
        const ImagePoint centre = project(scenario, 0, marker.circle->centre);
        const ImagePoint exact = exact_ellipse_centre(scenario, *marker.circle, centre);
        double nearest = 1e9;
        for (const DetectedCircle& seen : search.circles) nearest = std::min(nearest, length(seen.centre - exact));
        EXPECT_LE(nearest, kCircleGate_px) << marker.name << " at " << tilt << " deg; the ellipse's centre is "
                                           << length(exact - centre) << " px from the centre's image";
      }
    }
  }
}

TEST(RenderedCircle, TheClosedFormOfTheEllipsesCentreIsTheSimulators) {
  const auto scenario = tilted_by(40.0, 0.0);
  std::vector<BoardPoint> board;
  std::vector<ImagePoint> image;
  for (const double x : {-100.0, 100.0}) {
    for (const double y : {-40.0, 40.0}) {
      board.push_back({x, y});
      image.push_back(project(scenario, 0, board.back()));
    }
  }
  const auto h = *fit_homography<frame::Image, frame::Board>(board, image);
  const Circle circle{{128.0, 40.0}, 16.0};
  const ImagePoint exact = exact_ellipse_centre(scenario, circle, project(scenario, 0, circle.centre));
  EXPECT_LT(length(ellipse_centre(h, circle.centre, circle.diameter_mm) - exact), 1e-6);
}

}  // namespace
}  // namespace moiregauge::internal
