// SPDX-License-Identifier: Apache-2.0
// Input: one byte that chooses the columns, then any bytes as the record of another sensor.
// Requires: accepted times are finite and increase. A mistake is one line of three parts.
#include "moiregauge/io/tables/reference_csv.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moiregauge::internal;
  if (size == 0) return 0;
  const ReferenceColumns choices[] = {{}, {"t", "mm", {}, "ms"}, {"", "mm", 100.0, ""}};
  std::istringstream csv(fuzz::text_of({data + 1, size - 1}));
  const auto record = parse_reference_csv(csv, "lvdt.csv", choices[data[0] % 3]);
  if (!record) {
    const std::string& message = record.error().message;
    fuzz::demand(message.find('\n') == std::string::npos && std::count(message.begin(), message.end(), ':') >= 2);
    return 0;
  }
  fuzz::demand(!record->series.value.empty() && record->series.time_s.size() == record->series.value.size());
  for (std::size_t i = 0; i < record->series.value.size(); ++i) {
    fuzz::demand(std::isfinite(record->series.time_s[i]) && !std::isinf(record->series.value[i]));
    fuzz::demand(i == 0 || record->series.time_s[i] > record->series.time_s[i - 1]);
  }
  return 0;
}
