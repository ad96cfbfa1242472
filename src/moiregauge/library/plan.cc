// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/plan.h"

#include <algorithm>
#include <utility>

#include "moiregauge/library/convert.h"
#include "moiregauge/planning/recording_plan.h"

namespace moiregauge {
namespace {

// A typical step of a phone or drone.
constexpr internal::Quantiser kTypicalCodec{internal::kUsualStep, true};

std::size_t count(const internal::Site& site, internal::Role role) {
  return static_cast<std::size_t>(std::count_if(site.markers.begin(), site.markers.end(), [role](const auto& marker) {
    return marker.role == role && marker.grating.has_value();
  }));
}

}  // namespace

Expected<std::vector<PlannedTarget>> plan(const PlanOptions& options) {
  const auto refuse = [](const char* message) { return internal::public_error(internal::Exit::kUsage, message); };
  if (options.camera.width <= 0 || options.camera.height <= 0 || !(options.camera.fx > 0.0))
    return refuse("the camera is incomplete: PlanOptions: set width, height and fx in px");
  if (!(options.distance.value() > 0.0)) return refuse("the distance is missing: PlanOptions: set distance, e.g. 5_m");
  auto site = internal::to_internal(options.site);
  if (!site) return tl::unexpected(site.error());
  if (count(*site, internal::Role::kReference) < 4 || count(*site, internal::Role::kTarget) < 1)
    return refuse("the site has too few gratings: PlanOptions: state four references and one target at least");
  internal::RecordingSetup setup;
  setup.site = *std::move(site);
  setup.camera = internal::to_internal(options.camera);
  if (!(setup.camera.fy > 0.0)) setup.camera.fy = setup.camera.fx;
  setup.distance_mm = options.distance.value();
  setup.noise_sigma = options.noise_grey;
  setup.optics.contrast = options.contrast_grey;
  setup.optics.psf_sigma_px = options.blur_px;
  if (options.is_compressed) setup.codec = kTypicalCodec;
  std::vector<PlannedTarget> targets;
  for (const internal::PlannedTarget& planned : internal::planned_targets(setup))
    targets.push_back({setup.site.markers[planned.marker].name, planned.u.x, planned.u.y, planned.phase_bound.x,
                       planned.phase_bound.y});
  return targets;
}

}  // namespace moiregauge
