// SPDX-License-Identifier: Apache-2.0
// Proves an installation: a short simulated video is encoded, decoded, measured and compared with its truth.
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace moiregauge::internal {

struct SelfTestFigures {
  long frames = 0;
  long samples = 0;               // compared with the truth
  double largest_error_mm = 0.0;  // along x or y
  double largest_ratio = 0.0;     // error / u
};

// Runs the whole chain in a new folder for temporary files, and removes it.
// Fails: "what happened: where: what to do", for the first step that failed or a sample that is wrong by more than 5 u.
[[nodiscard]] tl::expected<SelfTestFigures, std::string> run_self_test();

}  // namespace moiregauge::internal
