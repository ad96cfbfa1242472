// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/confined_folder.h"

#include <fcntl.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/server/folder/series_columns.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

TEST(ConfinedFolder, ALinkMayLeadAnywhereInsideButNotOutside) {
  const TestFolder made;
  const fs::path top = made.path();
  fs::create_directories(top / "shown/sub");
  std::ofstream(top / "secret") << "x";
  std::ofstream(top / "shown/sub/a.csv") << "x";
  fs::create_symlink("sub/a.csv", top / "shown/inside.csv");
  fs::create_symlink("../secret", top / "shown/outside.csv");
  fs::create_symlink(top / "secret", top / "shown/absolute.csv");
  fs::create_symlink("..", top / "shown/up");
  const auto folder = ConfinedFolder::open((top / "shown").string());
  ASSERT_TRUE(folder);
  EXPECT_TRUE(folder->existing("sub/a.csv"));
  EXPECT_TRUE(folder->existing("inside.csv"));
  for (const char* path : {"outside.csv", "absolute.csv", "up/secret", "up/shown/sub/a.csv", "../secret",
                           "sub/../../secret", ".", "/etc/passwd", "sub//a.csv", ""})
    EXPECT_FALSE(folder->existing(path)) << path;
  EXPECT_TRUE(folder->creatable("sub/new"));
  for (const char* path : {"up/new", "nowhere/new", "outside.csv", "../new", ".hidden"})
    EXPECT_FALSE(folder->creatable(path)) << path;
}

TEST(SeriesColumns, RowsOfOtherTargetsAndNaNAreKeptApart) {
  SeriesColumns columns;
  add_series_rows(
      "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status\n0,0,T1,0,0,0,0,ok\n0,0,T2,9,9,9,9,ok\n1,0.5,T1,NaN,-2.5,"
      "NaN,0.25,"
      "lost\n",
      "T1", columns);
  ASSERT_EQ(columns.rows(), 2U);
  EXPECT_EQ(columns.values[3][1], -2.5);
  EXPECT_TRUE(std::isnan(columns.values[2][1]));
  EXPECT_EQ(columns.values[6][1], 6.0);  // `lost` in the list of docs/file-formats.md
  EXPECT_EQ(columns.bytes().size(), 2 * 7 * sizeof(double));
}

}  // namespace
}  // namespace moiregauge::internal
