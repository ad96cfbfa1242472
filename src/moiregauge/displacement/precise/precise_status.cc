// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_status.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "moiregauge/displacement/sample_parts.h"
#include "moiregauge/observation/frame/patch_of_points.h"

namespace moiregauge::internal {
namespace {

// Residual beyond noise relative to the template's contrast, rms, above which a grating is partly covered. It
// corresponds to a sixteenth of hidden grating. Blur by half a pitch, with the contrast fitted, leaves 0.17. Chosen.
constexpr double kHiddenContrast = 0.25;

constexpr double kMay = 2.0;           // coverage factor once the target is known to move. Chosen.
constexpr double kSureAlone = 6.0;     // coverage factor of a single row, whose number of frames is unknown. Chosen.
constexpr double kHidden = 0.3;        // share of a height that the camera's pose may take. Chosen.
constexpr double kFalseAlarms = 1e-3;  // per run; chosen

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

// Returns the coverage factor that the largest of `rows` normal variables exceeds with less than that chance.
double sure_among(std::size_t rows) { return std::sqrt(2.0 * std::log(static_cast<double>(rows) / kFalseAlarms)); }

bool exceeds_u(const OutOfPlane& moved, const Sample& sample) {
  return std::abs(moved.apparent.x) > sample.u.x || std::abs(moved.apparent.y) > sample.u.y;
}

struct MovingTarget {
  OutOfPlane largest;
  long rows = 0;
};

std::string note_on(const std::string& name, const MovingTarget& target) {
  const OutOfPlane& moved = target.largest;
  return fmt::format(
      "'{}' moves by up to {:.3g} mm (u {:.2g} mm) {} the camera, which appears as a displacement of ({:.3g}, {:.3g}) "
      "mm: {} of its rows are untrusted. Remedy: record from straight in front of '{}'",
      name, std::abs(moved.height_mm), std::hypot(moved.u_mm, kHidden * moved.height_mm),
      moved.height_mm > 0.0 ? "towards" : "away from", moved.apparent.x, moved.apparent.y, target.rows, name);
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

bool may_matter(const OutOfPlane& moved, const Sample& sample) { return moved.in_u > kMay && exceeds_u(moved, sample); }

bool is_out_of_plane(const OutOfPlane& moved, const Sample& sample) {
  return moved.in_u > kSureAlone && exceeds_u(moved, sample);
}

std::vector<std::string> distrust_out_of_plane(const Site& site, std::span<const RowOutOfPlane> rows,
                                               Samples& samples) {
  std::map<std::size_t, MovingTarget> targets;
  const double sure = sure_among(samples.size());
  for (const RowOutOfPlane& row : rows) {
    if (!(row.moved.in_u > sure)) continue;
    OutOfPlane& largest = targets[samples[row.sample].marker].largest;
    if (std::abs(row.moved.height_mm) > std::abs(largest.height_mm)) largest = row.moved;
  }
  for (const RowOutOfPlane& row : rows) {
    Sample& sample = samples[row.sample];
    const auto target = targets.find(sample.marker);
    if (target == targets.end()) continue;
    if (sample.status == Status::kOk) sample.status = Status::kUntrusted;
    target->second.rows += sample.status == Status::kUntrusted;
  }
  std::vector<std::string> notes;
  for (const auto& [marker, target] : targets) notes.push_back(note_on(site.markers[marker].name, target));
  return notes;
}

}  // namespace moiregauge::internal
