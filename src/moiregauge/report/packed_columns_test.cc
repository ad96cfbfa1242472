// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/packed_columns.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6U | static_cast<unsigned>(letters.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count & 255U));
  }
  return bytes;
}

// Decodes by the description in the header only.
std::vector<double> first_column(const PackedColumns& packed, double quantum, std::size_t count) {
  const auto deflated = bytes_of_base64(packed.base64());
  std::vector<std::uint8_t> bytes(10 * count + 100);
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(bytes.data(), &size, deflated.data(), deflated.size()), Z_OK);
  std::vector<double> values;
  std::size_t at = 0;
  std::int64_t last = 0;
  while (values.size() < count) {
    std::uint64_t digits = 0;
    for (unsigned shift = 0;; shift += 7) {
      digits |= static_cast<std::uint64_t>(bytes[at] & 127U) << shift;
      if (bytes[at++] < 128) break;
    }
    if (digits == 0) {
      values.push_back(std::nan(""));
      continue;
    }
    --digits;
    last += digits % 2 != 0 ? -static_cast<std::int64_t>((digits + 1) / 2) : static_cast<std::int64_t>(digits / 2);
    values.push_back(static_cast<double>(last) * quantum);
  }
  EXPECT_EQ(at, size);
  return values;
}

TEST(PackedColumns, ValuesAreRestoredToHalfAQuantum) {
  const std::vector<double> values{0.0, 1.23456, -1.23456, 1e6, -1e6, 3e-6, -0.5e-5, 2.0};
  PackedColumns packed;
  packed.add(values, 1e-5);
  const auto back = first_column(packed, 1e-5, values.size());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(back[i], values[i], 0.5e-5 * (1.0 + 1e-6));
}

TEST(PackedColumns, AGapIsNeitherZeroNorItsNeighbour) {
  PackedColumns packed;
  packed.add({1.0, std::nan(""), std::nan(""), 1.5, std::numeric_limits<double>::infinity(), 1e300, 2.0}, 0.5);
  const auto back = first_column(packed, 0.5, 7);
  EXPECT_EQ(back[0], 1.0);
  EXPECT_TRUE(std::isnan(back[1]) && std::isnan(back[2]));
  EXPECT_EQ(back[3], 1.5);
  EXPECT_TRUE(std::isnan(back[4]) && std::isnan(back[5]));
  EXPECT_EQ(back[6], 2.0);
}

TEST(PackedColumns, TheIndexHoldsQuantumAndCount) {
  PackedColumns packed;
  EXPECT_EQ(packed.add({1.0, 2.0}, 0.1), 0U);
  EXPECT_EQ(packed.add({}, 0.2), 1U);
  EXPECT_EQ(packed.index().dump(), R"([{"quantum":0.1,"count":2},{"quantum":0.2,"count":0}])");
}

TEST(PackedColumns, Base64IsThatOfTheStandard) {  // RFC 4648, section 10
  const auto of = [](const std::string& text) { return base64_of({text.begin(), text.end()}); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(PackedColumns, AQuantumIsAPowerOfTen) {
  EXPECT_DOUBLE_EQ(decade_below(0.0034, 1e-7), 1e-3);
  EXPECT_DOUBLE_EQ(decade_below(0.001, 1e-7), 1e-3);
  EXPECT_DOUBLE_EQ(decade_below(1e-9, 1e-7), 1e-7);
  EXPECT_DOUBLE_EQ(decade_below(std::nan(""), 1e-5), 1e-5);
}

}  // namespace
}  // namespace moiregauge::internal
