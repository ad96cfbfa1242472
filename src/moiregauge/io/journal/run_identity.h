// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "moiregauge/io/journal/run_file.h"

namespace moiregauge::internal {

// May a run that was kept go on with this input and these options, and give what it would have given in one piece?
// Empty: yes. Else what differs, in words. How many threads, where the results go and what is printed never matters.
[[nodiscard]] std::optional<std::string> difference(const StoredRun& kept, const RunStart& start,
                                                    const MeasureOptions& options);

}  // namespace moiregauge::internal
