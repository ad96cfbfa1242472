// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/run_table.h"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "moiregauge/io/tables/table_csv.h"
#include "moiregauge/io/tables/uff58.h"

namespace moiregauge::internal {
namespace {

constexpr const char* kHeader = "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status";

RunTable table_of(const std::string& rows) {
  std::istringstream csv(std::string(kHeader) + "\n" + rows);
  RunTable table;
  const auto read = parse_displacement_csv(csv, table);
  EXPECT_TRUE(read) << read.error();
  return table;
}

std::string mistake_in(const std::string& text) {
  std::istringstream csv(text);
  RunTable table;
  const auto read = parse_displacement_csv(csv, table);
  return read ? std::string() : read.error();
}

constexpr const char* kTwo =
    "0,0.000000,a,0.000000,0.000000,0.000000,0.000000,ok\n0,0.000000,b,0.000000,0.000000,0.000000,0.000000,ok\n"
    "1,0.100000,a,1.000000,2.000000,0.001000,0.002000,ok\n1,0.100000,b,NaN,NaN,NaN,NaN,lost\n"
    "2,0.200000,a,3.000000,4.000000,0.001000,0.002000,untrusted\n2,0.200000,b,5.000000,6.000000,0.001000,0.002000,ok\n";

TEST(RunTable, ATableIsWrittenBackToTheByte) {
  EXPECT_EQ(long_csv(table_of(kTwo)), std::string(kHeader) + "\n" + kTwo);
}

// Later versions may add columns, names may contain anything that RFC 4180 can quote, and Windows ends lines with two
// bytes.
TEST(RunTable, FurtherColumnsQuotesAndCarriageReturnsAreRead) {
  std::istringstream csv(std::string(kHeader) + ",quality\r\n3,NaN,\"a \"\"b\"\", c\",1,2,3,4,ok,0.5\r\n");
  RunTable table;
  ASSERT_TRUE(parse_displacement_csv(csv, table));
  EXPECT_EQ(table.markers.at(0).name, "a \"b\", c");
  EXPECT_EQ(table.samples.at(0).displacement.y, 2.0);
  EXPECT_TRUE(std::isnan(table.samples.at(0).time_s));
}

TEST(RunTable, AMistakeNamesItsLine) {
  EXPECT_NE(mistake_in("").find("line 1"), std::string::npos);
  EXPECT_NE(mistake_in("frame,marker\n").find("line 1"), std::string::npos);
  const std::string head = std::string(kHeader) + "\n";
  EXPECT_NE(mistake_in(head + "0,0,a,0,0,0,0,ok\n1,0,a,0,0,0,0,fine\n").find("line 3, \"fine\""), std::string::npos);
  EXPECT_NE(mistake_in(head + "0,0,a,0,0x,0,0,ok\n").find("\"0x\""), std::string::npos);
  EXPECT_NE(mistake_in(head + "-1,0,a,0,0,0,0,ok\n").find("\"-1\""), std::string::npos);
  EXPECT_NE(mistake_in(head + "0,0,a,inf,0,0,0,ok\n").find("\"inf\""), std::string::npos);
  EXPECT_NE(mistake_in(head + "0,0,a\n").find("eight"), std::string::npos);
  EXPECT_NE(mistake_in(head + "0,0,\"a,0,0,0,0,ok\n").find("line 2"), std::string::npos);
}

FrameRange from_second(double first_s) { return {0, -1, 1, TimeRange{first_s}}; }

TEST(RunTable, SelectionsKeepTheOrderAndReplaceValuesThatAreNotOk) {
  const auto part = selected(table_of(kTwo), {{"b", "a"}, from_second(0.1), true});
  ASSERT_TRUE(part) << part.error();
  EXPECT_EQ(wide_csv(*part),
            "frame,time_s,b_dx_mm,b_dy_mm,b_u_dx_mm,b_u_dy_mm,b_ok,a_dx_mm,a_dy_mm,a_u_dx_mm,a_u_dy_mm,a_ok\n"
            "1,0.100000,NaN,NaN,NaN,NaN,0,1.000000,2.000000,0.001000,0.002000,1\n"
            "2,0.200000,5.000000,6.000000,0.001000,0.002000,1,NaN,NaN,NaN,NaN,0\n");
  EXPECT_FALSE(selected(table_of(kTwo), {{"c"}, {}, false}));
  EXPECT_FALSE(selected(table_of(kTwo), {{}, from_second(0.3), false}));
}

TEST(Uff58, AGapIsRefusedOrSplitNeverFilled) {
  const auto refused = uff58(table_of(kTwo), Gaps::kRefuse);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("b dx (2 of 3"), std::string::npos) << refused.error();
  const auto split = uff58(table_of(kTwo), Gaps::kSplit);
  ASSERT_TRUE(split);
  std::size_t datasets = 0;
  for (std::size_t at = split->find("\n    58\n"); at != std::string::npos; at = split->find("\n    58\n", at + 1))
    ++datasets;
  EXPECT_EQ(datasets, 6u);  // a: x and y; b: two stretches of each
}

// A frame step of 2 is no gap.
TEST(Uff58, AFrameStepIsNoGap) {
  const auto written = uff58(table_of("0,0.0,a,1,1,0,0,ok\n2,0.2,a,2,2,0,0,ok\n4,0.4,a,3,3,0,0,ok\n"), Gaps::kRefuse);
  ASSERT_TRUE(written) << written.error();
  EXPECT_NE(written->find("         4         3         1  0.00000E+00  2.00000E-01  0.00000E+00"), std::string::npos)
      << *written;
}

TEST(Uff58, WithoutTimeThereIsNoSeries) {
  EXPECT_FALSE(uff58(table_of("0,NaN,a,1,1,0,0,ok\n1,NaN,a,1,1,0,0,ok\n"), Gaps::kSplit));
}

}  // namespace
}  // namespace moiregauge::internal
