// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/observe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "moiregauge/geometry/pose.h"
#include "moiregauge/observation/frame/discs_near.h"
#include "moiregauge/observation/frame/follow_marker.h"
#include "moiregauge/observation/frame/slipped_circle.h"
#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

struct Located {
  std::vector<CirclePoint> points;
  std::vector<std::optional<DetectedCircle>> circles;  // one per site marker
  std::string problem;
  CircleSearch search;  // the search that found them
};

// Search distance around a circle's last position, in diameters. It excludes neighbouring circles. If a circle is
// missing, the whole image is searched. Chosen.
constexpr double kCircleReach = 0.75;

CircleSearch search_near(const GreyPicture& picture, const Reference& reference, const IdealFromBoard& predicted) {
  CircleSearch search;
  const View view{predicted, reference.lens};
  for (const CirclePoint& point : reference.circles) {
    const double diameter = reference.diameter_px(point, view);
    for (const DetectedCircle& circle : find_circles_near(picture.luma, view(point.board), diameter,
                                                          kCircleReach * diameter, reference.options.circles))
      search.circles.push_back(circle);
  }
  return search;
}

Located located(const Reference& reference, const CircleSearch& search, const Identified& who) {
  Located result;
  result.points = circle_points(reference.site, reference.lens, search, who);
  result.circles.resize(reference.site.markers.size());
  for (std::size_t i = 0; i < result.circles.size(); ++i) {
    if (who.circle_of_marker[i] >= 0)
      result.circles[i] = search.circles[static_cast<std::size_t>(who.circle_of_marker[i])];
  }
  result.search = search;
  return result;
}

// Identifies three circles by their positions in the previous frame, because three alone do not determine their
// identity.
Located as_before(const Reference& reference, const CircleSearch& near, const IdealFromBoard& predicted) {
  const View view{predicted, reference.lens};
  Identified who;
  who.circle_of_marker.assign(reference.site.markers.size(), -1);
  who.image_from_board = Homography<frame::Image, frame::Board>(predicted.matrix());
  for (const CirclePoint& point : reference.circles) {
    const ImagePoint there = view(point.board);
    double nearest = kCircleReach * reference.diameter_px(point, view);
    for (std::size_t i = 0; i < near.circles.size(); ++i) {
      const double away = length(near.circles[i].centre - there);
      if (away < nearest) nearest = away, who.circle_of_marker[point.marker] = static_cast<int>(i);
    }
  }
  return located(reference, near, who);
}

bool reads_all_gratings(const Reference& reference) {
  return std::ranges::all_of(reference.circles, [&](const CirclePoint& point) {
    return reference.site.markers[point.marker].grating && reference.seen.markers[point.marker].patch.valid;
  });
}

Located locate(const GreyPicture& picture, const Reference& reference, const Prediction& prediction,
               std::size_t least) {
  // With a grating at each circle, coarse centres suffice: the second homography does not depend on them.
  if (prediction.expected && reads_all_gratings(reference)) {
    Identified who;
    const auto discs = discs_near(picture, reference, *prediction.expected, Rows::kAll, who);
    if (discs) return located(reference, *discs, who);
  }
  const IdealFromBoard& last = prediction.view ? *prediction.view : reference.seen.stage1;
  const PreviousCircles previous{Homography<frame::Image, frame::Board>(last.matrix()), 0.0};
  CircleSearch near;
  if (prediction.view) {
    near = search_near(picture, reference, *prediction.view);
    if (near.circles.size() >= reference.circles.size()) {
      const auto who = identify_next(reference.site, near, previous);
      if (who) {
        Located result = located(reference, near, *who);
        if (result.points.size() == reference.circles.size()) return result;
      }
    }
  }
  const CircleSearch whole = find_circles(picture.luma, reference.options.circles);
  const auto who = identify_next(reference.site, whole, previous);
  if (who) return located(reference, whole, *who);
  if (prediction.view && near.circles.size() >= least) {
    Located result = as_before(reference, near, *prediction.view);
    if (result.points.size() >= least) return result;
  }
  return {{}, {}, who.error().reason, {}};
}

