// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/reproduce_pictures.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/drawing/figures/figure_pictures.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal::cli {
namespace {

using simulator::Scenario;

constexpr double kTilt_deg = 20.0;  // paper, Figure 4
constexpr int kHeldSide_px = 200;   // side of the paper's crops
constexpr double kBetweenShots_s = 3.0;

// A reference frame and the frames measured against it, without lens distortion.
class CaseFilm {
 public:
  explicit CaseFilm(const ReproduceCase& which)
      : scenario_(scenario_of(which, {})), first_(render8(scenario_, which.reference_frame)) {
    auto made = make_reference({first_.view(), 8}, simulator::site_of(scenario_), Camera{}, {});
    if (!made) throw std::logic_error(which.scenario + " has no reference frame: " + made.error().message);
    reference_ = *std::move(made);
    follower_ = std::make_unique<Follower>(reference_);
  }
  Observation look(const Image<std::uint8_t>& picture) {
    Observation seen = observe_two_stage({picture.view(), 8}, reference_, follower_->prediction());
    if (!seen.references_seen) throw std::logic_error(scenario_.name + ": " + seen.reference_problem);
    (void)follower_->follow(reference_, seen);
    return seen;
  }
  // Returns the largest displacement in a reference grating when measured with this view, px.
  double residual_px(const Image<std::uint8_t>& picture, const IdealFromBoard& view) {
    double largest = 0.0;
    for (std::size_t i = 0; i < reference_.site.markers.size(); ++i) {
      const Marker& marker = reference_.site.markers[i];
      if (marker.role != Role::kReference || !marker.grating) continue;
      const auto now = read_patch(picture.view(), 8, {view, {}}, reference_.plans[i], {});
      const auto left = displacement_between(reference_.plans[i], reference_.seen.markers[i].patch, now);
      largest = std::max(largest, length(left) / reference_.view.mm_per_px(marker.grating->centre));
    }
    return largest;
  }
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const Image<std::uint8_t>& first() const { return first_; }
  [[nodiscard]] const Reference& reference() const { return reference_; }

 private:
  Scenario scenario_;
  Image<std::uint8_t> first_;
  Reference reference_;
  std::unique_ptr<Follower> follower_;
};

// Returns a crop. Parts outside the image are white.
Image<std::uint8_t> cut(const Image<std::uint8_t>& picture, figure::Part part) {
  Image<std::uint8_t> out(part.width, part.height, 255);
  for (int y = std::max(0, -part.y); y < std::min(part.height, picture.height() - part.y); ++y) {
    for (int x = std::max(0, -part.x); x < std::min(part.width, picture.width() - part.x); ++x)
      out.at(x, y) = picture.at(part.x + x, part.y + y);
  }
  return out;
}

}  // namespace

figure::FigureFiles tilted_circles() {
  Scenario scenario = simulator::built_in("small-1xyz").value();
  scenario.mount.board_x_deg = scenario.mount.board_y_deg = kTilt_deg;
  const auto picture = render8(scenario, 0);
  return files_of(figure::circles_found({picture.view(), find_circles(picture.view(), {})}));
}

figure::FigureFiles stabilised_frames(const ReproduceCase& which) {
  CaseFilm film(which);
  const long last = film.scenario().frames - 1;
  const auto after = render8(film.scenario(), last);
  const auto angle_deg = [&](long frame) {
    return film.scenario().mount.rotation_x.at(simulator::time_of(film.scenario(), frame));
  };
  const Observation now = film.look(after);
  return files_of(figure::before_and_after(
      {.turn = fmt::format("{:g}° about x, y and z", angle_deg(last) - angle_deg(which.reference_frame)),
       .before = film.first().view(),
       .after = after.view(),
       .reference = &film.reference(),
       .now = &now,
       .residual_px = {film.residual_px(after, now.stage1), film.residual_px(after, now.stage2)}}));
}

figure::FigureFiles target_over_time(const ReproduceCase& which) {
  CaseFilm film(which);
  const ImagePoint middle = film.reference().view({0.0, 0.0});
  const auto held = figure::square_round(middle, kHeldSide_px),
             captured = figure::square_round(middle, which.captured_px);
  figure::CropsFigure f{simulator::time_of(film.scenario(), which.reference_frame), cut(film.first(), held), {}};
  const long step = std::lround(kBetweenShots_s * film.scenario().sensor.fps);
  for (long frame = step; frame < film.scenario().frames; frame += step) {
    const auto picture = render8(film.scenario(), frame);
    const auto still =
        figure::stabilised(picture.view(), film.look(picture).stage2, film.reference().view.ideal_from_board);
    f.shots.push_back({simulator::time_of(film.scenario(), frame), cut(picture, captured), cut(still, held)});
  }
  return files_of(crops_over_time(f));
}

}  // namespace moiregauge::internal::cli
