// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_status.h"

#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/observation/frame/patch_of_points.h"

namespace moiregauge::internal {
namespace {

// Residual beyond noise relative to the template's contrast, rms, above which a grating is partly covered. It
// corresponds to a sixteenth of hidden grating. Blur by half a pitch, with the contrast fitted, leaves 0.17. Chosen.
constexpr double kHiddenContrast = 0.25;

// Returns the status of a grating's image: kOk, or its fault.
Status quality_of(const Reference& reference, const MarkerObservation& seen, std::size_t i) {
  const PatchReading& then = reference.seen.markers[i].patch;
  // Paper that is clipped in both frames is in the template, too, and the edges of dark lines remain.
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
