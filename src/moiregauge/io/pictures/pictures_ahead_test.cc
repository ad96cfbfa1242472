// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/pictures_ahead.h"

#include <atomic>
#include <chrono>
#include <new>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Picture picture_number(long number) {
  Picture picture;
  picture.grey = Image<std::uint16_t>(1, 1, static_cast<std::uint16_t>(number));
  return picture;
}

TEST(PicturesAhead, ImagesComeInOrderWhicheverIsReadFirst) {
  for (const int readers : {1, 2, 5, 100}) {
    PicturesAhead ahead(
        3, 60,
        [](long i) -> PictureOrError {
          std::this_thread::sleep_for(std::chrono::microseconds(i % 7 * 300));  // later images are often ready first
          return picture_number(i);
        },
        readers);
    for (long i = 3; i < 60; ++i) EXPECT_EQ(std::get<1>(ahead.take()->grey).at(0, 0), i) << readers;
  }
}

TEST(PicturesAhead, AtMostSixteenAreInMemoryWithAnyNumberOfThreads) {
  std::atomic<long> begun{0};
  PicturesAhead ahead(
      0, 1000,
      [&begun](long i) -> PictureOrError {
        ++begun;
        return picture_number(i);
      },
      1000);
  for (long taken = 0; taken < 50; ++taken) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_LE(begun, taken + 15) << "and one in use";
    EXPECT_TRUE(ahead.take());
  }
}

TEST(PicturesAhead, AnUnreadableImageIsAnErrorAtItsPositionOnly) {
  PicturesAhead ahead(
      0, 4,
      [](long i) -> PictureOrError {
        if (i == 1) return tl::unexpected(InputError{InputErrorKind::kDamaged, "torn"});
        if (i == 2) throw std::bad_alloc();
        return picture_number(i);
      },
      2);
  EXPECT_TRUE(ahead.take());
  EXPECT_EQ(ahead.take().error().message, "torn");
  EXPECT_THROW(static_cast<void>(ahead.take()), std::bad_alloc);
  EXPECT_TRUE(ahead.take());
}

TEST(PicturesAhead, StoppingWaitsOnlyForImagesBeingRead) {
  PicturesAhead ahead(
      0, 1'000'000, [](long i) -> PictureOrError { return picture_number(i); }, 3);
  EXPECT_TRUE(ahead.take());
}

}  // namespace
}  // namespace moiregauge::internal
