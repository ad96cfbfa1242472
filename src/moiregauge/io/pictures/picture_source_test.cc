// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/picture_source.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_numbers.h"
#include "moiregauge/io/pictures/pictures_for_tests.h"
#include "moiregauge/io/pictures/png_reader.h"

namespace moiregauge::internal {
namespace {

using std::string_literals::operator""s;

void write_grey(const std::string& path, std::uint16_t grey, TestPng shape = {}) {
  const auto pixels = static_cast<std::size_t>(shape.width * shape.height * (shape.colour ? 3 : 1));
  write_test_png(path, shape, std::vector<std::uint16_t>(pixels, grey));
}

int first_grey(const LumaView& luma) {
  return std::visit([](const auto& view) { return static_cast<int>(view.at(0, 0)); }, luma);
}

TEST(PictureSource, ImagesComeInNaturalOrder) {
  const TestFolder folder;
  for (const int i : {10, 9, 11, 8})
    write_grey(folder / ("frame" + std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  put_text(folder / "notes.txt", "no picture");
  put_text(folder / ".hidden.png", "no picture");
  auto source = open_pictures(folder.path(), {}).value();
  EXPECT_EQ(source->info().frames, 4);
  EXPECT_EQ(source->info().time_source, "none");
  for (const int expected : {8, 9, 10, 11}) {
    const auto frame = source->next().value();
    EXPECT_EQ(first_grey(frame->luma), expected);
    EXPECT_TRUE(std::isnan(frame->time_s)) << "pictures have no time without --fps";
  }
  EXPECT_FALSE(source->next().value().has_value());
}

TEST(PictureSource, AFolderWithoutImagesGivesThoseOfItsFramesFolder) {
  const TestFolder folder;
  std::filesystem::create_directory(folder / "frames");
  write_grey(folder / "frames/000000.png", 7);
  put_text(folder / "truth.csv", "frame\n");
  EXPECT_EQ(open_pictures(folder.path(), {}).value()->info().frames, 1);
}

TEST(PictureSource, TheFpsOptionGivesTheImagesTimes) {
  const TestFolder folder;
  write_grey(folder / "a1.png", 1);
  write_grey(folder / "a2.png", 2);
  auto source = open_pictures(folder.path(), {.fps = 4.0}).value();
  EXPECT_EQ(source->next().value()->time_s, 0.0);
  EXPECT_EQ(source->next().value()->time_s, 0.25);
  EXPECT_EQ(source->info().time_source, "fps-option");
}

TEST(PictureSource, AnUnreadableImageLosesOnlyItsFrame) {
  const TestFolder folder;
  for (const int i : {1, 2, 3}) write_grey(folder / (std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  put_text(folder / "2.png", text_of(folder / "2.png").substr(0, 45));
  auto source = open_pictures(folder.path(), {}).value();
  EXPECT_FALSE(source->next().value()->damaged);
  const auto lost = source->next().value();
  EXPECT_TRUE(lost->damaged);
  EXPECT_EQ(first_grey(lost->luma), 128) << "nothing of the frame before shines through";
  EXPECT_EQ(first_grey(source->next().value()->luma), 3);
  EXPECT_EQ(source->info().warnings.size(), 1U);
}

TEST(PictureSource, AnImageOfAnotherSizeEndsTheInput) {
  const TestFolder folder;
  write_grey(folder / "1.png", 1);
  write_grey(folder / "2.png", 1, {.width = 5, .height = 2});
  auto source = open_pictures(folder.path(), {}).value();
  EXPECT_TRUE(source->next());
  for (int again = 0; again < 2; ++again) {
    const auto frame = source->next();
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().kind, InputErrorKind::kDamaged);
    EXPECT_NE(frame.error().message.find("the image size changes from 4x2 of 8 bits to 5x2 of 8 bits at frame "),
              std::string::npos);
  }
}

TEST(PictureSource, AMissingNumberLeavesTheTimesOfOthersUnchanged) {
  const TestFolder folder;
  for (const int i : {8, 10, 11})
    write_grey(folder / ("img_" + std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  write_grey(folder / "img_007.png", 99);
  auto source = open_pictures(folder / "img_%d.png", {.fps = 1.0, .sequence = true}).value();
  ASSERT_EQ(source->info().frames, 4);
  EXPECT_EQ(first_grey(source->next().value()->luma), 8);
  EXPECT_TRUE(source->next().value()->damaged);
  const auto third = source->next().value();
  EXPECT_EQ(first_grey(third->luma), 10);
  EXPECT_EQ(third->time_s, 2.0);
}

// Returns numbers, damage and grey levels of all frames: "0=7 1d 2=9" are three frames, the second one damaged.
std::string frames_of(FrameSource& source) {
  std::string text;
  while (const auto frame = source.next().value()) {
    text += (text.empty() ? "" : " ") + std::to_string(frame->number) + (frame->damaged ? "d" : "");
    if (!frame->damaged) text += "=" + std::to_string(first_grey(frame->luma));
  }
  return text;
}

std::string frames_in(const TestFolder& folder) { return frames_of(*open_pictures(folder.path(), {}).value()); }

TEST(PictureSource, AMissingImageIsADamagedFrame) {
  const TestFolder folder;
  for (const int i : {3, 4, 7, 8})
    write_grey(folder / ("00000" + std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  auto source = open_pictures(folder.path(), {.fps = 10.0}).value();
  EXPECT_EQ(source->info().frames, 6);
  ASSERT_EQ(source->info().warnings.size(), 1U);
  EXPECT_EQ(source->info().warnings[0], "2 frames have no values: frames 2 to 3: missing image: " +
                                            folder / "000005.png" + " to " + folder / "000006.png");
  EXPECT_EQ(frames_of(*source), "0=3 1=4 2d 3d 4=7 5=8");
  EXPECT_EQ(source->info().warnings.size(), 1U);
  EXPECT_EQ(files_of_input(folder.path(), {}).value().size(), 4U);
}

TEST(PictureSource, AnotherFileAmongNumberedImagesIsAMissingImage) {
  const TestFolder folder;
  for (const int i : {2, 6}) write_grey(folder / (std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  std::filesystem::create_symlink("nowhere", folder / "0.png");
  std::filesystem::create_symlink("1.png", folder / "1.png");
  ASSERT_EQ(::mkfifo((folder / "3.png").c_str(), 0600), 0);
  std::filesystem::create_directory(folder / "4.png");
  put_text(folder / "5.bmp", "BM");
  put_text(folder / "7.png", "this is text");
  put_text(folder / "8.txt", "no picture");
  auto source = open_pictures(folder.path(), {}).value();
  EXPECT_EQ(frames_of(*source), "0d 1d 2=2 3d 4d 5d 6=6 7d");
  ASSERT_EQ(source->info().warnings.size(), 1U);
  for (const char* reason :
       {"frame 0: a broken link: ", "frame 1: a link to itself: ", "frame 3: a FIFO: ", "frame 4: a folder: ",
        "frame 5: not PNG, TIFF or JPEG: ", "frame 7: the file is not an image: "})
    EXPECT_NE(source->info().warnings[0].find(reason), std::string::npos) << source->info().warnings[0];
}

TEST(PictureSource, ARegularStrideOfTheNumbersIsNoGap) {
  const TestFolder folder;
  for (const int i : {10, 20, 40})
    write_grey(folder / ("f" + std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  EXPECT_EQ(frames_in(folder), "0=10 1=20 2d 3=40");
  EXPECT_EQ(frames_of(*open_pictures(folder / "f%d.png", {.fps = {}, .sequence = true}).value()), "0=10 1=20 2d 3=40");
}

TEST(PictureSource, ImagesWithoutFrameNumbersAreConsecutive) {
  const TestFolder clock;  // times go from 59 s to 1 min 00 s
  for (const int i : {59, 100, 101}) {
    const std::string second = std::to_string(1000 + i).substr(1);
    write_grey(clock / ("20261123_080" + second + ".png"), static_cast<std::uint16_t>(i));
  }
  EXPECT_EQ(frames_in(clock), "0=59 1=100 2=101");
  const TestFolder photos;
  for (const int i : {1, 90, 107})
    write_grey(photos / ("IMG_" + std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  auto source = open_pictures(photos.path(), {}).value();
  EXPECT_EQ(frames_of(*source), "0=1 1=90 2=107");
  ASSERT_EQ(source->info().warnings.size(), 1U);
  EXPECT_TRUE(source->info().warnings[0].starts_with("note: ")) << source->info().warnings[0];
  const TestFolder words;
  for (const int i : {1, 2, 4})
    write_grey(words / ("view" + std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  write_grey(words / "other.png", 9);
  source = open_pictures(words.path(), {}).value();
  EXPECT_EQ(frames_of(*source), "0=9 1=1 2=2 3=4");
  ASSERT_EQ(source->info().warnings.size(), 1U);
  EXPECT_NE(source->info().warnings[0].find("and view3.png cannot be used"), std::string::npos);
}

TEST(PictureSource, AFileThatIsNotPlainIsRefusedAtOnce) {
  const TestFolder folder;
  ASSERT_EQ(::mkfifo((folder / "clip.mp4").c_str(), 0600), 0);
  const auto fifo = open_pictures(folder / "clip.mp4", {});
  ASSERT_FALSE(fifo);
  EXPECT_NE(fifo.error().message.find("the input is a FIFO"), std::string::npos) << fifo.error().message;
  EXPECT_NE(open_pictures("/dev/null", {}).error().message.find("the input is a device"), std::string::npos);
  EXPECT_EQ(picture_kind(folder / "clip.mp4"), PictureKind::kNone);
}

TEST(PictureSource, AnInvalidInputIsRefusedWithAReason) {
  const TestFolder folder;
  put_text(folder / "1.png", "this is text");
  const auto text = open_pictures(folder.path(), {});
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().kind, InputErrorKind::kUnsupported);
  EXPECT_EQ(open_pictures(folder / "absent", {}).error().kind, InputErrorKind::kUnreadable);
  EXPECT_FALSE(open_pictures(folder / "%s%n.png", {.fps = {}, .sequence = true}));
  EXPECT_FALSE(open_pictures(folder / "%04d.png", {.fps = {}, .sequence = true}));
}

TEST(PictureList, ALeadingZeroDoesNotChangeTheOrder) {
  EXPECT_TRUE(comes_before("f9.png", "f010.png"));
  EXPECT_TRUE(comes_before("a.png", "b.png"));
  EXPECT_FALSE(comes_before("f10.png", "f9.png"));
  EXPECT_FALSE(comes_before("f1.png", "f1.png"));
  EXPECT_NE(comes_before("f1.png", "f01.png"), comes_before("f01.png", "f1.png"));
}

TEST(PngReader, GreyLevelsAreReadAsStored) {
  const TestFolder folder;
  write_test_png(folder / "8.png", {.width = 2, .height = 1}, {16, 235});
  const auto eight = read_png(folder / "8.png").value();
  EXPECT_EQ(std::get<0>(eight.grey).at(1, 0), 235);
  EXPECT_EQ(eight.bits, 8);
  write_test_png(folder / "16.png", {.width = 2, .height = 1, .depth = 16}, {1, 65534});
  const auto sixteen = read_png(folder / "16.png").value();
  EXPECT_EQ(std::get<1>(sixteen.grey).at(0, 0), 1);
  EXPECT_EQ(std::get<1>(sixteen.grey).at(1, 0), 65534);
  EXPECT_EQ(sixteen.bits, 16);
}

TEST(PngReader, TwelveSignificantBitsMoveToTheLowBits) {
  const TestFolder folder;
  const auto stored = [](unsigned value) { return static_cast<std::uint16_t>(value << 4 | value >> 8); };  // PNG 13.12
  write_test_png(folder / "12.png", {.width = 2, .height = 1, .depth = 16, .significant = 12},
                 {stored(5), stored(4095)});
  const auto picture = read_png(folder / "12.png").value();
  EXPECT_EQ(picture.bits, 12);
  EXPECT_EQ(std::get<1>(picture.grey).at(0, 0), 5);
  EXPECT_EQ(std::get<1>(picture.grey).at(1, 0), 4095);
}

TEST(PngReader, TwelveBitsInTheLowBitsStay) {
  const TestFolder folder;
  write_test_png(folder / "12.png", {.width = 2, .height = 1, .depth = 16, .significant = 12}, {5, 4095});
  const auto picture = read_png(folder / "12.png").value();
  EXPECT_EQ(picture.bits, 12);
  EXPECT_EQ(std::get<1>(picture.grey).at(0, 0), 5);
  EXPECT_EQ(std::get<1>(picture.grey).at(1, 0), 4095);
}

TEST(PngReader, ColourBecomesLumaByOneFormula) {
  const TestFolder folder;
  write_test_png(folder / "c.png", {.width = 1, .height = 1, .colour = true}, {200, 100, 50});
  EXPECT_EQ(std::get<0>(read_png(folder / "c.png").value().grey).at(0, 0), (77 * 200 + 150 * 100 + 29 * 50 + 128) >> 8);
}

// Writes a small image whose header claims `side` (big-endian) as width and height, with the matching check sum.
void write_claim(const std::string& path, const std::string& side, const std::string& checksum) {
  write_grey(path, 0);
  std::string bytes = text_of(path);
  bytes.replace(16, 8, side + side);
  bytes.replace(29, 4, checksum);
  put_text(path, bytes);
}

TEST(PngReader, AHeaderWithTooManyPixelsIsRefusedUnread) {
  const TestFolder folder;
  write_claim(folder / "bomb.png", "\0\0\x7d\0"s, "\xa6\xe9\x8d\xd1");  // 32000
  const auto picture = read_png(folder / "bomb.png");
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().kind, InputErrorKind::kUnsupported) << picture.error().message;
}

TEST(PngReader, AHeaderIsRefusedBeforeLibpngTakesMemoryForARow) {
  const TestFolder folder;
  write_claim(folder / "bomb.png", "\x7f\xff\xff\xff"s, "\x31\xa2\x54\xba");  // 2147483647
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_DATA, &before), 0);
  const rlimit little{std::size_t{1} << 30, before.rlim_max};  // half of the row
  ASSERT_EQ(::setrlimit(RLIMIT_DATA, &little), 0);
  const auto picture = read_png(folder / "bomb.png");
  ASSERT_EQ(::setrlimit(RLIMIT_DATA, &before), 0);
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().kind, InputErrorKind::kUnsupported) << picture.error().message;
}

}  // namespace
}  // namespace moiregauge::internal
