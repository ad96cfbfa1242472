// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/headers/stated_size.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

std::optional<std::uint64_t> stated(const std::string& bytes) {
  return stated_size(
      [&](std::uint64_t offset, std::span<std::uint8_t> out) {
        const std::size_t size = offset < bytes.size() ? std::min(out.size(), bytes.size() - offset) : 0;
        for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(bytes[offset + i]);
        return size;
      },
      bytes.size());
}

TEST(StatedSize, OnlyACompleteFileHasItsStatedSize) {
  const TestFolder folder;
  for (const char* name : {"a.mp4", "a.mov", "a.mkv", "a.avi", "a.ts"}) {
    const std::string make = fmt::format(
        "ffmpeg -nostdin -v error -y -f lavfi -i testsrc2=s=160x120:d=1 -pix_fmt yuv420p -c:v libx264 -movflags "
        "faststart {}",
        folder / name);
    ASSERT_EQ(std::system(make.c_str()), 0);
    const std::string whole = text_of(folder / name);
    EXPECT_EQ(stated(whole), whole.size()) << name;
    for (std::size_t size = whole.size() / 2; size < whole.size(); size += 997) {
      const auto cut = stated(whole.substr(0, size));
      const bool seen = cut && *cut > size;
      EXPECT_TRUE(seen || (name == std::string("a.ts") && size % 188 == 0)) << name << " cut to " << size;
    }
  }
}

TEST(StatedSize, OtherFilesStateNoSize) {
  using namespace std::string_literals;
  EXPECT_EQ(stated(""), std::nullopt);
  EXPECT_EQ(stated("a text of some length"), std::nullopt);
  EXPECT_EQ(stated("\0\0\0\x08"
                   "ftyp\0\0\0\0mdat"s),
            std::nullopt)
      << "a box to the end of the file";
  EXPECT_EQ(stated("\x1a\x45\xdf\xa3\x80\x18\x53\x80\x67\xff........"s), std::nullopt) << "a segment never closed";
  EXPECT_EQ(stated("RIFF\0\0\0\0AVI LIST"s), std::nullopt);
}

}  // namespace
}  // namespace moiregauge::internal
