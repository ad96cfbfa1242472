// SPDX-License-Identifier: Apache-2.0
#include <iterator>

#include "moiregauge/base/atomic_file.h"

#include <gtest/gtest.h>

#include "moiregauge/io/pictures/pictures_for_tests.h"

namespace moiregauge::internal {
namespace {

TEST(AtomicFile, TheNewFileReplacesTheOldOneCompletely) {
  const TestFolder folder;
  ASSERT_TRUE(write_file_atomically(folder / "a.csv", "old and long"));
  ASSERT_TRUE(write_file_atomically(folder / "a.csv", std::string_view("n\0w", 3)));
  EXPECT_EQ(text_of(folder / "a.csv"), std::string("n\0w", 3));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "no temporary file is left";
}

TEST(AtomicFile, AFailedWriteReportsTheReasonAndLeavesNoFile) {
  const TestFolder folder;
  const auto nowhere = write_file_atomically(folder / "absent/a.csv", "text");
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().find("absent/a.csv (No such file"), std::string::npos);
  std::filesystem::create_directory(folder / "taken");
  put_text(folder / "taken/by", "a folder that is not empty");
  EXPECT_FALSE(write_file_atomically(folder / "taken", "text"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace moiregauge::internal
