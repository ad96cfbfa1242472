// SPDX-License-Identifier: Apache-2.0
// Input: any bytes as the run.json of a run that is to be replaced.
// Requires: the reader ends without a fault.
#include <sstream>

#include "moiregauge/io/run_dir/run_json_reader.h"
#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream file(moiregauge::internal::fuzz::text_of({data, size}));
  static_cast<void>(moiregauge::internal::input_sha256_of_run(file));
  return 0;
}
