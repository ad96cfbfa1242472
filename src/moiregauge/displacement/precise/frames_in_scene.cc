// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/frames_in_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/continuity.h"
#include "moiregauge/displacement/precise/precise_status.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge::internal {
namespace {

// Largest noise of an axis that the grating shows; beyond it the axis is NaN. Chosen.
constexpr double kShownWithin = 0.25;  // pitches

// Estimates of a target's error in one frame. Each starts from a pose that the target bends less. Chosen.
constexpr int kOwnErrorRounds = 3;

// Returns the noise of a displacement.
Extent<frame::Board> noise_of(const Budget& b) { return hypot3(b.noise, b.references, b.reference_frame); }

void fill(Sample& sample, const Marker& marker, const FramesInScene::SolvedFrame& frame, const FrameFit& then,
          double rotation_rad) {
  const std::size_t i = sample.marker;
  if (!frame.budget || std::isnan(then.shift[i].x)) {
    sample.status = Status::kLost;
    return;
  }
  sample.displacement = frame.now.shift[i] - then.shift[i];
  Grating grating = *marker.grating;
  grating.angle_rad += rotation_rad;
  const auto moved = with_movement_along_lines(grating, sample.displacement);
  sample.budget = frame.by_noise.now.ok ? frame.budget->budget(frame.by_noise.now, frame.by_noise.then, i, moved)
                                        : frame.budget->budget(i, moved);
  add_movement_along_lines(grating, 0.0, sample);
  sample.u = total(sample.budget);
  // Only noise decides this: far from the reference frame u is mostly that of scale and axis.
  const auto noise = noise_of(sample.budget);
  for (const auto axis : {&BoardExtent::x, &BoardExtent::y}) {
    if (!(noise.*axis < kShownWithin * grating.pitch_mm)) sample.displacement.*axis = kNotMeasured;
  }
  withhold_unshown_axes(sample);
}

void add_to_part(Extent<frame::Board> Budget::*part, Extent<frame::Board> u, Sample& sample) {
  sample.budget.*part = hypot3(sample.budget.*part, u, {});
  const auto all = total(sample.budget);
  for (const auto axis : {&BoardExtent::x, &BoardExtent::y}) {
    if (!std::isnan(sample.u.*axis)) sample.u.*axis = all.*axis;
  }
}

// Adds the uncertainty of the target's own motion, within its exposure or until the frame time. `u`: by place.
void widen_by_motion(Sample& sample, const std::vector<std::vector<Extent<frame::Board>>>& u, std::size_t place) {
  if (u.empty()) return;
  const auto now = u[place][sample.marker], then = u.front()[sample.marker];
  add_to_part(&Budget::shutter, hypot3(now, then, {}), sample);
}

}  // namespace

FramesInScene::FramesInScene(const Reference& reference, const PreciseScene& scene, std::optional<FrameSeries> by_noise)
    : reference_(reference),
      site_(reference.site),
      solved_(scene),
      scene_(scene.calibration.bundle.scene),
      by_noise_(std::move(by_noise)),
      // The reference frame is the first key frame.
      budget_(site_, scene_.full_covariance, scene.calibration.fits.front(),
              scene.shutter ? scene.shutter->u_readout_s : 0.0),
      heights_then_(shown_heights(site_, scene_, solved_.frames.front(), budget_.then())) {}

// Returns the uncertainty by the targets' movements beyond displacement, mm. Empty: there are none.
std::vector<Extent<frame::Board>> FramesInScene::u_by_movement(const BundleFrame& placed) const {
  std::vector<Extent<frame::Board>> out;
  if (!solved_.movements) return out;
  const BundleFrame& then = solved_.calibration.bundle.frames.front();
  for (std::size_t i = 0; i < site_.markers.size(); ++i) {
    // A movement along the true normal appears along the solved one.
    const double height_mm = placed.removed.empty() || then.removed.empty()
                                 ? 0.0
                                 : (placed.removed[i] - then.removed[i])(MovementAxis::kHeight);
    out.push_back(
        hypot3(solved_.movements->u_beyond_noise(i, placed, then), std::abs(height_mm) * budget_.u_normal(), {}));
  }
  return out;
}

std::optional<OutOfPlane> FramesInScene::movement_out_of_plane(std::size_t marker, const SolvedFrame& frame) const {
  if (frame.heights.empty() || !frame.heights[marker] || !heights_then_[marker]) return std::nullopt;
  return out_of_plane(*frame.heights[marker], *heights_then_[marker]);
}

Sample FramesInScene::sample_of(const Observation& seen, std::size_t marker, const SolvedFrame& frame,
                                bool is_far) const {
  Sample sample = initial_sample(reference_, seen, marker);
  if (seen.frame == reference_.seen.frame) return sample;
  sample.status = precise_status(reference_, seen, marker, frame.now, solved_.shutter ? kRollingChi2 : kUntrustedChi2);
  const bool unproven = is_far && seen.markers[marker].order == Order::kUnproven;
  if (unproven && has_numbers(sample.status)) sample.status = Status::kOrderUnproven;
  if (has_numbers(sample.status))
    fill(sample, site_.markers[marker], frame, budget_.then(), scene_.markers[marker].value[MarkerShape::kRotation]);
  if (!frame.u_by_movement.empty() && has_numbers(sample.status))
    add_to_part(&Budget::geometry, frame.u_by_movement[marker], sample);
  return sample;
}

