// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/bundle_frames.h"

#include <cmath>

#include "moiregauge/calibration/pose.h"
#include "moiregauge/displacement/follower.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge {
namespace {

BundleFrame bundle_frame(const Reference& reference, const Observation& seen, const Camera& camera,
                         const std::vector<BoardExtent>& travel) {
  BundleFrame frame;
  frame.frame = seen.frame;
  frame.time_s = seen.time_s;
  frame.pose = pose_of(seen.stage2, camera);
  const std::vector<bool> doubtful = references_in_doubt(reference, seen);
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    const bool usable = seen.markers[i].loss == Loss::kNone && !doubtful[i];
    frame.points.push_back(usable ? seen.markers[i].points : std::nullopt);
    frame.shift.push_back(is_target(reference, i) ? BoardExtent{or_zero(travel[i].x), or_zero(travel[i].y)}
                                                  : BoardExtent{});
  }
  return frame;
}

}  // namespace

std::size_t references_in(const Site& site, const BundleFrame& frame) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i)
    if (frame.points[i].has_value() && site.markers[i].role == Role::kReference) ++count;
  return count;
}

BundleFrames bundle_frames(const Reference& reference, const std::vector<Observation>& observations,
                           const Camera& camera, const SolveOptions& options, std::size_t least) {
  const auto rests = [&](long frame) { return options.rest && options.rest->holds(frame); };
  const std::vector<BoardExtent> still(reference.site.markers.size());
  BundleFrames out;
  out.place.assign(observations.size(), 0);
  out.frames.push_back(bundle_frame(reference, reference.seen, camera, still));
  out.frames.front().at_rest = rests(reference.seen.frame);
  if (references_in(reference.site, out.frames.front()) < least) return out;
  Follower follower(reference);
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation& seen = observations[n];
    const auto travel = follower.follow(reference, seen);
    if (seen.decode_error || !seen.references_seen || seen.frame == reference.seen.frame) continue;
    BundleFrame frame = bundle_frame(reference, seen, camera, travel);
    frame.at_rest = rests(seen.frame);
    if (references_in(reference.site, frame) < least) continue;
    out.place[n] = out.frames.size();
    out.frames.push_back(std::move(frame));
  }
  return out;
}

std::vector<BundleFrame> with_codec_error(const BundleFrames& all, const CodecHistory& codec) {
  std::vector<BundleFrame> out = all.frames;
  if (!codec.is_lossy() || out.empty()) return out;
  out.front() = with_codec_error(out.front(), codec, std::nullopt);
  for (std::size_t n = 0; n < all.place.size(); ++n) {
    if (all.place[n] > 0) out[all.place[n]] = with_codec_error(out[all.place[n]], codec, n);
  }
  return out;
}

}  // namespace moiregauge
