// SPDX-License-Identifier: Apache-2.0
// Many numbers as a short text that a browser reads by itself.
//
// A column is whole numbers, value / quantum rounded. Each is written as its difference from the one before (the first
// from 0; after a gap from the last one there was): zigzag (0, -1, 1, -2, ... become 0, 1, 2, 3, ...), plus 1, as a
// base-128 varint, low digits first, the high bit set on all bytes but the last; a single 0 is a gap. All columns
// together, one after the other, deflated (zlib's format, which a browser calls "deflate"), in base64.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace moiregauge::internal {

class PackedColumns {
 public:
  // NaN is a gap. Returns the column's number, in order. A value beyond 2^51 quanta is a gap as well.
  std::size_t add(const std::vector<double>& values, double quantum);

  // [{"quantum": ..., "count": ...}, ...] in the order of add().
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

// 3 bytes in 4 letters (RFC 4648), filled up with '='.
[[nodiscard]] std::string base64_of(const std::vector<std::uint8_t>& bytes);

// The power of ten at or below `value`, at least `least`: a quantum of `value` that reads well.
[[nodiscard]] double decade_below(double value, double least);

}  // namespace moiregauge::internal
