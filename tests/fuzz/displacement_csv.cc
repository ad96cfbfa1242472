// SPDX-License-Identifier: Apache-2.0
// Input: any bytes as the displacement.csv of an exported run.
// Requires: accepted tables can be exported in all formats.
#include <sstream>

#include "moiregauge/io/tables/table_csv.h"
#include "moiregauge/io/tables/uff58.h"
#include "tests/fuzz/input_file.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream file(moiregauge::internal::fuzz::text_of({data, size}));
  moiregauge::internal::RunTable table;
  if (!moiregauge::internal::parse_displacement_csv(file, table)) return 0;
  const auto part = moiregauge::internal::selected(table, {.markers = {}, .frames = {.seconds = moiregauge::internal::TimeRange{0.0, 2.0}}, .only_ok = true});
  if (!part) return 0;
  static_cast<void>(moiregauge::internal::long_csv(*part));
  static_cast<void>(moiregauge::internal::wide_csv(*part));
  static_cast<void>(moiregauge::internal::uff58(*part, moiregauge::internal::Gaps::kSplit));
  return 0;
}
