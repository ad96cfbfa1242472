// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/fit/simd_target.h"

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "moiregauge/image/simd_options.h"

#include <hwy/targets.h>

namespace moiregauge::internal {
namespace {

std::string name_of(std::int64_t target) {
  if (target == HWY_EMU128) return "scalar";
  std::string name = hwy::TargetName(target);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

// Returns all targets, whatever use_simd_target selected before.
std::vector<std::int64_t> targets_here() {
  hwy::SetSupportedTargetsForTest(0);
  return hwy::SupportedAndGeneratedTargets();
}

}  // namespace

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const std::int64_t target : targets_here()) names.push_back(name_of(target));
  return names;
}

bool use_simd_target(std::string_view name) {
  for (const std::int64_t target : targets_here()) {
    if (name_of(target) != name) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return true;
  }
  return false;
}

}  // namespace moiregauge::internal
