// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/alarm_rule.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/live/publish/alarm_state.h"

namespace moiregauge::internal {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

AlarmRule rule(const std::string& text) {
  const auto parsed = parse_alarm_rule(text);
  if (parsed) return *parsed;
  ADD_FAILURE() << text << ": " << parsed.error().what;
  return {};
}

TEST(AlarmRule, LengthsAndTimesHaveTheirUnits) {
  const AlarmRule full = rule("T1.dy > 2 mm for 0.5 s until 1.5mm");
  EXPECT_EQ(full.marker, "T1");
  EXPECT_TRUE(full.is_y && full.is_above && !full.is_absolute);
  EXPECT_EQ(full.level_mm, 2.0);
  EXPECT_EQ(full.duration_s, 0.5);
  EXPECT_EQ(full.release_mm, 1.5);
  const AlarmRule short_one = rule("|mid-span.dx|<-25um");
  EXPECT_EQ(short_one.marker, "mid-span");
  EXPECT_TRUE(!short_one.is_y && !short_one.is_above && short_one.is_absolute);
  EXPECT_EQ(short_one.level_mm, -0.025);
  EXPECT_DOUBLE_EQ(short_one.release_mm, -0.0225);
  EXPECT_EQ(rule("\"pier 2\".dx > 1cm for 200ms").marker, "pier 2");
  EXPECT_EQ(rule("T1.dx > 1cm for 200ms").level_mm, 10.0);
  EXPECT_EQ(rule("T1.dx > 1in").level_mm, 25.4);
  EXPECT_EQ(rule("T1.dx > 1mm for 2 min").duration_s, 120.0);
}

TEST(AlarmRule, AMistakeNamesItsColumn) {
  struct Case {
    const char* text;
    std::size_t column;
  };
  const Case cases[] = {{"", 1},
                        {"> 2 mm", 1},
                        {"T1 > 2 mm", 4},
                        {"T1.dz > 2 mm", 4},
                        {"T1.dyy > 2 mm", 4},
                        {"T1.dy 2 mm", 7},
                        {"T1.dy >= 2 mm", 8},
                        {"T1.dy > two mm", 9},
                        {"T1.dy > 2", 10},
                        {"T1.dy > 2 mmm", 11},
                        {"T1.dy > 2,5 mm", 10},
                        {"T1.dy > nan mm", 9},
                        {"T1.dy > 1e999 mm", 9},
                        {"T1.dy > 1e308 m", 16},
                        {"T1.dy > 2 mm for 0.5", 21},
                        {"T1.dy > 2 mm for -1 s", 18},
                        {"T1.dy > 2 mm until 3 mm", 20},
                        {"T1.dy > 2 mm and T2.dy > 2 mm", 14},
                        {"|T1.dy > 2 mm", 8},
                        {"\"T1.dy > 2 mm", 1}};
  for (const auto& [text, column] : cases) {
    const auto parsed = parse_alarm_rule(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().column, column) << text << ": " << parsed.error().what;
  }
  EXPECT_FALSE(parse_alarm_rule(std::string(301, 'x')));
}

struct Row {
  double time_s;
  double value_mm;
};

// Returns the times of all changes, with a minus sign for those that clear the alarm.
std::vector<double> changes(AlarmState& state, const std::vector<Row>& rows) {
  std::vector<double> times;
  for (const Row& row : rows) {
    const AlarmChange change = state.step(row.time_s, row.value_mm);
    if (change != AlarmChange::kNone) times.push_back(change == AlarmChange::kRaised ? row.time_s : -row.time_s);
  }
  return times;
}

std::vector<Row> steady(double from_s, double to_s, double value_mm, double step_s = 0.1) {
  std::vector<Row> rows;
  for (int i = 0; from_s + i * step_s < to_s - 1e-9; ++i) rows.push_back({from_s + i * step_s, value_mm});
  return rows;
}

std::vector<Row> joined(std::initializer_list<std::vector<Row>> parts) {
  std::vector<Row> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

TEST(AlarmState, WithoutADurationTheFirstRowBeyondTheLevelRaisesIt) {
  AlarmState state(rule("T1.dy > 2 mm"));
  EXPECT_EQ(changes(state, {{0.0, 2.0}, {0.1, 2.0001}, {0.2, 3.0}}), std::vector<double>{0.1});
}

TEST(AlarmState, AShorterExcursionThanTheDurationRaisesNothing) {
  AlarmState state(rule("T1.dy > 2 mm for 0.5 s"));
  EXPECT_TRUE(changes(state, joined({steady(0.0, 0.5, 2.1), steady(0.5, 1.0, 1.9), steady(1.0, 1.5, 2.1)})).empty());
  const auto raised = changes(state, joined({steady(1.5, 1.6, 0.0), steady(1.6, 3.0, 2.1)}));
  ASSERT_EQ(raised.size(), 1U);
  EXPECT_NEAR(raised[0], 2.1, 1e-9) << "0.5 s after the first row beyond the level";
}

TEST(AlarmState, AValueBetweenReleaseAndLevelKeepsTheAlarm) {
  AlarmState state(rule("T1.dy > 2 mm until 1.5 mm"));
  const auto times = changes(state, joined({steady(0.0, 0.1, 2.5), steady(0.1, 5.0, 1.6), steady(5.0, 7.0, 1.4)}));
  ASSERT_EQ(times.size(), 2U);
  EXPECT_NEAR(times[1], -6.0, 1e-9) << "cleared after 1 s on the safe side";
}

TEST(AlarmState, AVibrationRaisesOneAlarm) {
  AlarmState state(rule("|T1.dy| > 2 mm"));
  std::vector<Row> rows;
  for (int i = 0; i < 500; ++i) rows.push_back({0.02 * i, 3.0 * std::sin(2.0 * i * 0.02 * 3.14159265)});  // 1 Hz
  EXPECT_EQ(changes(state, rows).size(), 1U);
}

TEST(AlarmState, UnmeasuredRowsNeitherRaiseNorClear) {
  AlarmState state(rule("T1.dy > 2 mm for 0.5 s"));
  EXPECT_TRUE(changes(state, joined({{{0.0, 2.5}}, steady(0.1, 3.0, kNan)})).empty());
  EXPECT_TRUE(changes(state, {{3.0, 2.5}}).empty()) << "a gap of 3 s proves nothing about the time between";
  EXPECT_EQ(changes(state, {{3.2, kNan}, {3.3, 2.5}, {3.5, 2.5}}), std::vector<double>{3.5})
      << "short gaps are bridged";
  EXPECT_TRUE(changes(state, steady(4.0, 100.0, kNan)).empty());
  EXPECT_TRUE(state.is_raised()) << "an alarm does not clear because the marker is covered";
  EXPECT_TRUE(changes(state, {{100.0, 0.0}}).empty());
  EXPECT_EQ(changes(state, {{100.5, 0.0}, {101.0, 0.0}}), std::vector<double>{-101.0});
}

TEST(AlarmState, ARuleBelowALevelIsTheMirrorImage) {
  AlarmState up(rule("T1.dy > 2 mm for 0.3 s")), down(rule("T1.dy < -2 mm for 0.3 s"));
  for (int i = 0; i < 400; ++i) {
    const double time_s = 0.05 * i, value = 4.0 * std::sin(0.7 * time_s);
    EXPECT_EQ(up.step(time_s, value), down.step(time_s, -value)) << time_s;
  }
}

}  // namespace
}  // namespace moiregauge::internal
