// SPDX-License-Identifier: Apache-2.0
#include "common/identity_verdict.h"

#include <cmath>
#include <limits>

#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/observation/reference/site_from_picture.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal::test {
namespace {

using simulator::SceneMarker;

constexpr double kSamePlace = 0.25;  // limit of a position's error, relative to a diameter or a grating's side; chosen

// Returns the scene's marker whose circle (or grating, below) is at an image position, otherwise null.
const SceneMarker* circle_at(const CrowdedScene& scene, ImagePoint p, double diameter_px) {
  for (const SceneMarker& m : scene.scenario.markers) {
    if (m.print.circle && length(project(scene.scenario, 0, m.print.circle->centre) - p) < kSamePlace * diameter_px)
      return &m;
  }
  return nullptr;
}

const SceneMarker* grating_at(const CrowdedScene& scene, ImagePoint p, double px_per_mm) {
  for (const SceneMarker& m : scene.scenario.markers) {
    if (m.print.grating && length(project(scene.scenario, 0, m.print.grating->centre) - p) <
                               kSamePlace * px_per_mm * m.print.grating->width_mm)
      return &m;
  }
  return nullptr;
}

struct Roles {
  int references = 0;             // among the four true ones, each with its own grating
  int look_alikes = 0;            // false candidates among the references
  std::size_t target = SIZE_MAX;  // index of the true target in the site
  std::string wrong;
};

Roles roles_in(const CrowdedScene& scene, const Reference& reference) {
  Roles roles;
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const SceneMarker* print = nullptr;
    if (marker.grating) {
      const View& view = reference.view;
      print = grating_at(scene, view(marker.grating->centre), 1.0 / view.mm_per_px(marker.grating->centre));
      if (print == nullptr) roles.wrong += " grating of '" + marker.name + "' is none;";
    }
    if (marker.role == Role::kTarget) {
      if (print != nullptr && print->print.name == "mid")
        roles.target = i;
      else if (print != nullptr && print->print.name != "spare")
        roles.wrong += " '" + print->print.name + "' identified as a target;";
      continue;
    }
    const auto& seen = reference.seen.markers[i].circle;
    if (!seen) {
      roles.wrong += " no circle for '" + marker.name + "';";
      continue;
    }
    const SceneMarker* circle = circle_at(scene, seen->centre, seen->diameter_px);
    const bool is_true = circle != nullptr && circle->listed;
    if (print != nullptr && print->print.role == Role::kTarget) roles.wrong += " target identified as a reference;";
    if (is_true && (print == circle || !marker.grating))
      ++roles.references;
    else if (!is_true)
      ++roles.look_alikes;
  }
  return roles;
}

// Returns the angle from the rig's x to the site's x, rad, a whole number of quarter turns. A roll beyond 45 deg
// changes the axis that is nearest to the horizontal of the image.
double quarter_turn(const CrowdedScene& scene, const Reference& reference, std::size_t target) {
  const BoardPoint middle = reference.site.markers[target].grating->centre;
  const auto x = reference.view({middle.x + 10.0, middle.y}) - reference.view(middle);
  const auto from_middle = [&](BoardPoint p) {
    return project(scene.scenario, 0, p) - project(scene.scenario, 0, {0.0, 0.0});
  };
  const auto right = from_middle({10.0, 0.0}), up = from_middle({0.0, 10.0});
  const double along_right = x.x * up.y - x.y * up.x, along_up = right.x * x.y - right.y * x.x;
  const double det = right.x * up.y - right.y * up.x;
  return 0.5 * kPi * std::round(std::atan2(along_up / det, along_right / det) / (0.5 * kPi));
}

// Compares the target's displacement in the moved frame with the truth, for any quarter turn of the board's axes.
void compare_identity(const CrowdedScene& scene, const Image<std::uint8_t>& moved, const Reference& reference,
                      std::size_t target, IdentityVerdict& out) {
  const Method* method = method_named("two-stage");
  Follower follower(reference);
  Observation seen = method->observe({moved.view(), 8}, reference, follower.prediction());
  seen.frame = kMovedFrame;
  const auto& truth_of = *simulator::find_marker(scene.scenario, "mid");
  const auto truth = simulator::truth(scene.scenario, kMovedFrame, truth_of);
  for (const Sample& sample : method->solve(reference, {seen}, {}).samples) {
    if (sample.marker != target || !has_numbers(sample.status)) continue;
    const double turn = quarter_turn(scene, reference, target);
    const double ex = std::cos(turn) * truth.dx_mm + std::sin(turn) * truth.dy_mm;
    const double ey = -std::sin(turn) * truth.dx_mm + std::cos(turn) * truth.dy_mm;
    out.error_mm = std::hypot(sample.displacement.x - ex, sample.displacement.y - ey);
    out.u_mm = std::hypot(sample.u.x, sample.u.y);
  }
}

}  // namespace

const char* word_for(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight:
      return "right";
    case Verdict::kRefused:
      return "refused";
    case Verdict::kExtra:
      return "extra";
    case Verdict::kWrong:
      return "wrong";
  }
  return "";
}

Shots shots_of(const CrowdedScene& scene) { return {picture_of(scene, 0), picture_of(scene, kMovedFrame)}; }

IdentityVerdict judged(const CrowdedScene& scene, const Shots& shots, Knowledge knowledge) {
  IdentityVerdict out;
  out.error_mm = out.u_mm = std::numeric_limits<double>::quiet_NaN();
  const GreyPicture picture{shots.at_rest.view(), 8};
  Site site = scene.site;
  if (knowledge == Knowledge::kPitchOnly) {
    auto found = site_from_picture(picture, Camera{}, {10.0, BoardAxes::kPrint, {}});
    if (!found) {
      out.words = found.error().message;
      return out;
    }
    site = std::move(*found);
  }
  const auto reference = make_reference(picture, site, Camera{}, {});
  if (!reference) {
    out.words = reference.error().message;
    return out;
  }
  const Roles roles = roles_in(scene, *reference);
  out.words = roles.wrong;
  if (roles.target != SIZE_MAX) compare_identity(scene, shots.moved, *reference, roles.target, out);
  out.verdict = Verdict::kWrong;
  const bool complete = roles.references == 4 && roles.target != SIZE_MAX && roles.wrong.empty();
  if (complete) out.verdict = roles.look_alikes == 0 ? Verdict::kRight : Verdict::kExtra;
  out.words += " references " + std::to_string(roles.references) + ", look-alikes " + std::to_string(roles.look_alikes);
  if (roles.target == SIZE_MAX) out.words += ", no target";
  return out;
}

}  // namespace moiregauge::internal::test
