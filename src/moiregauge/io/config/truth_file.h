// SPDX-License-Identifier: Apache-2.0
// Writes the true values of a simulated recording to files (docs/cli/simulate.md).
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal {

// Returns a table frame,time_s,marker,dx_mm,dy_mm of the targets and of references that the scenario moves.
[[nodiscard]] std::string truth_csv(const simulator::Scenario& scenario);
// Returns [camera] with the keys of run.json, then [truth]: pivot, distance, and the camera's rotation and shift in the
// middle of every frame.
[[nodiscard]] std::string truth_camera_toml(const simulator::Scenario& scenario);

// Writes a text under a temporary name and renames it. Fails with the path and the reason.
[[nodiscard]] tl::expected<void, std::string> write_text(const std::string& path, const std::string& text);

}  // namespace moiregauge::internal
