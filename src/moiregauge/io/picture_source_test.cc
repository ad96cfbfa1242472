// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/picture_source.h"

#include <cmath>

#include <gtest/gtest.h>

#include "moiregauge/io/picture_list.h"
#include "moiregauge/io/png_reader.h"
#include "moiregauge/io/test_pictures.h"

namespace moiregauge {
namespace {

void write_grey(const std::string& path, std::uint16_t grey, TestPng shape = {}) {
  const auto pixels = static_cast<std::size_t>(shape.width * shape.height * (shape.colour ? 3 : 1));
  write_test_png(path, shape, std::vector<std::uint16_t>(pixels, grey));
}

int first_grey(const LumaView& luma) {
  return std::visit([](const auto& view) { return static_cast<int>(view.at(0, 0)); }, luma);
}

TEST(PictureSource, PicturesComeInTheOrderPeopleCountThem) {
  const TestFolder folder;
  for (const int i : {10, 9, 1, 2})
    write_grey(folder / ("frame" + std::to_string(i) + ".png"), static_cast<std::uint16_t>(i));
  put_text(folder / "notes.txt", "no picture");
  put_text(folder / ".hidden.png", "no picture");
  auto source = open_pictures(folder.path(), {}).value();
  EXPECT_EQ(source->info().frames, 4);
  EXPECT_EQ(source->info().time_source, "none");
  for (const int expected : {1, 2, 9, 10}) {
    const auto frame = source->next().value();
    EXPECT_EQ(first_grey(frame->luma), expected);
    EXPECT_TRUE(std::isnan(frame->time_s)) << "pictures have no time without --fps";
  }
  EXPECT_FALSE(source->next().value().has_value());
}

TEST(PictureSource, AFolderWithoutPicturesGivesThoseOfItsFrames) {
  const TestFolder folder;
  std::filesystem::create_directory(folder / "frames");
  write_grey(folder / "frames/000000.png", 7);
  put_text(folder / "truth.csv", "frame\n");
  EXPECT_EQ(open_pictures(folder.path(), {}).value()->info().frames, 1);
}

TEST(PictureSource, FramesPerSecondGiveThePicturesATime) {
  const TestFolder folder;
  write_grey(folder / "a1.png", 1);
  write_grey(folder / "a2.png", 2);
  auto source = open_pictures(folder.path(), {.fps = 4.0}).value();
  EXPECT_EQ(source->next().value()->time_s, 0.0);
  EXPECT_EQ(source->next().value()->time_s, 0.25);
  EXPECT_EQ(source->info().time_source, "fps-option");
}

TEST(PictureSource, APictureThatCannotBeReadCostsItsFrameOnly) {
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

TEST(PictureSource, APictureOfAnotherSizeEndsTheInputThere) {
  const TestFolder folder;
  write_grey(folder / "1.png", 1);
  write_grey(folder / "2.png", 1, {.width = 5, .height = 2});
  auto source = open_pictures(folder.path(), {}).value();
  EXPECT_TRUE(source->next());
  for (int again = 0; again < 2; ++again) {
    const auto frame = source->next();
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().kind, InputErrorKind::kDamaged);
    EXPECT_NE(frame.error().message.find("frame size changed 4x2 of 8 bit -> 5x2 of 8 bit at frame "),
              std::string::npos);
  }
}

TEST(PictureSource, AMissingNumberKeepsTheOthersTheirPlaceInTime) {
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

TEST(PictureSource, WhatIsNoInputSaysSo) {
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

TEST(PngReader, GreyLevelsComeAsStoredAtTheirDepth) {
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

TEST(PngReader, TwelveSignificantBitsComeBackIntoTheLowBits) {
  const TestFolder folder;
  const auto stored = [](unsigned value) { return static_cast<std::uint16_t>(value << 4 | value >> 8); };  // PNG 13.12
  write_test_png(folder / "12.png", {.width = 2, .height = 1, .depth = 16, .significant = 12},
                 {stored(5), stored(4095)});
  const auto picture = read_png(folder / "12.png").value();
  EXPECT_EQ(picture.bits, 12);
  EXPECT_EQ(std::get<1>(picture.grey).at(0, 0), 5);
  EXPECT_EQ(std::get<1>(picture.grey).at(1, 0), 4095);
}

TEST(PngReader, TwelveBitsThatLieInTheLowBitsStayThere) {
  const TestFolder folder;
  write_test_png(folder / "12.png", {.width = 2, .height = 1, .depth = 16, .significant = 12}, {5, 4095});
  const auto picture = read_png(folder / "12.png").value();
  EXPECT_EQ(picture.bits, 12);
  EXPECT_EQ(std::get<1>(picture.grey).at(0, 0), 5);
  EXPECT_EQ(std::get<1>(picture.grey).at(1, 0), 4095);
}

TEST(PngReader, ColourBecomesLumaByTheOneFormula) {
  const TestFolder folder;
  write_test_png(folder / "c.png", {.width = 1, .height = 1, .colour = true}, {200, 100, 50});
  EXPECT_EQ(std::get<0>(read_png(folder / "c.png").value().grey).at(0, 0), (77 * 200 + 150 * 100 + 29 * 50 + 128) >> 8);
}

TEST(PngReader, AHeaderThatPromisesTooManyPixelsIsRefusedUnread) {
  const TestFolder folder;
  write_grey(folder / "bomb.png", 0);
  std::string bytes = text_of(folder / "bomb.png");
  // width and height 32000, with the checksum that belongs to them
  bytes.replace(16, 8, std::string("\0\0\x7d\0\0\0\x7d\0", 8));
  bytes.replace(29, 4, "\xa6\xe9\x8d\xd1");
  put_text(folder / "bomb.png", bytes);
  const auto picture = read_png(folder / "bomb.png");
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().kind, InputErrorKind::kUnsupported) << picture.error().message;
}

}  // namespace
}  // namespace moiregauge