void FramesInScene::measure(const Observations& observations, const std::vector<std::size_t>& place,
                            Solution& solution) const {
  SolvedFrame solved;
  if (by_noise_) solved.by_noise.then = fit_by_noise(0, solved_.calibration.bundle.frames.front());
  const std::vector<bool> outruns = outruns_continuity(site_, solved_.frames.starts());
  std::vector<RowOutOfPlane> out_of_plane_rows;
  std::vector<HeightSeries> heights(site_.markers.size());
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation& seen = observations[n];
    const FrameFit& now = solved.now;
    solved.budget.reset();
    solved.now = {};
    solved.heights.clear();
    solved.u_by_movement.clear();
    if (place[n] > 0) {
      const BundleFrame read = solved_.frames[place[n]];
      BundleFrame frame = placed(read);
      solved.now = fit_with_own_errors(frame, FrameDetail::kSamples);
      solved.u_by_movement = u_by_movement(frame);
      solved.heights = shown_heights(site_, scene_, read, solved.now);
      if (by_noise_) solved.by_noise.now = fit_by_noise(place[n], frame);
    }
    solution.poses.push_back(budget_.pose(seen.frame == reference_.seen.frame ? budget_.then() : now));
    if (now.ok && budget_.then().ok) solved.budget.emplace(budget_.of_frame(now));
    solution.chi2_dof.push_back(now.ok && now.dof > 0 ? now.chi2_sum / static_cast<double>(now.dof) : kNotMeasured);
    for (std::size_t i = 0; i < site_.markers.size(); ++i) {
      if (!is_target(reference_, i)) continue;
      Sample sample = sample_of(seen, i, solved, outruns[i]);
      if (seen.frame != reference_.seen.frame && has_numbers(sample.status)) {
        if (solved_.shutter) widen_by_motion(sample, solved_.shutter->u_target, place[n]);
        widen_by_motion(sample, solved_.smear, place[n]);
      }
      const auto moved = movement_out_of_plane(i, solved);
      if (moved && sample.status == Status::kOk) heights[i].add(*solved.heights[i]);
      if (moved && sample.status == Status::kOk && may_matter(*moved, sample))
        out_of_plane_rows.push_back({solution.samples.size(), *moved});
      solution.samples.push_back(judged(sample));
    }
  }
  const bool knows_f = knows_focal_length(scene_, scene_.stated_covariance());
  auto notes = distrust_out_of_plane(site_, out_of_plane_rows, heights, solution.samples, knows_f);
  // Such a target bends the camera's pose, and the references may then seem to move.
  if (!notes.empty()) {
    solution.remedy = fmt::format(
        "record from straight in front of the targets, with the references far apart{}, because a target moves out of "
        "its plane",
        knows_f ? "" : ", or calibrate the camera and give --camera");
  }
  std::ranges::move(notes, std::back_inserter(solution.notes));
}

// Returns the rotations of all targets. `frame`, `fit`: at this place, without the movements that were removed. That
// fit leaves them open, so the covariance of noise is used again.
FrameRotations FramesInScene::rotations_in(std::size_t place, BundleFrame frame, const FrameFit& fit) const {
  if (!solved_.movements) return fit_rotations(site_, scene_, frame, fit);
  const BundleFrame by_noise = weighed(solved_.with_movements[place]);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.points[i]) frame.points[i]->information = by_noise.points[i]->information;
  }
  FrameRotations out = fit_rotations(site_, scene_, frame, fit_frame(site_, scene_, frame));
  for (std::size_t i = 0; i < frame.removed.size(); ++i) {
    if (out.row[i] >= 0) out.angle_rad(out.row[i]) += frame.removed[i](MovementAxis::kInPlane);
  }
  return out;
}

// The fit of the reference frame is that of the budget, so its rotation uses the same noise.
FittedFrame FramesInScene::reference_fit() const {
  const PrintError share{.noise_share = solved_.print_error.noise_share};
  const BundleFrame frame =
      with_print_error(site_, std::span(&solved_.calibration.bundle.frames.front(), 1), share).front();
  FittedFrame out{budget_.then(), {}, rotations_in(0, frame, budget_.then()), {}};
  out.u_motion = u_motion(0);
  return out;
}

FittedFrame FramesInScene::fit_of(std::size_t place) const {
  FittedFrame out;
  BundleFrame frame = placed(solved_.frames[place]);
  out.fit = fit_with_own_errors(frame, FrameDetail::kScene);
  out.rotations = rotations_in(place, frame, out.fit);
  if (by_noise_) out.by_noise = fit_by_noise(place, frame);
  out.u_motion = u_motion(place);
  const auto by_movement = u_by_movement(frame);
  if (!by_movement.empty()) out.u_motion.resize(by_movement.size());
  for (std::size_t i = 0; i < by_movement.size(); ++i) out.u_motion[i] = hypot3(out.u_motion[i], by_movement[i], {});
  return out;
}

