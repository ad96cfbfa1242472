// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/packed_columns.h"

#include <algorithm>
#include <cmath>

#include <zlib.h>
#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

constexpr double kMaxQuanta = 2251799813685248.0;  // 2^51: differences stay exact in a browser's doubles

std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> packed(size);
  // Fails only if memory runs out, which the vector above would have reported.
  if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION) != Z_OK)
    size = 0;
  packed.resize(size);
  return packed;
}

}  // namespace

std::size_t PackedColumns::add(const std::vector<double>& values, double quantum) {
  std::int64_t last = 0;
  for (const double value : values) {
    const double quanta = std::round(value / quantum);
    if (!(std::abs(quanta) < kMaxQuanta)) {  // true for NaN as well
      bytes_.push_back(0);
      continue;
    }
    const auto now = static_cast<std::int64_t>(quanta);
    const std::int64_t step = now - last;
    last = now;
    std::uint64_t digits =
        (step < 0 ? 2 * static_cast<std::uint64_t>(-(step + 1)) + 1 : 2 * static_cast<std::uint64_t>(step)) + 1;
    for (; digits >= 128; digits >>= 7) bytes_.push_back(static_cast<std::uint8_t>(digits & 127U) | 128U);
    bytes_.push_back(static_cast<std::uint8_t>(digits));
  }
  columns_.push_back({quantum, values.size()});
  return columns_.size() - 1;
}

nlohmann::ordered_json PackedColumns::index() const {
  auto list = nlohmann::ordered_json::array();
  for (const Column& column : columns_) list.push_back({{"quantum", column.quantum}, {"count", column.count}});
  return list;
}

std::string PackedColumns::base64() const { return base64_of(deflated(bytes_)); }

std::string base64_of(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t there = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = static_cast<std::uint32_t>(bytes[i]) << 16U;
    if (there > 1) bits |= static_cast<std::uint32_t>(bytes[i + 1]) << 8U;
    if (there > 2) bits |= bytes[i + 2];
    for (std::size_t k = 0; k < 4; ++k) text += k <= there ? kLetters[bits >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

double decade_below(double value, double least) {
  if (!(value > least)) return least;
  return std::pow(10.0, std::floor(std::log10(value) + 1e-9));
}

}  // namespace moiregauge::internal
