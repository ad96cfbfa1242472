// SPDX-License-Identifier: Apache-2.0
// The paper that a plan's markers need, and the command that makes the sheets.
#pragma once

#include <string>

#include "moiregauge/cli/plan/plan_args.h"

namespace moiregauge::internal::cli {

struct PaperNeed {
  std::string paper;         // smallest paper that holds every marker; empty: A0 does not
  std::size_t sheets = 0;    // number of pages of this paper
  std::size_t a4_parts = 0;  // pages if all is printed on A4, larger markers in parts; 0: impossible
};

[[nodiscard]] PaperNeed paper_need(const Site& site);

// Returns e.g. "moiregauge sheet --pitch 80mm --span 4800x2700mm --references 6 --targets 1 --paper A2".
[[nodiscard]] std::string sheet_command(const PlanOrder& order, const std::string& paper);

// Returns sentences for the plan: the pitch at this distance, and the paper with its command.
[[nodiscard]] std::string pitch_text(const PlanOrder& order);
[[nodiscard]] std::string paper_text(const PlanOrder& order);

}  // namespace moiregauge::internal::cli
