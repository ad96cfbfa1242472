// SPDX-License-Identifier: Apache-2.0
// Formats a plan as text and as JSON.
#pragma once

#include <string>

#include "moiregauge/cli/plan/plan_args.h"

namespace moiregauge::internal::cli {

[[nodiscard]] std::string plan_text(const PlanOrder& order);
[[nodiscard]] std::string plan_json(const PlanOrder& order);

}  // namespace moiregauge::internal::cli
