// SPDX-License-Identifier: Apache-2.0
// Packs many numbers into a short text that a browser can unpack without a library.
//
// A column holds integers, round(value / quantum). Each one is coded as its difference from the previous value of the
// column. The first difference is from 0, and gaps are skipped.
// Coding: zigzag (0, -1, 1, -2, ... become 0, 1, 2, 3, ...), plus 1, as a base-128 varint. Low digits come first, and
// the high bit is set on all bytes except the last. A single 0 is a gap.
// All columns in order are deflated together (zlib format, "deflate" in browsers) and coded in base64.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace moiregauge::internal {

class PackedColumns {
 public:
  // Adds a column and returns its number, counted from 0. NaN and values beyond 2^51 quanta are gaps.
  std::size_t add(const std::vector<double>& values, double quantum);

  // Returns [{"quantum": ..., "count": ...}, ...] in the order of add().
  [[nodiscard]] nlohmann::ordered_json index() const;
  [[nodiscard]] std::string base64() const;

 private:
  struct Column {
    double quantum;
    std::size_t count;
  };
  std::vector<Column> columns_;
  std::vector<std::uint8_t> bytes_;
};

// Returns the bytes in base64 with padding (RFC 4648).
[[nodiscard]] std::string base64_of(const std::vector<std::uint8_t>& bytes);

// Returns the largest power of ten that is at most `value`, but at least `least`.
[[nodiscard]] double decade_below(double value, double least);

}  // namespace moiregauge::internal
