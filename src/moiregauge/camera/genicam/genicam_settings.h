// SPDX-License-Identifier: Apache-2.0
// Sets up a GenICam camera and reads its settings back.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/camera/genicam/genicam_source.h"
#include "moiregauge/camera/genicam/glib_objects.h"

namespace moiregauge::internal {

// Applies the settings in the order that cameras require: region and format before the rate, the rate before the
// exposure. Values outside the camera's range are refused, because a clamped exposure would surprise.
// Fails with "what happened: where: what to do".
[[nodiscard]] tl::expected<void, std::string> apply_settings(ArvCamera& camera, const GenicamSettings& settings,
                                                             const std::string& name);

// Returns the settings in force, e.g. {"exposure_us", "500"}. Those that a camera does not have are absent.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> settings_of(ArvCamera& camera);

}  // namespace moiregauge::internal
