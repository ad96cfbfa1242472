// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/reference_csv.h"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

tl::expected<Series, ReferenceMistake> parsed(const std::string& text, const ReferenceColumns& columns = {}) {
  std::istringstream csv(text);
  return parse_reference_csv(csv, "lvdt.csv", columns);
}

TEST(ReferenceCsv, LoggersWriteTheSameRecordInManyForms) {
  for (const char* text :
       {"0,1.5\n0.1,-2\n", "time;value\n0;1,5\n0,1;-2\n", "0\t1.5\n0.1\t-2",
        "\xEF\xBB\xBF# logger\r\nt,mm\r\n0,1.5\r\n.1,-2.0\r\n", "\"t\",\"x\"\n\"0\",\"1,5\"\n\"0,1\",\"-2\"\n",
        "Logger\nt;x\ns;mm\n\n0 ; +1.5\n1e-1 ; -2;\n"}) {
    const auto series = parsed(text);
    ASSERT_TRUE(series) << text << series.error().message;
    ASSERT_EQ(series->value.size(), 2U) << text;
    EXPECT_EQ(series->time_s[1], 0.1) << text;
    EXPECT_EQ(series->value[0], 1.5) << text;
    EXPECT_EQ(series->value[1], -2.0) << text;
  }
}

TEST(ReferenceCsv, ColumnsAreChosenByNumberOrName) {
  const char* text = "n,stamp,mm\n0,5,1.5\n1,6,\n2,7,NaN\n";
  for (const ReferenceColumns& columns : {ReferenceColumns{"2", "3", {}}, ReferenceColumns{"stamp", "mm", {}}}) {
    const auto series = parsed(text, columns);
    ASSERT_TRUE(series) << series.error().message;
    EXPECT_EQ(series->time_s, (std::vector<double>{5, 6, 7}));
    EXPECT_EQ(series->value[0], 1.5);
    EXPECT_TRUE(std::isnan(series->value[1]) && std::isnan(series->value[2]));
  }
  const auto rated = parsed("a\n4\n5\n", {"", "1", 50.0});
  ASSERT_TRUE(rated);
  EXPECT_EQ(rated->time_s, (std::vector<double>{0.0, 0.02}));
}

TEST(ReferenceCsv, AMistakeIsNamedWithItsLine) {
  struct Case {
    const char* text;
    ReferenceColumns columns;
    bool is_usage;
    const char* says;
  };
  for (const Case& c :
       {Case{"t,x\n0,1\n1,oops\n", {}, false, "lvdt.csv:3"}, Case{"0,1\n0,2\n", {}, false, "lvdt.csv:2"},
        Case{"t,x\n0,1\n", {"t", "y", {}}, true, "one of t, x"}, Case{"0,1\n", {"1", "3", {}}, true, "column \"3\""},
        Case{"0,1\n", {"t", "2", {}}, true, "column \"t\""}, Case{"", {}, false, "no row of numbers"},
        Case{"0,1\n1\n", {}, false, "lvdt.csv:2"}, Case{"0,1\n,2\n", {}, false, "no time"},
        Case{"0;1.2,3\n", {}, false, "is no number"}, Case{"0,inf\n", {}, false, "is no number"}}) {
    const auto series = parsed(c.text, c.columns);
    ASSERT_FALSE(series) << c.text;
    EXPECT_EQ(series.error().is_usage, c.is_usage) << series.error().message;
    EXPECT_NE(series.error().message.find(c.says), std::string::npos) << series.error().message;
  }
  EXPECT_FALSE(parsed(std::string(kMaxReferenceLine + 1, '1')));
}

}  // namespace
}  // namespace moiregauge::internal
