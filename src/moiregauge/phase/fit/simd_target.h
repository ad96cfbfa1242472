// SPDX-License-Identifier: Apache-2.0
// Which instructions the hot loops use. The best of this machine unless told otherwise; all give the same bits.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace moiregauge::internal {

// What this program was built for and this machine has: "scalar", "ssse3", "sse4", "avx2", "avx3" (AVX-512), ...
[[nodiscard]] std::vector<std::string> simd_targets();

// For tests and benchmarks, before anything is measured. False when there is no such target here.
[[nodiscard]] bool use_simd_target(std::string_view name);

}  // namespace moiregauge::internal