// Returns the view from `board` to `ideal`: a homography through four points or more, or the pose of a known camera
// through three.
std::optional<IdealFromBoard> view_through(const Reference& reference, std::span<const BoardPoint> board,
                                           std::span<const IdealPoint> ideal, const IdealFromBoard& near) {
  if (board.size() == 3 && reference.knows_camera()) return view_of_three(board, ideal, reference.lens, near);
  const auto fitted = fit_homography<frame::Ideal, frame::Board>(board, ideal);
  return fitted ? std::optional(IdealFromBoard(*fitted)) : std::nullopt;
}

std::optional<IdealFromBoard> first_view(const Reference& reference, const std::vector<CirclePoint>& circles,
                                         const Prediction& prediction) {
  std::vector<BoardPoint> board;
  std::vector<IdealPoint> ideal;
  for (const CirclePoint& p : circles) board.push_back(p.board), ideal.push_back(p.ideal);
  return view_through(reference, board, ideal, prediction.view.value_or(reference.seen.stage1));
}

// Limits for the circle of a reference that slipped out of the layout: the nearest one of the same size. Its template
// decides whether the grating belongs to it.
constexpr double kSlipReach = 1.5;  // diameters; chosen
constexpr double kSameSize = 0.1;   // relative; chosen

const DetectedCircle* circle_of_slipped(const Reference& reference, const Located& now, const View& view,
                                        const CirclePoint& lost) {
  const double diameter = reference.diameter_px(lost, view);
  const ImagePoint place = view(lost.board);
  const DetectedCircle* nearest = nullptr;
  double away = kSlipReach * diameter;
  for (const DetectedCircle& circle : now.search.circles) {
    const bool is_another = std::any_of(now.circles.begin(), now.circles.end(), [&](const auto& other) {
      return other && length(other->centre - circle.centre) < 0.5 * diameter;
    });
    if (is_another || std::abs(circle.diameter_px - diameter) > kSameSize * diameter) continue;
    if (length(circle.centre - place) < away) away = length(circle.centre - place), nearest = &circle;
  }
  return nearest;
}

// Reads the grating of a slipped reference, with its circle. It counts as covered until its template matches.
void read_slipped(const BoardPicture& now, const Reference& reference, std::size_t i, const DetectedCircle& circle,
                  MarkerObservation& seen) {
  const auto went = now.view.board(circle.centre) - reference.view.board(reference.seen.markers[i].circle->centre);
  seen.circle = circle;
  follow_marker(now, reference, i, went, seen);
  if (seen.loss == Loss::kNone) seen.loss = Loss::kCovered;
}

void read_marker(const BoardPicture& now, const Reference& reference, std::size_t i, MarkerObservation& seen) {
  seen.loss = reference.plan_loss[i];
  if (!reference.site.markers[i].grating || seen.loss != Loss::kNone) return;
  seen.patch = read_patch(now.picture.luma, now.picture.bits, now.view, reference.plans[i], {});
  seen.loss = loss_of(reference.seen.markers[i].patch, seen.patch);
}

}  // namespace

Observation observe_conventional(const GreyPicture& picture, const Reference& reference, const Prediction&) {
  Observation observation;
  observation.references_seen = true;
  observation.stage1 = observation.stage2 = reference.seen.stage1;
  observation.markers.resize(reference.site.markers.size());
  for (std::size_t i = 0; i < observation.markers.size(); ++i)
    read_marker({picture, reference.view}, reference, i, observation.markers[i]);
  return observation;
}

std::optional<IdealFromBoard> second_view(const Reference& reference, const std::vector<CirclePoint>& circles,
                                          const Observation& seen) {
  std::vector<BoardPoint> then;
  std::vector<IdealPoint> refined;
  for (const CirclePoint& point : circles) {
    const MarkerObservation& now = seen.markers[point.marker];
    if (now.loss != Loss::kNone) continue;
    Extent<frame::Board> moved;
    if (reference.site.markers[point.marker].grating)
      moved =
          displacement_between(reference.plans[point.marker], reference.seen.markers[point.marker].patch, now.patch);
    then.push_back(point.board);
    refined.push_back(seen.stage1(point.board + known_part(moved)));
  }
  return view_through(reference, then, refined, seen.stage1);
}

