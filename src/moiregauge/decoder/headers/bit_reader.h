// SPDX-License-Identifier: Apache-2.0
// Reads bits of a NAL unit, most significant first (ITU-T H.265, 7.2 and 9.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace moiregauge::internal {

// After the end it returns zeros, and good() is false from then on.
class BitReader {
 public:
  // Copies at most `max_bytes` of the unit, without its emulation prevention bytes (7.4.2: 00 00 03).
  BitReader(std::span<const std::uint8_t> unit, std::size_t max_bytes) {
    int zeros = 0;
    for (std::size_t k = 0; k < unit.size() && bytes_.size() < max_bytes; ++k) {
      if (zeros >= 2 && unit[k] == 3) {
        zeros = 0;
        continue;
      }
      zeros = unit[k] == 0 ? zeros + 1 : 0;
      bytes_.push_back(unit[k]);
    }
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool flag() { return bits(1) != 0; }
  // Reads u(n), n up to 32.
  [[nodiscard]] std::uint32_t bits(int count) {
    std::uint64_t value = 0;
    for (int k = 0; k < count; ++k) value = value << 1 | next();
    return static_cast<std::uint32_t>(value);
  }
  // Reads ue(v). A value above `max` is an error and returns 0.
  [[nodiscard]] int number(int max) {
    int zeros = 0;
    while (zeros < 32 && good_ && next() == 0) ++zeros;
    if (zeros >= 32) return fail();
    const std::uint64_t value = (std::uint64_t{1} << zeros) - 1 + bits(zeros);
    return value > static_cast<std::uint64_t>(max) ? fail() : static_cast<int>(value);
  }
  // Reads se(v). A magnitude above `max` is an error and returns 0.
  [[nodiscard]] int signed_number(int max) {
    const int value = number(2 * max);
    return value % 2 == 0 ? -value / 2 : (value + 1) / 2;
  }
  void skip(int count) {
    for (int k = 0; k < count && good_; ++k) (void)next();
  }
  int fail() {
    good_ = false;
    return 0;
  }

 private:
  [[nodiscard]] std::uint32_t next() {
    if (at_ >= 8 * bytes_.size()) {
      good_ = false;
      return 0;
    }
    const std::uint32_t bit = bytes_[at_ / 8] >> (7 - at_ % 8) & 1U;
    ++at_;
    return bit;
  }
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace moiregauge::internal
