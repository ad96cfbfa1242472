// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/mapped_file.h"

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

TEST(MappedFile, MapsTheBytesOfTheFile) {
  const TestFolder folder;
  put_text(folder / "a", "abc");
  const auto mapped = MappedFile::open(folder / "a");
  ASSERT_NE(mapped, nullptr);
  ASSERT_EQ(mapped->bytes().size(), 3U);
  EXPECT_EQ(mapped->bytes()[2], std::byte{'c'});
  EXPECT_TRUE(mapped->is_whole());
}

TEST(MappedFile, ReleasedPagesAreReadAgainOnAccess) {
  const TestFolder folder;
  put_text(folder / "a", std::string(100'000, 'x'));
  const auto mapped = MappedFile::open(folder / "a");
  ASSERT_NE(mapped, nullptr);
  mapped->let_go(mapped->bytes().subspan(5'000, 90'000));
  mapped->let_go(mapped->bytes());
  EXPECT_EQ(mapped->bytes()[0], std::byte{'x'});
  EXPECT_EQ(mapped->bytes()[99'999], std::byte{'x'});
}

TEST(MappedFile, ATruncatedFileReadsAsZerosAndIsReported) {
  const TestFolder folder;
  put_text(folder / "a", std::string(100'000, 'x'));
  const auto mapped = MappedFile::open(folder / "a");
  ASSERT_NE(mapped, nullptr);
  std::filesystem::resize_file(folder / "a", 5'000);
  EXPECT_FALSE(mapped->is_whole());
  EXPECT_EQ(mapped->bytes()[99'999], std::byte{0});
  EXPECT_EQ(mapped->bytes()[0], std::byte{'x'});
  std::filesystem::resize_file(folder / "a", 100'000);
  EXPECT_FALSE(mapped->is_whole()) << "what was read as zeros stays doubtful";
}

TEST(MappedFile, AFileThatCannotBeMappedGivesNull) {
  const TestFolder folder;
  put_text(folder / "empty", "");
  EXPECT_EQ(MappedFile::open(folder / "empty"), nullptr);
  EXPECT_EQ(MappedFile::open(folder / "absent"), nullptr);
  EXPECT_EQ(MappedFile::open(folder.path()), nullptr);
  put_text(folder / "a", "abc");
  std::vector<std::shared_ptr<const MappedFile>> many;
  for (int i = 0; i < 100; ++i) many.push_back(MappedFile::open(folder / "a"));
  EXPECT_NE(many.front(), nullptr);
  EXPECT_EQ(many.back(), nullptr);
  many.clear();
  EXPECT_NE(MappedFile::open(folder / "a"), nullptr) << "places are given back";
}

}  // namespace
}  // namespace moiregauge::internal
