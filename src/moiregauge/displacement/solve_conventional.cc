// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "moiregauge/displacement/codec_error.h"
#include "moiregauge/displacement/method.h"
#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge {
namespace {

// The camera has moved when the references have, by more than noise and a 1/2000 pitch.
constexpr double kCameraMovedPitches = 0.0005;
constexpr double kCameraMovedNoise = 5.0;

bool camera_moved(const Reference& reference, const Observation& seen) {
  for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
    if (reference.site.markers[i].role != Role::kReference || !reference.site.markers[i].grating) continue;
    const MarkerObservation& now = seen.markers[i];
    if (now.loss != Loss::kNone) return true;  // it left its window: something moved, and the references stand still
    const PatchReading& then = reference.seen.markers[i].patch;
    const BoardExtent moved = displacement_between(reference.plans[i], then, now.patch);
    const BoardExtent u = noise_mm(reference.plans[i], now.patch);
    const double allowed = kCameraMovedPitches * reference.plans[i].pitch_mm;
    if (std::abs(moved.x) > allowed + kCameraMovedNoise * std::sqrt(2.0) * u.x) return true;
    if (std::abs(moved.y) > allowed + kCameraMovedNoise * std::sqrt(2.0) * u.y) return true;
  }
  return false;
}

void measure_phase(const Reference& reference, const Observation& seen, const CodecHistory& codec, std::size_t n,
                   bool moved, Sample& sample) {
  const RasterPlan& plan = reference.plans[sample.marker];
  const PatchReading& then = reference.seen.markers[sample.marker].patch;
  const PatchReading& now = seen.markers[sample.marker].patch;
  sample.displacement = displacement_between(plan, then, now);
  sample.budget.noise = noise_mm(plan, now);
  sample.budget.reference_frame = noise_mm(plan, then);
  if (codec.is_lossy()) {
    const std::size_t i = sample.marker;
    sample.budget.codec =
        hypot3(codec_mm(reference, i, now, codec.at(n, i), Lag::kOwn),
               codec_mm(reference, i, then, codec.in_reference_frame(i), codec.lag_in_reference_frame(i)), {});
  }
  sample.u = hypot3(sample.budget.noise, sample.budget.reference_frame, sample.budget.codec);
  sample.status = moved ? Status::kCameraMoved : quality(plan, then, now);
}

}  // namespace

Solution solve_conventional(const Reference& reference, const std::vector<Observation>& observations,
                            const SolveOptions&) {
  Solution solution;
  const CodecHistory codec(reference, observations);
  for (std::size_t n = 0; n < observations.size(); ++n) {
    const Observation& seen = observations[n];
    const bool moved = !seen.decode_error && camera_moved(reference, seen);
    for (std::size_t i = 0; i < reference.site.markers.size(); ++i) {
      if (!is_target(reference, i)) continue;
      Sample sample = begun_sample(reference, seen, i);
      if (seen.frame != reference.seen.frame) {
        if (seen.decode_error)
          sample.status = Status::kDecodeError;
        else if (seen.markers[i].loss != Loss::kNone)
          sample.status = status_of_loss(seen.markers[i].loss);
        else
          measure_phase(reference, seen, codec, n, moved, sample);
      }
      solution.samples.push_back(sample);
    }
  }
  return solution;
}

}  // namespace moiregauge
