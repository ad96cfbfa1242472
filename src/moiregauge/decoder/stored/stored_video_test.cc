// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/stored/stored_video.h"

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/decoder/stored/stored_source.h"
#include "moiregauge/decoder/video_source.h"
#include "moiregauge/decoder/videos_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::ffmpeg;

// Writes 12 different images at 25 frames/s.
std::string video(const TestFolder& folder, const std::string& name, const std::string& pixels,
                  const std::string& size = "48x32", const std::string& more = "") {
  ffmpeg(fmt::format("-f lavfi -i testsrc2=s={}:r=25:d=0.48 -c:v rawvideo -pix_fmt {} {} {}", size, pixels, more,
                     folder / name));
  return folder / name;
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::unique_ptr<FrameSource> opened_mapped(const std::string& path, bool in_place) {
  DecoderOptions decoder;
  decoder.in_place = in_place;
  return test::opened(path, decoder);
}

void expect_same_grey(const LumaView& a, const LumaView& b, const std::string& where) {
  ASSERT_EQ(a.index(), b.index()) << where;
  ASSERT_EQ(width_of(a), width_of(b)) << where;
  ASSERT_EQ(height_of(a), height_of(b)) << where;
  std::visit(
      [&](const auto& left) {
        const auto& right = std::get<std::decay_t<decltype(left)>>(b);
        for (int y = 0; y < left.height; ++y) {
          for (int x = 0; x < left.width; ++x) ASSERT_EQ(left.at(x, y), right.at(x, y)) << where;
        }
      },
      a);
}

// Checks number, time and every grey level against the decoder.
void expect_same_frames(const std::string& path) {
  const auto mapped = opened_mapped(path, true), decoded = opened_mapped(path, false);
  ASSERT_TRUE(mapped && decoded);
  EXPECT_EQ(mapped->info().bits, decoded->info().bits);
  EXPECT_EQ(mapped->info().codec, decoded->info().codec);
  EXPECT_EQ(mapped->info().fps, decoded->info().fps);
  EXPECT_EQ(mapped->info().time_source, decoded->info().time_source);
  while (true) {
    const auto a = mapped->next(), b = decoded->next();
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) {
      EXPECT_EQ(a.error().message, b.error().message);
      return;
    }
    ASSERT_EQ(a->has_value(), b->has_value());
    if (!*a) return;
    EXPECT_EQ((*a)->number, (*b)->number);
    EXPECT_EQ((*a)->time_s, (*b)->time_s);
    EXPECT_EQ((*a)->damaged, (*b)->damaged);
    expect_same_grey((*a)->luma, (*b)->luma, fmt::format("{} frame {}", path, (*a)->number));
  }
}

void put_u32(std::string& bytes, std::size_t at, std::size_t value) {
  for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(static_cast<std::uint8_t>(value >> (8 * k)));
}

TEST(StoredVideo, FramesInPlaceEqualDecodedFrames) {
  const TestFolder folder;
  for (const char* name : {"a.avi", "a.mkv"}) {
    for (const char* pixels : {"gray", "yuv420p", "nv12"}) {
      const std::string path = video(folder, name, pixels);
      const auto mapped = map_video(path);
      ASSERT_TRUE(mapped) << name << " " << pixels;
      EXPECT_EQ(mapped->video.frames.size(), 12U);
      expect_same_frames(path);
    }
  }
}

std::string big_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int k = bytes; k-- > 0;) text += static_cast<char>(static_cast<std::uint8_t>(value >> (8 * k)));
  return text;
}
std::string element(std::uint64_t id, int id_bytes, const std::string& body) {
  return big_endian(id, id_bytes) + '\x01' + big_endian(body.size(), 7) + body;
}

