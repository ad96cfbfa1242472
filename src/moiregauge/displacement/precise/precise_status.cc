// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_status.h"

#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/observation/frame/patch_of_points.h"

namespace moiregauge::internal {
namespace {

// A print of which pixels miss its template by more than this part of its contrast, rms, is not all there: a sixteenth
// of it is hidden. Blur by half a pitch, contrast taken out, comes to 0.17.
constexpr double kHiddenContrast = 0.25;

// Is the print whole, sharp and within the sensor's range?
Status quality_of(const Reference& reference, const MarkerObservation& seen, std::size_t i) {
  const PatchReading& then = reference.seen.markers[i].patch;
  // Paper that is white to the limit in both frames leaves the edges of the dark lines, and the template has them so.
  const Status sharp = sharpness(then, seen.patch, then.clipped_share);
  if (sharp != Status::kOk || !seen.points || !reference.seen.markers[i].points) return sharp;
  if (seen.occlusion != Occlusion::kNone) return Status::kPartlyCovered;
  const double missing = missing_contrast(*seen.points, *reference.seen.markers[i].points, *reference.prints[i],
                                          rounding_of_step(reference.step_of(i, seen.quantiser)));
  return missing > kHiddenContrast ? Status::kPartlyCovered : Status::kOk;
}

}  // namespace

Status precise_status(const Reference& reference, const Observation& seen, std::size_t i, const FrameFit& fit,
                      double untrusted_chi2) {
  if (seen.decode_error) return Status::kDecodeError;
  if (!seen.references_seen || !fit.ok)
    return seen.references_seen && order_in_doubt(reference, seen) ? Status::kOrderUnproven : Status::kReferenceLost;
  if (seen.markers[i].loss != Loss::kNone) return status_of_loss(seen.markers[i].loss);
  if (seen.markers[i].order == Order::kContradicted) return Status::kOrderUnproven;
  if (fit.shift_row[i] < 0) return Status::kLost;
  if (fit.chi2_sum > untrusted_chi2 * static_cast<double>(fit.dof)) return Status::kUntrusted;
  return quality_of(reference, seen.markers[i], i);
}

}  // namespace moiregauge::internal
