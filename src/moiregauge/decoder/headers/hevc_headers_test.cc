// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/hevc_headers.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/decoder/headers/bit_reader.h"

namespace moiregauge::internal {
namespace {

std::vector<std::uint8_t> stream(const TestFolder& folder) {
  const std::string words =
      "ffmpeg -nostdin -v error -y -f lavfi -i testsrc2=size=96x64:rate=25 -frames:v 4 -c:v libx265 -pix_fmt yuv420p "
      "-x265-params log-level=none:qp=27:ipratio=1:pbratio=1:aq-mode=0:slices=2 -f hevc " +
      (folder / "a");
  EXPECT_EQ(std::system(words.c_str()), 0) << words;
  std::ifstream file(folder / "a", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(BitReader, ReadsExpGolombNumbersAndSkipsEmulationPrevention) {
  // 1 | 010 | 011 | 00100 | 00101 -> 0 1 2 3 4; then 00 00 (03) 01
  const std::uint8_t bytes[] = {0b10100110, 0b01000010, 0b10000000, 0x00, 0x00, 0x03, 0x01};
  BitReader bits(bytes, 100);
  for (int value = 0; value < 5; ++value) EXPECT_EQ(bits.number(100), value);
  bits.skip(7);
  EXPECT_EQ(bits.bits(24), 1u);
  EXPECT_TRUE(bits.good());
  EXPECT_EQ(bits.bits(1), 0u);
  EXPECT_FALSE(bits.good());
}

TEST(BitReader, ANumberBeyondItsBoundIsAnError) {
  const std::uint8_t bytes[] = {0b00100000};  // 3
  BitReader bits(bytes, 1);
  EXPECT_EQ(bits.number(2), 0);
  EXPECT_FALSE(bits.good());
}

TEST(HevcHeaders, ATruncatedStreamGivesTheSameQuantiserOrNone) {
  const TestFolder folder;
  const auto whole = stream(folder);
  ASSERT_GT(whole.size(), 100u);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    HevcHeaders headers;
    const auto found = headers.read_packet(std::span(whole).first(size));
    if (found) {
      EXPECT_EQ(found->parameter, 27) << size;
    }
  }
  HevcHeaders headers;
  EXPECT_TRUE(headers.read_packet(whole).has_value());
}

TEST(HevcHeaders, WithoutParameterSetsThereIsNoQuantiser) {
  const TestFolder folder;
  auto bytes = stream(folder);
  for (std::size_t k = 0; k + 4 < bytes.size(); ++k) {  // turns every picture parameter set into an unknown unit
    if (bytes[k] == 0 && bytes[k + 1] == 0 && bytes[k + 2] == 1 && (bytes[k + 3] >> 1 & 63) == 34)
      bytes[k + 3] = 63 << 1;
  }
  EXPECT_FALSE(HevcHeaders().read_packet(bytes).has_value());
}

}  // namespace
}  // namespace moiregauge::internal
