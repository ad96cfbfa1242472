// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/print_model.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/observation/print/picture_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::cosines, test::crossed_lines, test::kNoise, test::print, test::seen, test::Shift, test::shift_of,
    test::tinted_lines, test::upright;

PrintModel learned(const Image<std::uint8_t>& picture, TemplateUse use) {
  auto model = learn_print(picture.view(), upright(), print(), {.use = use});
  EXPECT_TRUE(model);
  return model.value();
}

struct Scatter {
  double rms = 0.0, u = 0.0, pixels = 0.0;
};

constexpr int kPictures = 100;

Scatter scatter(const PrintModel& model) {
  const PrintFromImage map = model.correction * *local_map(upright(), print(), {});
  std::vector<double> shifts;
  Scatter s;
  double sum = 0.0;
  for (int k = 0; k < kPictures; ++k) {
    const auto picture = seen(crossed_lines, static_cast<std::uint64_t>(100 + k));
    const auto fit = read_points(picture.view(), upright(), {print()}, model);
    EXPECT_TRUE(fit);
    const Shift shift = shift_of(*fit, map);
    shifts.push_back(shift.pitches);
    sum += shift.pitches;
    s.u = shift.u, s.pixels = fit->pixels;
  }
  for (const double x : shifts) s.rms += (x - sum / kPictures) * (x - sum / kPictures) / (kPictures - 1);
  s.rms = std::sqrt(s.rms);
  return s;
}

// The Fisher information of a shift is in the template's slopes at the window's pixels. The scatter of 100 images has u
// = 7 %. Light and the other columns of the field add a few per cent.
TEST(PrintModel, ATemplateLowersTheScatterByTheInformationOfTheEdges) {
  const auto first = seen(crossed_lines, 1);
  const PrintModel with = learned(first, TemplateUse::kOn), without = learned(first, TemplateUse::kOff);
  const Scatter on = scatter(with), off = scatter(without);
  const double sigma = std::hypot(kNoise, 1.0 / std::sqrt(12.0));
  const auto predicted = [&](const PrintModel& model, const Scatter& s) {
    return sigma / std::sqrt(model.print.slope_power_x() * s.pixels);
  };
  EXPECT_NEAR(on.rms / predicted(with, on), 1.0, 0.25);
  EXPECT_NEAR(off.rms / predicted(without, off), 1.0, 0.25);
  const double fewer = predicted(without, off) / predicted(with, on);
  EXPECT_GT(fewer, 1.5);
  EXPECT_NEAR(off.rms / on.rms / fewer, 1.0, 0.15);  // the same images, so most of the noise is common
  // With the template, u equals the scatter. Without it, the residual of the harmonics counts as noise.
  EXPECT_NEAR(on.u / on.rms, 1.0, 0.25);
  EXPECT_GT(off.u, 5.0 * off.rms);
}

TEST(PrintModel, HarmonicsAreUsedWhereTheyExist) {
  const auto binary = seen(crossed_lines, 1), cosine = seen(cosines, 1);
  EXPECT_EQ(learned(binary, TemplateUse::kAuto).print.order(), learned(binary, TemplateUse::kOn).print.order());
  EXPECT_EQ(learned(binary, TemplateUse::kOff).print.order(), 1);
  EXPECT_EQ(learned(cosine, TemplateUse::kAuto).print.order(), 1);
  EXPECT_GT(learned(cosine, TemplateUse::kOn).print.order(), 1);
}

// A grating in grey ink has a quarter of black's contrast here. Without harmonics its edges still leave residuals of
// several times the noise, so the template is used.
TEST(PrintModel, HarmonicsOfAFaintGratingAreUsedToo) {
  const auto faint = seen([](double x, double y) { return tinted_lines(x, y, 0.25); }, 1);
  EXPECT_GT(learned(faint, TemplateUse::kAuto).print.order(), 1);
}

// Grey ink has a tenth of black's contrast here. A strip of paper differs from the template by 17 grey levels where
// lines would be, which is more than six times the noise rms. The window must end there: paper has no lines to fit.
TEST(PrintModel, TheWindowEndsAtTheEdgeOfAFaintGrating) {
  const PatchWindow window =
      learned(seen([](double x, double y) { return tinted_lines(x, y, 0.1); }, 1), TemplateUse::kOn).window;
  // The window ends at whole strips of 0.05 pitch and half a pixel from the edge.
  EXPECT_NEAR(window.half_x, 0.5 * test::kPitches, 0.15);
  EXPECT_NEAR(window.half_y, 0.5 * test::kPitches, 0.15);
}

// Over whole pitches harmonics are orthogonal to the fundamentals. A cosine has none, so its window keeps its size.
TEST(PrintModel, FundamentalsOfABinaryGratingAreReadOverWholePitches) {
  const PatchWindow binary = learned(seen(crossed_lines, 1), TemplateUse::kOff).window;
  EXPECT_DOUBLE_EQ(2.0 * binary.half_x, std::round(2.0 * binary.half_x));
  EXPECT_DOUBLE_EQ(2.0 * binary.half_y, std::round(2.0 * binary.half_y));
  const auto cosine = seen(cosines, 1);
  EXPECT_EQ(learned(cosine, TemplateUse::kOff).window.half_x, learned(cosine, TemplateUse::kOn).window.half_x);
}

}  // namespace
}  // namespace moiregauge::internal
