// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/frame_store.h"

#include <cstdlib>
#include <map>
#include <variant>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/app/open_input.h"
#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

using Pixels = std::vector<std::uint8_t>;

Pixels pixels_of(const LumaView& luma) {
  const auto& view = std::get<ImageView<std::uint8_t>>(luma);
  Pixels pixels;
  for (int y = 0; y < view.height; ++y) pixels.insert(pixels.end(), view.row(y).begin(), view.row(y).end());
  return pixels;
}

// A clip of 400 frames with reordered frames and open groups of 12.
std::string make_clip(const TestFolder& folder) {
  const std::string path = folder / "clip.mp4";
  const std::string words = fmt::format(
      "ffmpeg -nostdin -v error -y -f lavfi -i testsrc2=size=96x64:rate=25 -frames:v 400 -pix_fmt yuv420p -g 12 -c:v "
      "libx264 "
      "-x264-params open-gop=1:bframes=3:min-keyint=12 {}",
      path);
  EXPECT_EQ(std::system(words.c_str()), 0);
  return path;
}

TEST(FrameStore, AnyOrderOfFramesGivesThePixelsOfTheOrderOfTheClip) {
  const TestFolder folder;
  const std::string clip = make_clip(folder);
  std::map<long, Pixels> whole;
  std::map<long, double> times;
  const auto source = open_input(clip, {});
  ASSERT_TRUE(source);
  while (true) {
    const auto frame = (*source)->next();
    ASSERT_TRUE(frame);
    if (!*frame) break;
    whole[(*frame)->number] = pixels_of((*frame)->luma);
    times[(*frame)->number] = (*frame)->time_s;
  }
  ASSERT_EQ(whole.size(), 400U);
  FrameStore store(FrameLimits{.max_bytes = 1});  // keeps one frame, so each jump decodes
  for (const long number : {0L, 399L, 398L, 1L, 250L, 251L, 240L, 12L, 372L, 370L, 0L, 130L}) {
    const auto frame = store.frame(clip, number);
    ASSERT_TRUE(frame) << frame.error();
    EXPECT_EQ((*frame)->number, number);
    EXPECT_EQ((*frame)->time_s, times[number]);
    EXPECT_TRUE(pixels_of((*frame)->frame().luma) == whole[number]) << "frame " << number;
    EXPECT_EQ((*frame)->next_quantiser().has_value(), number != 399);
  }
  EXPECT_FALSE(store.frame(clip, 400));
}

}  // namespace
}  // namespace moiregauge::internal
