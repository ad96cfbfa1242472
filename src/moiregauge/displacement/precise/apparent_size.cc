// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/apparent_size.h"

#include <cmath>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

constexpr double kBeyond = 4.0;          // limit in u of the site; chosen
constexpr double kUnknownHeight = 0.01;  // limit of relative size: 12 mm at 1.2 m, 80 mm at 8 m; chosen
// Prior u of a grating's scale for this test. If the distance is then known to a quarter of the deviation, parallax
// determines it.
constexpr double kAnySize = 0.1;
constexpr double kKnownFocalLength = 0.1;  // largest relative u; chosen

// Returns the board's distance along the camera's axis, mean of the key frames, mm.
double mean_distance_mm(const Calibration& calibration) {
  double sum = 0.0, count = 0.0;
  for (const FrameFit& fit : calibration.fits) {
    if (fit.ok) sum += fit.pose.shift[2], count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

SizeDeviation deviation_of(std::size_t index, const Marker& marker, const MarkerShape& solved, double distance) {
  const double stated_mm = marker.z_mm.value_or(0.0);
  const double scale = solved.value[MarkerShape::kScale], height_mm = solved.value[MarkerShape::kHeight];
  SizeDeviation a;
  a.marker = index;
  // A grating at height h looks (1 + scale) D / (D - h) times as large as one of the stated pitch in the plane.
  a.larger = (1.0 + scale) * (distance - stated_mm) / (distance - height_mm) - 1.0;
  a.nearer_mm = (distance - stated_mm) * a.larger / (1.0 + a.larger);
  a.pitch_mm = marker.grating->pitch_mm * (1.0 + a.larger);
  return a;
}

double height_u_mm(const Site& site, const Calibration& calibration, ScenePrior prior, std::size_t marker) {
  double& u_scale = prior.u_markers[marker].value[MarkerShape::kScale];
  u_scale = std::hypot(u_scale, kAnySize);
  const auto covariance =
      scene_covariance(site, calibration.fits, prior, everything_with(calibration.bundle.scene.model));
  const int row = shape_row(marker, MarkerShape::kHeight);
  return std::sqrt(covariance(row, row));
}

std::string apparent_size_note(const Marker& marker, const SizeDeviation& a, double distance, bool knows_distance) {
  const bool is_larger = a.larger > 0.0;
  const double percent = 100.0 * std::abs(a.larger);
  const std::string stated =
      marker.z_mm ? fmt::format("its pitch_mm = {:.6g} and z_mm = {:.6g} give", marker.grating->pitch_mm, *marker.z_mm)
                  : fmt::format("its pitch_mm = {:.6g} gives", marker.grating->pitch_mm);
  const std::string by =
      knows_distance ? fmt::format("{:.3g} mm", std::abs(a.nearer_mm))
                     : fmt::format("{:.2g} % of the camera's distance", 100.0 * std::abs(a.nearer_mm) / distance);
  return fmt::format(
      "displacements of '{}' may be wrong by {:.2g} %{}: its grating looks {:.2g} % {} than {}. Either it is {} {} {}, "
      "or its pitch is {:.4g} mm. Measure both, and give z_mm and pitch_mm in the site file",
      marker.name, percent, marker.role == Role::kTarget ? ", which u contains" : "", percent,
      is_larger ? "larger" : "smaller", stated, by, is_larger ? "nearer" : "further away",
      marker.z_mm ? "than stated" : "than the plane of the references", a.pitch_mm);
}

}  // namespace

bool knows_focal_length(const Scene& scene, const Eigen::MatrixXd& covariance) {
  return std::sqrt(covariance(0, 0)) <= kKnownFocalLength * scene.camera.fx;
}

std::vector<SizeDeviation> size_deviations(const Site& site, const Calibration& calibration) {
  std::vector<SizeDeviation> found;
  const Scene& scene = calibration.bundle.scene;
  const double distance = mean_distance_mm(calibration);
  if (!(distance > 0.0)) return found;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const Marker& marker = site.markers[i];
    if (!marker.grating) continue;
    const bool is_stated = marker.role == Role::kReference || marker.z_mm;
    const SizeDeviation a = deviation_of(i, marker, scene.markers[i], distance);
    const auto& u = calibration.prior.u_markers[i].value;
    const double allowed =
        is_stated ? kBeyond * std::hypot(u[MarkerShape::kScale], u[MarkerShape::kHeight] / distance) : kUnknownHeight;
    if (!(std::abs(a.larger) > allowed)) continue;
    const bool is_of_its_pitch =
        std::abs(scene.markers[i].value[MarkerShape::kScale]) <= kBeyond * u[MarkerShape::kScale];
    if (is_of_its_pitch && kBeyond * height_u_mm(site, calibration, calibration.prior, i) < std::abs(a.nearer_mm))
      continue;
    found.push_back(a);
  }
  return found;
}

double depth_u_mm(const SizeDeviation& deviation) { return std::abs(deviation.nearer_mm) / std::sqrt(2.0); }

std::vector<std::string> apparent_size_notes(const Site& site, const Calibration& calibration,
                                             std::span<const SizeDeviation> deviations) {
  std::vector<std::string> notes;
  const Scene& scene = calibration.bundle.scene;
  const bool knows = knows_focal_length(scene, scene.stated_covariance());
  for (const SizeDeviation& a : deviations)
    notes.push_back(apparent_size_note(site.markers[a.marker], a, mean_distance_mm(calibration), knows));
  return notes;
}

}  // namespace moiregauge::internal
