// SPDX-License-Identifier: Apache-2.0
// What a simulated recording truly shows, as files (docs/cli/simulate.md).
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/simulator/scenario/scenario.h"

namespace moiregauge::internal {

// frame,time_s,marker,dx_mm,dy_mm: targets, and references that were made to move.
[[nodiscard]] std::string truth_csv(const simulator::Scenario& scenario);
// [camera] with run.json's keys, then [truth]: pivot, distance, the camera's turn and shift in the middle of every
// frame.
[[nodiscard]] std::string truth_camera_toml(const simulator::Scenario& scenario);

// Writes a text under a temporary name and renames it. An error reads "path: why".
[[nodiscard]] tl::expected<void, std::string> write_text(const std::string& path, const std::string& text);

}  // namespace moiregauge::internal
