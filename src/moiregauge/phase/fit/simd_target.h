// SPDX-License-Identifier: Apache-2.0
// SIMD instructions of the hot loops. The default is the best target of this machine. All targets give the same bits.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal {

// Returns the targets that this program contains and this machine supports: "scalar", "sse4", "avx2", "avx3"
// (AVX-512), ...
[[nodiscard]] std::vector<std::string> simd_targets();

// Selects the target, for tests and benchmarks. Call it before any measurement. Fails (false): this machine has no such
// target.
[[nodiscard]] bool use_simd_target(std::string_view name);

}  // namespace moiregauge::internal
