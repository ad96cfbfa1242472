// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/precise_status.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "moiregauge/displacement/sample_parts.h"

namespace moiregauge::internal {
namespace {

constexpr double kSureAlone = 6.0;     // coverage factor of a single row, whose number of frames is unknown. Chosen.
constexpr double kSurely = 2.0;        // coverage factor of a least value
constexpr double kFalseAlarms = 1e-3;  // per run; chosen

// Returns the coverage factor that the largest of `rows` normal variables exceeds with less than that chance.
double sure_among(std::size_t rows) { return std::sqrt(2.0 * std::log(static_cast<double>(rows) / kFalseAlarms)); }

// The pose takes a part of the movement, so the height is a least value.
std::string note_on(const std::string& name, const OutOfPlane& moved, bool knows_focal_length) {
  const char* direction = moved.height_mm > 0.0 ? "towards" : "away from";
  if (!knows_focal_length)
    return fmt::format(
        "'{}' moves {} the camera. The focal length is not known to 10 %, so neither the length of this movement nor "
        "the displacement as which it appears is known. None of its rows is trusted. Remedy: calibrate the camera and "
        "give --camera, or record from straight in front of '{}', with the references far apart",
        name, direction, name);
  const double least_mm = std::max(0.0, std::abs(moved.height_mm) - kSurely * moved.u_mm);
  const double appears_mm = std::hypot(moved.apparent.x, moved.apparent.y) * least_mm / std::abs(moved.height_mm);
  return fmt::format(
      "'{}' moves {} the camera by at least {:.2g} mm, which appears as a displacement of at least {:.2g} mm. None of "
      "its rows is trusted. Remedy: record from straight in front of '{}', with the references far apart",
      name, direction, least_mm, appears_mm, name);
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
  return image_status(reference, seen.markers[i], i);
}

bool may_matter(const OutOfPlane& moved, const Sample& sample) {
  return std::abs(moved.apparent.x) > sample.u.x || std::abs(moved.apparent.y) > sample.u.y;
}

bool is_out_of_plane(const OutOfPlane& moved, const Sample& sample) {
  return moved.in_u > kSureAlone && may_matter(moved, sample);
}

std::vector<std::string> distrust_out_of_plane(const Site& site, std::span<const RowOutOfPlane> rows,
                                               std::span<const HeightSeries> heights, Samples& samples,
                                               bool knows_focal_length) {
  std::map<std::size_t, OutOfPlane> targets;  // largest movement
  const double sure = sure_among(samples.size());
  for (const RowOutOfPlane& row : rows) {
    const std::size_t marker = samples[row.sample].marker;
    if (!(row.moved.in_u > sure || heights[marker].scatters() || heights[marker].drifts())) continue;
    OutOfPlane& largest = targets[marker];
    if (std::abs(row.moved.height_mm) > std::abs(largest.height_mm)) largest = row.moved;
  }
  for (Sample& sample : samples) {
    const bool is_reference = sample.u.x == 0.0 && sample.u.y == 0.0;  // zero by definition
    if (targets.contains(sample.marker) && !is_reference && sample.status == Status::kOk)
      sample.status = Status::kUntrusted;
  }
  std::vector<std::string> notes;
  for (const auto& [marker, moved] : targets)
    notes.push_back(note_on(site.markers[marker].name, moved, knows_focal_length));
  return notes;
}

}  // namespace moiregauge::internal
