// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/bundle_frames.h"

#include <cmath>

#include "moiregauge/calibration/scene/frame_pose.h"
#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge::internal {
namespace {

// Returns true for markers that were read and whose lattice line is certain.
std::vector<bool> usable_points(const Reference& reference, const Observation& seen) {
  const std::vector<bool> doubtful = references_in_doubt(reference, seen);
  std::vector<bool> usable;
  for (std::size_t i = 0; i < seen.markers.size(); ++i)
    usable.push_back(seen.markers[i].loss == Loss::kNone && !doubtful[i] && seen.markers[i].points.has_value());
  return usable;
}

FrameStart start_of(const Reference& reference, const Observation& seen, const Camera& camera,
                    const std::vector<BoardExtent>& travel) {
  FrameStart start{seen.frame, seen.time_s, pose_of(seen.stage2, camera), {}, usable_points(reference, seen)};
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    start.shift.push_back(is_target(reference, i) ? BoardExtent{or_zero(travel[i].x), or_zero(travel[i].y)}
                                                  : BoardExtent{});
    start.is_flawed.push_back(is_target(reference, i) && start.has_points[i] && seen.frame != reference.seen.frame &&
                              image_status(reference, seen.markers[i], i) != Status::kOk);
  }
  return start;
}

BundleFrame frame_of(const Observation& seen, const FrameStart& start) {
  BundleFrame frame;
  frame.frame = start.frame;
  frame.time_s = start.time_s;
  frame.pose = start.pose;
  frame.shift = start.shift;
  for (std::size_t i = 0; i < seen.markers.size(); ++i)
    frame.points.push_back(start.has_points[i] ? seen.markers[i].points : std::nullopt);
  return frame;
}

std::size_t references_in(const Site& site, const FrameStart& start) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < start.has_points.size(); ++i)
    if (start.has_points[i] && site.markers[i].role == Role::kReference) ++count;
  return count;
}

}  // namespace

std::size_t references_in(const Site& site, const BundleFrame& frame) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i)
    if (frame.points[i].has_value() && site.markers[i].role == Role::kReference) ++count;
  return count;
}

BundleFrames bundle_frames(const Reference& reference, const Observations& observations, const Camera& camera,
                           const SolveOptions& options, std::size_t least) {
  const std::vector<BoardExtent> still(reference.site.markers.size());
  BundleFrames out;
  out.place.assign(observations.size(), 0);
  auto starts = std::make_shared<std::vector<FrameStart>>();
  starts->push_back(start_of(reference, reference.seen, camera, still));
  std::vector<std::size_t> observation{0};  // index for each frame; the reference frame has none: its entry is unused
  if (references_in(reference.site, starts->front()) >= least) {
    Follower follower(reference);
    for (std::size_t n = 0; n < observations.size(); ++n) {
      const Observation& seen = observations[n];
      const auto travel = follower.follow(reference, seen);
      if (seen.decode_error || !seen.references_seen || seen.frame == reference.seen.frame) continue;
      FrameStart start = start_of(reference, seen, camera, travel);
      if (references_in(reference.site, start) < least) continue;
      out.place[n] = starts->size();
      starts->push_back(std::move(start));
      observation.push_back(n);
    }
  }
  out.frames = FrameSeries(starts, [&reference, &observations, rest = options.rest, starts,
                                    observation = std::move(observation)](std::size_t k) {
    const FrameStart& start = (*starts)[k];
    BundleFrame frame = k == 0 ? frame_of(reference.seen, start) : frame_of(observations[observation[k]], start);
    frame.at_rest = rest && rest->holds(start.frame);
    return frame;
  });
  return out;
}

std::optional<BundleFrame> bundle_frame(const Reference& reference, const Observation& seen, const Camera& camera,
                                        const std::vector<BoardExtent>& travel, std::size_t least) {
  if (seen.decode_error || !seen.references_seen) return std::nullopt;
  const FrameStart start = start_of(reference, seen, camera, travel);
  if (references_in(reference.site, start) < least) return std::nullopt;
  return frame_of(seen, start);
}

FrameSeries with_codec_error(const BundleFrames& all, std::shared_ptr<const CodecHistory> codec) {
  if (!codec->is_lossy()) return all.frames;
  std::vector<std::size_t> observation(all.frames.size(), 0);
  for (std::size_t n = 0; n < all.place.size(); ++n) {
    if (all.place[n] > 0) observation[all.place[n]] = n;
  }
  return all.frames.with(
      [read = all.frames, codec = std::move(codec), observation = std::move(observation)](std::size_t k) {
        return with_codec_error(read[k], *codec, k == 0 ? std::nullopt : std::optional(observation[k]));
      });
}

}  // namespace moiregauge::internal
