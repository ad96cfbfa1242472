// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/drawing/plots/plot.h"

#include <gtest/gtest.h>

namespace moiregauge::internal::figure {
namespace {

TEST(NiceTicks, AreOneTwoOrFiveTimesAPowerOfTenAndCoverTheRange) {
  EXPECT_EQ(nice_ticks({0.0, 16.0}, 9), (std::vector<double>{0, 2, 4, 6, 8, 10, 12, 14, 16}));
  EXPECT_EQ(nice_ticks({-4.0, 4.0}, 5), (std::vector<double>{-4, -2, 0, 2, 4}));
  EXPECT_EQ(nice_ticks({0.3, 41.0}, 6), (std::vector<double>{0, 10, 20, 30, 40, 50}));
}

TEST(NiceTicks, StayWithinTheirNumberAtAnyScale) {
  for (const double scale : {1e-6, 0.013, 1.0, 7.7, 1e5}) {
    for (const int most : {3, 5, 9}) {
      const auto ticks = nice_ticks({-0.37 * scale, 1.9 * scale}, most);
      EXPECT_LE(ticks.size(), static_cast<std::size_t>(most));
      EXPECT_GE(ticks.size(), 2U);
      EXPECT_LE(ticks.front(), -0.37 * scale);
      EXPECT_GE(ticks.back(), 1.9 * scale);
    }
  }
}

TEST(NiceTicks, WidenARangeWithoutExtent) {
  EXPECT_GT(nice_ticks({0.0, 0.0}, 5).back(), 0.0);
  EXPECT_GT(nice_ticks({3.0, 3.0}, 5).size(), 1U);
}

TEST(TickLabel, HasTheDigitsOfItsStep) {
  EXPECT_EQ(tick_label(0.25, 0.05), "0.25");
  EXPECT_EQ(tick_label(20.0, 10.0), "20");
  EXPECT_EQ(tick_label(-2.0, 0.5), "\u22122.0");
  EXPECT_EQ(tick_label(-1e-17, 0.5), "0.0");
}

TEST(Figure, BecomesThreeFiles) {
  const FigureFiles files = files_of({kOneColumn, 90.0, [](Canvas& canvas) {
                                        Panel panel{.letter = "(a)", .x_label = "time, s", .y_label = "mm"};
                                        panel.series.push_back({.name = "", .x = {0, 1}, .y = {0, 1}});
                                        draw_panel(canvas, {0, 0, kOneColumn, 90.0}, panel);
                                      }});
  EXPECT_EQ(files.png.substr(1, 3), "PNG");
  EXPECT_EQ(files.pdf.substr(0, 5), "%PDF-");
  EXPECT_NE(files.svg.find("<svg"), std::string::npos);
}

}  // namespace
}  // namespace moiregauge::internal::figure
