// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/displacement/precise/height_claim.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/calibration/model/chi2.h"
#include "moiregauge/displacement/precise/camera_claim.h"

namespace moiregauge::internal {
namespace {

constexpr double kMattersMost = 1.0;  // least change of a displacement that matters, in its u
// Factor on the chi-squared quantile, chosen. Template errors are the same in all frames and also lower chi2.
constexpr double kBeyondChance = 3.0;
constexpr double kFarOff = 5.0;  // least deviation of a height, in its u with the error of the edges; chosen

std::vector<std::size_t> targets_with_height(const Site& site) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < site.markers.size(); ++i) {
    const Marker& marker = site.markers[i];
    if (marker.role == Role::kTarget && marker.grating && marker.z_mm) out.push_back(i);
  }
  return out;
}

}  // namespace

ScenePrior with_unknown_heights(Site site, ScenePrior prior) {
  const auto targets = targets_with_height(site);
  for (const std::size_t i : targets) site.markers[i].z_mm.reset();
  const ScenePrior unstated = scene_prior(site, prior.camera.width, prior.camera.height, prior.camera);
  for (const std::size_t i : targets) {
    double& u = prior.u_markers[i].value[MarkerShape::kHeight];
    u = std::hypot(u, unstated.u_markers[i].value[MarkerShape::kHeight]);
  }
  return prior;
}

std::optional<HeightContradiction> height_contradiction(const Site& site, std::span<const BundleFrame> frames,
                                                        const ScenePrior& given, const Calibration& solved,
                                                        std::span<const double> u_size_mm) {
  const auto targets = targets_with_height(site);
  if (targets.empty()) return std::nullopt;
  const auto found = compare_priors(site, frames, given, with_unknown_heights(site, given), solved);
  if (!found) return std::nullopt;
  // A small model may be off by far more than the largest one, which knows its focal length poorly.
  const double error_u = std::max(found->error_u, found->solved_error_u);
  if (!(error_u > kMattersMost) ||
      !(found->fall > kBeyondChance * found->unit * chi2_upper_quantile(static_cast<double>(targets.size()))))
    return std::nullopt;
  const double distance_mm = found->open.frames.front().pose.shift[2];
  std::optional<HeightContradiction> worst;
  double most = kFarOff;
  for (const std::size_t i : targets) {
    const int row = shape_row(i, MarkerShape::kHeight);
    const double shown = found->open.scene.markers[i].value[MarkerShape::kHeight];
    const double said = given.markers[i].value[MarkerShape::kHeight], u_shown = std::sqrt(found->covariance(row, row));
    const double u_said = given.u_markers[i].value[MarkerShape::kHeight];
    const double off = std::abs(shown - said) / std::hypot(std::hypot(u_said, u_shown), u_size_mm[i]);
    if (!(off > most)) continue;
    most = off;
    const double scale = 1.0 + found->open.scene.markers[i].value[MarkerShape::kScale];
    const double pitch = site.markers[i].grating->pitch_mm * scale * (distance_mm - said) / (distance_mm - shown);
    worst = HeightContradiction{i, said, shown, u_shown, pitch, error_u};
  }
  return worst;
}

std::string height_contradiction_note(const Site& site, const HeightContradiction& found) {
  return fmt::format(
      "no row is trusted: with z_mm = {:.6g} of '{}', displacements would be wrong by up to {:.1f} u. The footage "
      "shows a height of {:.4g} mm (u {:.2g} mm), or a pitch of {:.4g} mm",
      found.stated_mm, site.markers[found.marker].name, found.error_u, found.shown_mm, found.u_shown_mm,
      found.pitch_mm);
}

}  // namespace moiregauge::internal
