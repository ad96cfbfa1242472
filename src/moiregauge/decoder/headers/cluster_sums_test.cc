// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/cluster_sums.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

bool agree(const std::string& bytes) {
  ClusterSums sums([&](std::uint64_t offset, std::span<std::uint8_t> out) {
    const std::size_t size = offset < bytes.size() ? std::min(out.size(), bytes.size() - offset) : 0;
    for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(bytes[offset + i]);
    return size;
  });
  return sums.agree_up_to(bytes.size());
}

std::string bytes_of_video(const TestFolder& folder, const std::string& name) {
  const std::string make = fmt::format(
      "ffmpeg -nostdin -v error -y -f lavfi -i testsrc2=s=160x120:d=1 -c:v mjpeg -cluster_time_limit 300 {}",
      folder / name);
  EXPECT_EQ(std::system(make.c_str()), 0);
  return text_of(folder / name);
}

TEST(ClusterSums, ACompleteFileAgreesAndAFlippedBitDoesNot) {
  const TestFolder folder;
  const std::string whole = bytes_of_video(folder, "a.mkv");
  EXPECT_TRUE(agree(whole));
  for (std::size_t at = whole.size() / 5; at < whole.size() * 4 / 5; at += whole.size() / 7) {
    std::string hit = whole;
    hit[at] ^= 1;
    EXPECT_FALSE(agree(hit)) << at;
  }
}

TEST(ClusterSums, AFileWithoutCheckSumsAlwaysAgrees) {
  const TestFolder folder;
  std::string other = bytes_of_video(folder, "a.avi");
  EXPECT_TRUE(agree(other));
  other[other.size() / 2] ^= 1;
  EXPECT_TRUE(agree(other));
  EXPECT_TRUE(agree(""));
  EXPECT_TRUE(agree("\x1a\x45\xdf\xa3"));
}

}  // namespace
}  // namespace moiregauge::internal