namespace {

std::string too_few(std::size_t least, const char* what) {
  return std::string(least == kMinForPose ? "fewer than three " : "fewer than four ") + what;
}

// Returns the distance by which a lossy codec may leave a reference's grating behind, from its weaker fundamental. 0
// for other footage.
double lag_mm(const GreyPicture& picture, const Reference& reference, const CirclePoint& point) {
  if (!(picture.rounding > 0.0)) return 0.0;
  const RasterPlan& plan = reference.plans[point.marker];
  const auto& modulation = reference.seen.markers[point.marker].patch.modulation;
  const double least = !plan.reads_y   ? modulation[0]
                       : !plan.reads_x ? modulation[1]
                                       : std::min(modulation[0], modulation[1]);
  const double mm_per_px = reference.view.mm_per_px(point.board);
  const double slope = least * kTwoPi * mm_per_px / plan.pitch_mm / std::sqrt(2.0);
  return std::min(dead_zone_px(picture.rounding / rounding_of_step(1.0), slope), 2.0 * kMaxLag_px) * mm_per_px;
}

}  // namespace

Observation observe_board(const GreyPicture& picture, const Reference& reference, const Prediction& prediction,
                          std::size_t least) {
  Observation observation;
  observation.markers.resize(reference.site.markers.size());
  // Step 1: circles, first homography.
  Located now = locate(picture, reference, prediction, least);
  observation.reference_problem = now.problem;
  const auto slipped = remove_slipped(reference, now.points);
  const auto first = first_view(reference, now.points, prediction);
  if (!first) {
    if (observation.reference_problem.empty())
      observation.reference_problem = too_few(least, "reference circles are visible");
    return observation;
  }
  observation.stage1 = observation.stage2 = *first;
  for (std::size_t i = 0; i < now.circles.size(); ++i) observation.markers[i].circle = now.circles[i];
  // Step 2: gratings of the references, whose displacements are added at their circles.
  const View view{*first, reference.lens};
  const BoardPicture board{picture, view};
  for (const CirclePoint& point : now.points)
    read_marker(board, reference, point.marker, observation.markers[point.marker]);
  for (const CirclePoint& point : now.points) {
    MarkerObservation& seen = observation.markers[point.marker];
    const auto& at_rest = reference.seen.markers[point.marker].patch;
    // A status can report the partial reading of a target. That of a reference would spoil every target.
    if (seen.loss == Loss::kNone && reference.site.markers[point.marker].grating &&
        is_bent(reference.plans[point.marker], at_rest, seen.patch, lag_mm(picture, reference, point)))
      seen.loss = Loss::kCovered;
  }
  for (const CirclePoint& point : reference.circles) {
    const std::size_t i = point.marker;
    const DetectedCircle* circle = nullptr;
    if (slipped == i)
      circle = &*now.circles[i];
    else if (!now.circles[i] && now.points.size() + 1 >= kMinReferencesForSlip)
      circle = circle_of_slipped(reference, now, view, point);
    if (circle) read_slipped(board, reference, i, *circle, observation.markers[i]);
  }
  const auto second = second_view(reference, now.points, observation);
  if (!second) {
    observation.reference_problem = too_few(least, "references have a readable grating");
    return observation;
  }
  observation.stage2 = *second;
  observation.references_seen = true;
  // Step 3: targets, through the second homography.
  const View refined{*second, reference.lens};
  for (std::size_t i = 0; i < observation.markers.size(); ++i) {
    if (reference.site.markers[i].role != Role::kTarget) continue;
    follow_marker({picture, refined}, reference, i, prediction.last_travel(i), observation.markers[i]);
  }
  return observation;
}

Observation observe_two_stage(const GreyPicture& picture, const Reference& reference, const Prediction& prediction) {
  return observe_board(picture, reference, prediction, kMinForHomography);
}

}  // namespace moiregauge::internal