// Three grey images of 48 x 32 words, each at an even or odd file offset.
std::string matroska_of_words(unsigned bits, bool even) {
  const std::string picture = element(0xB0, 1, big_endian(48, 1)) + element(0xBA, 1, big_endian(32, 1)) +
                              element(0x2EB524, 3, big_endian(0x59310000U | bits, 4));
  const std::string track = element(0xD7, 1, big_endian(1, 1)) + element(0x73C5, 2, big_endian(1, 1)) +
                            element(0x83, 1, big_endian(1, 1)) + element(0x86, 1, "V_UNCOMPRESSED") +
                            element(0xE0, 1, picture);
  const std::string head = element(0x1A45DFA3, 4, element(0x4282, 2, "matroska"));
  const std::string about = element(0x1549A966, 4, element(0x2AD7B1, 3, big_endian(1'000'000, 3))) +
                            element(0x1654AE6B, 4, element(0xAE, 1, track));
  std::string cluster = element(0xE7, 1, big_endian(0, 1));
  for (unsigned n = 0; n < 3; ++n) {
    const std::size_t at = head.size() + 12 + about.size() + 12 + cluster.size() + 13;
    if ((at % 2 == 0) != even) cluster += element(0xEC, 1, "");  // nine bytes of padding
    std::string words;
    for (unsigned k = 0; k < 48 * 32; ++k) {
      const unsigned grey = (k * 7 + n * 13) % (1U << bits);
      words += {static_cast<char>(grey & 0xffU), static_cast<char>(grey >> 8U)};
    }
    cluster += element(0xA3, 1, '\x81' + big_endian(40 * n, 2) + '\x80' + words);
  }
  return head + element(0x18538067, 4, about + element(0x1F43B675, 4, cluster));
}

TEST(StoredVideo, ImagesAboveEightBitsMustStartAtEvenOffsets) {
  const TestFolder folder;
  for (const unsigned bits : {10U, 12U, 16U}) {
    put_text(folder / "a.mkv", matroska_of_words(bits, true));
    const auto mapped = map_video(folder / "a.mkv");
    ASSERT_TRUE(mapped) << bits;
    EXPECT_EQ(mapped->video.bits, static_cast<int>(bits));
    expect_same_frames(folder / "a.mkv");
    put_text(folder / "odd.mkv", matroska_of_words(bits, false));
    EXPECT_FALSE(map_video(folder / "odd.mkv"));
    expect_same_frames(folder / "odd.mkv");
  }
}

TEST(StoredVideo, FramesAreReadInPlaceWithoutADecoder) {
  const TestFolder folder;
  const std::string path = video(folder, "a.avi", "gray");
  const auto source = opened_mapped(path, true);
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child";
  const auto first = std::get<0>(source->next().value()->luma).data;
  const auto second = std::get<0>(source->next().value()->luma).data;
  EXPECT_EQ(second - first, 48 * 32 + 8) << "one picture and the head of the next chunk";
}

TEST(StoredVideo, OddSizesAndTimesEqualTheDecoders) {
  const TestFolder folder;
  for (const char* size : {"46x31", "47x33", "45x32"}) {
    for (const char* name : {"a.avi", "a.mkv"}) {
      for (const char* pixels : {"gray", "yuv420p"}) expect_same_frames(video(folder, name, pixels, size));
    }
  }
  expect_same_frames(video(folder, "slow.avi", "gray", "48x32", "-vf setpts=N*3.7/TB/25 -r 30000/1001"));
  expect_same_frames(video(folder, "gaps.mkv", "gray", "48x32", "-vf select='not(between(n\\,3\\,6))' -vsync vfr"));
}

TEST(StoredVideo, FramesOfAllRiffsAreFound) {
  const TestFolder folder;
  std::string bytes = text_of(video(folder, "a.avi", "gray"));
  const std::size_t whole = bytes.size();
  const std::size_t movie = bytes.find("LIST", bytes.find("strf")), first = bytes.find("00dc", movie);
  std::string more = "RIFF....AVIXLIST....movi" + bytes.substr(first, 3 * (48 * 32 + 8));  // continuation as in OpenDML
  put_u32(more, 4, more.size() - 8);
  put_u32(more, 16, more.size() - 20);
  bytes += more;
  EXPECT_FALSE(stored_video(bytes_of(bytes))) << "three frames more than the head has counted";
  put_u32(bytes, bytes.find("strh") + 8 + 32, 15);
  const auto found = stored_video(bytes_of(bytes));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->frames.size(), 15U);
  EXPECT_EQ(found->frames[12], whole + 24 + 8);
  EXPECT_EQ(found->ticks[14], 14);
}

