// SPDX-License-Identifier: Apache-2.0
// Input: any text as a scenario of the simulator; a single line as a value of --set and as a length.
// Requires: each error is one line with a position; lengths are positive and finite.
#include "moiregauge/io/config/scenario_file.h"

#include "moiregauge/base/length_text.h"
#include "moiregauge/simulator/scenario/built_in.h"
#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  const std::string text = fuzz::text_of({data, size});
  if (text.find('\n') != text.npos) {
    if (const auto read = parse_scenario(text, "f"); !read) {
      for (const std::string& line : read.error()) fuzz::demand(line.starts_with("f:") && line.find('\n') == line.npos);
    }
    return 0;
  }
  auto scenario = simulator::built_in("small-1xyz");
  fuzz::demand(scenario.has_value());
  static_cast<void>(apply_setting(*scenario, text));
  if (const auto length = length_mm(text)) fuzz::demand(*length > 0.0 && *length < 1e300);
  return 0;
}
