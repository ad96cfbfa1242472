// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "moiregauge/displacement/sample.h"

namespace moiregauge::internal::cli {

// Returns a text as a JSON string. Bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text_of(const std::string& text);

// Provisional samples as JSON lines for other programs (docs/cli/measure.md).
class SampleLines {
 public:
  void keep(const std::string& marker, const Sample& sample);
  // Returns lines with the samples since the last call, each below 4096 bytes. If there are very
  // many, it returns evenly spaced ones.
  [[nodiscard]] std::string take();

 private:
  struct Row {
    std::string marker;  // as a JSON string
    std::string values;  // as a JSON array
  };
  std::vector<Row> rows_;
};

}  // namespace moiregauge::internal::cli
