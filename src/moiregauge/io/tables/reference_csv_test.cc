// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/reference_csv.h"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

tl::expected<ReferenceRecord, ReferenceMistake> parsed(const std::string& text, const ReferenceColumns& columns = {}) {
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
    ASSERT_EQ(series->series.value.size(), 2U) << text;
    EXPECT_EQ(series->series.time_s[1], 0.1) << text;
    EXPECT_EQ(series->series.value[0], 1.5) << text;
    EXPECT_EQ(series->series.value[1], -2.0) << text;
  }
}

TEST(ReferenceCsv, ColumnsAreChosenByNumberOrName) {
  const char* text = "n,stamp,mm\n0,5,1.5\n1,6,\n2,7,NaN\n";
  for (const ReferenceColumns& columns :
       {ReferenceColumns{"2", "3", {}, ""}, ReferenceColumns{"stamp", "mm", {}, ""}}) {
    const auto series = parsed(text, columns);
    ASSERT_TRUE(series) << series.error().message;
    EXPECT_EQ(series->series.time_s, (std::vector<double>{5, 6, 7}));
    EXPECT_EQ(series->series.value[0], 1.5);
    EXPECT_TRUE(std::isnan(series->series.value[1]) && std::isnan(series->series.value[2]));
  }
  const auto rated = parsed("a\n4\n5\n", {"", "1", 50.0, ""});
  ASSERT_TRUE(rated);
  EXPECT_EQ(rated->series.time_s, (std::vector<double>{0.0, 0.02}));
}

TEST(ReferenceCsv, TimesAreNumbersOfAnyUnitOrThoseOfAClock) {
  struct Case {
    const char* text;
    const char* unit_option;
    const char* unit;  // found in the header
  };
  for (const Case& c : {Case{"time_ms,mm\n500,1\n1250,2\n", "", "ms"}, Case{"t;x\nms;mm\n0;1\n750;2\n", "", "ms"},
                        Case{"Time [us],mm\n0,1\n750000,2\n", "", "us"}, Case{"t (s),mm\n0,1\n0.75,2\n", "", ""},
                        Case{"t,mm\n0,1\n750,2\n", "ms", ""}, Case{"time_ms,mm\n0,1\n0.75,2\n", "s", ""},
                        Case{"t_min,mm\n0,1\n0.0125,2\n", "", "min"},
                        Case{"t,mm\n2026-11-25T10:59:59.50Z,1\n2026-11-25T11:00:00.25Z,2\n", "", ""},
                        Case{"t,mm\n2026-11-25T23:59:59.50+01:00,1\n2026-11-25T23:00:00.25Z,2\n", "", ""},
                        Case{"t;mm\n31.12.2026 23:59:59,50;1\n1.1.2027 0:00:00,25;2\n", "", ""},
                        Case{"2028-02-29 23:59:59.5,1\n2028-03-01 00:00:00.25,2\n", "", ""},
                        Case{"clock_h,mm\n23:59:59.5,1\n00:00:00.25,2\n", "", "h"}}) {
    const auto record = parsed(c.text, {"1", "2", {}, c.unit_option});
    ASSERT_TRUE(record) << c.text << record.error().message;
    ASSERT_EQ(record->series.time_s.size(), 2U) << c.text;
    EXPECT_NEAR(record->series.time_s[1] - record->series.time_s[0], 0.75, 1e-6) << c.text;
    EXPECT_EQ(record->time_unit, c.unit) << c.text;
  }
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
        Case{"t,x\n0,1\n", {"t", "y", {}, ""}, true, "one of t, x"},
        Case{"0,1\n", {"1", "3", {}, ""}, true, "column \"3\""},
        Case{"0,1\n", {"t", "2", {}, ""}, true, "column \"t\""}, Case{"", {}, false, "no row of numbers"},
        Case{"0,1\n1\n", {}, false, "lvdt.csv:2"}, Case{"0,1\n,2\n", {}, false, "no time"},
        Case{"0;1.2,3\n", {}, false, "is no number"}, Case{"0,inf\n", {}, false, "is no number"},
        Case{"t,x\n11/12/2026 10:00:00,1\n0,1\n", {}, false, "is no number"},
        Case{"2026-02-30 10:00:00,1\n", {}, false, "is no number"}, Case{"10:60:00,1\n", {}, false, "is no number"},
        Case{"0,1\n10:00:00,2\n", {}, false, "is no number"}, Case{"10:00:00,1\n1e18,2\n", {}, false, "another form"},
        Case{"2026-11-25 10:00:00,1\n10:00:01,2\n", {}, false, "another form"},
        Case{"10:00:02,1\n10:00:01,2\n", {}, false, "do not increase"},
        Case{"\xFF\xFE"
             "1",
             {},
             false,
             "UTF-16"}}) {
    const auto series = parsed(c.text, c.columns);
    ASSERT_FALSE(series) << c.text;
    EXPECT_EQ(series.error().is_usage, c.is_usage) << series.error().message;
    EXPECT_NE(series.error().message.find(c.says), std::string::npos) << series.error().message;
  }
  EXPECT_FALSE(parsed(std::string(kMaxReferenceLine + 1, '1')));
}

}  // namespace
}  // namespace moiregauge::internal