TEST(StoredVideo, OtherLayoutsAreDecoded) {
  const TestFolder folder;
  for (const char* pixels : {"yuyv422", "bgr24", "yuv422p"}) {
    const std::string path = video(folder, "a.avi", pixels);
    EXPECT_FALSE(map_video(path)) << pixels;
    expect_same_frames(path);
  }
  ffmpeg(fmt::format("-f lavfi -i testsrc2=s=48x32:r=25:d=0.48 -f lavfi -i sine=d=0.48 -c:v rawvideo -pix_fmt gray {}",
                     folder / "sound.avi"));
  EXPECT_FALSE(map_video(folder / "sound.avi"));
  ffmpeg(fmt::format("-f lavfi -i testsrc2=s=48x32:d=1 -c:v ffv1 -pix_fmt gray {}", folder / "packed.mkv"));
  EXPECT_FALSE(map_video(folder / "packed.mkv"));
}

TEST(StoredVideo, ATruncatedFileKeepsEarlierFrames) {
  const TestFolder folder;
  for (const char* name : {"a.avi", "a.mkv"}) {
    const std::string whole = text_of(video(folder, name, "gray"));
    for (const std::size_t part : {3U, 5U, 8U, 9U}) {
      put_text(folder / name, whole.substr(0, whole.size() * part / 10));
      EXPECT_FALSE(map_video(folder / name));
      expect_same_frames(folder / name);
    }
  }
}

TEST(StoredVideo, AFileTruncatedWhileReadEndsTheInput) {
  const TestFolder folder;
  const std::string path = video(folder, "a.avi", "gray", "256x256");
  const auto source = opened_mapped(path, true);
  ASSERT_NE(source, nullptr);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(source->next().value());
  const LumaView last = source->next().value()->luma;
  std::filesystem::resize_file(path, 100'000);
  EXPECT_EQ(std::get<0>(last).at(200, 200), 0) << "zeros, not a signal";
  const auto cut = source->next();
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().kind, InputErrorKind::kDamaged);
  EXPECT_EQ(cut.error().message,
            "the file became shorter during the measurement: " + path + " at frame 4: measure it when it is complete");
  EXPECT_FALSE(source->next()) << "an error stays";
}

// Checks that no offset is outside the file, whatever its bytes are.
void expect_inside(const std::string& bytes) {
  const auto found = stored_video(bytes_of(bytes));
  if (!found) return;
  ASSERT_GT(found->width, 0);
  ASSERT_GT(found->height, 0);
  const std::size_t picture = found->row_bytes * static_cast<std::size_t>(found->height);
  ASSERT_GE(found->row_bytes, static_cast<std::size_t>(found->width) * (found->bits > 8 ? 2 : 1));
  for (const std::size_t at : found->frames) ASSERT_LE(at + picture, bytes.size());
}

TEST(StoredVideo, TruncatedAndCorruptFilesGiveNoOffsetOutside) {
  const TestFolder folder;
  for (const char* name : {"a.avi", "a.mkv"}) {
    const std::string whole = text_of(video(folder, name, "gray", "16x4"));
    for (std::size_t size = 0; size < whole.size(); ++size) expect_inside(whole.substr(0, size));
    for (std::size_t at = 0; at < whole.size(); ++at) {
      for (const char value : {'\x00', '\x01', '\x7f', '\x80', '\xff'}) {
        std::string wrong = whole;
        wrong[at] = value;
        expect_inside(wrong);
      }
    }
  }
}

TEST(StoredPixels, ASizeThatNoImageOfTheFormatHasIsRefused) {
  constexpr std::uint32_t kY800 = 0x30303859, kI420 = 0x30323449;
  EXPECT_EQ(stored_pixels(kY800, 6, 2, 12, RowGroups::kPacked)->row_bytes, 6U);
  EXPECT_EQ(stored_pixels(kY800, 6, 2, 16, RowGroups::kFourBytes)->row_bytes, 8U);
  EXPECT_FALSE(stored_pixels(kY800, 6, 2, 16, RowGroups::kPacked));
  EXPECT_EQ(stored_pixels(kI420, 5, 3, 15 + 2 * 3 * 2, RowGroups::kPacked)->row_bytes, 5U);
  EXPECT_FALSE(stored_pixels(kI420, 5, 3, 15, RowGroups::kPacked));
  EXPECT_FALSE(stored_pixels(kY800, 0, 2, 0, RowGroups::kPacked));
  EXPECT_FALSE(stored_pixels(kY800, 1 << 20, 1 << 20, 0, RowGroups::kPacked));
  EXPECT_FALSE(stored_pixels(0, 6, 2, 12, RowGroups::kPacked));
}

}  // namespace
}  // namespace moiregauge::internal