// Returns the uncertainties by the targets' own motion, one per site marker. Empty: there is none.
std::vector<Extent<frame::Board>> FramesInScene::u_motion(std::size_t place) const {
  std::vector<Extent<frame::Board>> out;
  if (solved_.shutter) out = solved_.shutter->u_target[place];
  if (solved_.smear.empty()) return out;
  out.resize(site_.markers.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto& smear = solved_.smear[place][i];
    out[i] = {std::hypot(out[i].x, smear.x), std::hypot(out[i].y, smear.y)};
  }
  return out;
}

JointErrors FramesInScene::joint_errors(const Observations& observations, const std::vector<std::size_t>& place) const {
  const JointInScene joint(site_, scene_.full_covariance, reference_fit(),
                           solved_.shutter ? solved_.shutter->u_readout_s : 0.0);
  JointErrors out = joint.start();
  for (std::size_t n = 0; n < observations.size(); ++n) {
    if (observations[n].frame == reference_.seen.frame)
      out.frames.push_back(joint.zero());
    else
      out.frames.push_back(place[n] > 0 ? joint.errors_of(fit_of(place[n])) : joint.lost());
  }
  return out;
}

Samples FramesInScene::measure_one(const Observation& seen, const std::optional<BundleFrame>& read,
                                   const std::vector<bool>& is_far) const {
  SolvedFrame solved;
  if (read) {
    BundleFrame frame = placed(*read);
    solved.now = fit_with_own_errors(frame, FrameDetail::kSamples);
    solved.heights = shown_heights(site_, scene_, *read, solved.now);
    solved.u_by_movement = u_by_movement(frame);
  }
  if (solved.now.ok && budget_.then().ok) solved.budget.emplace(budget_.of_frame(solved.now));
  Samples samples;
  for (std::size_t i = 0; i < site_.markers.size(); ++i) {
    if (!is_target(reference_, i)) continue;
    Sample sample = sample_of(seen, i, solved, is_far[i]);
    const auto moved = movement_out_of_plane(i, solved);
    if (moved && sample.status == Status::kOk && is_out_of_plane(*moved, sample)) sample.status = Status::kUntrusted;
    samples.push_back(judged(sample));
  }
  return samples;
}

// No row of a scene in doubt is trusted.
Sample FramesInScene::judged(Sample sample) const {
  const bool is_doubtful =
      solved_.doubtful || solved_.camera_contradicted || solved_.height_contradicted || solved_.vibrates;
  if (is_doubtful && sample.frame != reference_.seen.frame && sample.status == Status::kOk)
    sample.status = Status::kUntrusted;
  return sample;
}

BundleFrame FramesInScene::weighed(const BundleFrame& frame) const {
  return with_print_error(site_, std::span(&frame, 1), solved_.print_error).front();
}

// Starts from the solved camera, because another focal length gives another pose. In rest frames the position is
// measured like any other.
BundleFrame FramesInScene::placed(const BundleFrame& seen) const {
  BundleFrame frame = weighed(seen);
  frame.pose = pose_of(site_, scene_, frame).value_or(frame.pose);
  frame.at_rest = false;
  return frame;
}

// Fits a frame, and adds to its targets' points the error that they have in this frame alone. Without it, a target that
// is blurred here would move the pose, and the other targets would seem to contradict the scene.
FrameFit FramesInScene::fit_with_own_errors(BundleFrame& frame, FrameDetail detail) const {
  FrameFit fit = fit_frame(site_, scene_, frame, detail);
  for (int round = 0; round < kOwnErrorRounds && fit.ok; ++round) {
    PrintError own;
    for (std::size_t i = 0; i < site_.markers.size(); ++i)
      own.targets_mm.push_back(is_target(reference_, i) ? error_in_frame(site_, scene_, frame, fit, i) : 0.0);
    if (!own.exceeds_noise()) break;
    frame = with_print_error(site_, std::span(&frame, 1), own).front();
    fit = fit_frame(site_, scene_, frame, detail);
  }
  return fit;
}

// Fits a frame from the result of another fit of it.
FrameFit FramesInScene::fit_by_noise(std::size_t place, const BundleFrame& from) const {
  BundleFrame frame = weighed((*by_noise_)[place]);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (!from.points[i]) frame.points[i].reset();
    if (frame.points[i]) frame.points[i]->image = from.points[i]->image;  // at frame time, for a rolling shutter
  }
  frame.pose = from.pose;
  frame.shift = from.shift;
  frame.rows = from.rows;
  frame.motion = from.motion;
  frame.at_rest = from.at_rest;
  return fit_frame(site_, scene_, frame, FrameDetail::kSamples);
}

}  // namespace moiregauge::internal
