// SPDX-License-Identifier: Apache-2.0
// Options of the results in a run directory, as arguments: `derive` and `compare` solve the run again with them.
#pragma once

#include "moiregauge/app/solve_run.h"
#include "moiregauge/io/run_dir/run_json_reader.h"

namespace moiregauge::internal {

// Returns the arguments, completed by those options of the results that differ from the run as measured. Arguments that
// are given stay. run.json does not contain files, so --site and --camera must be given.
[[nodiscard]] SolveArgs with_options_of_results(SolveArgs args, const ResultOptions& results,
                                                const StoredRun& measured);

}  // namespace moiregauge::internal
