// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/phase/sampling_moire/sampling_moire.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "moiregauge/phase/fit/grating_for_tests.h"

namespace moiregauge::internal {
namespace {

using testing::crossed_cosine;
using testing::random_picture;

constexpr std::uint64_t kMoireSeed = 20231;

double largest(const FringeField& field) {
  double most = 0.0;
  for (int y = 0; y < field.fringe.height(); ++y) {
    for (const auto& z : field.fringe.row(y)) most = std::max(most, std::abs(z));
  }
  return most;
}

double largest_difference(const FringeField& a, const FringeField& b) {
  EXPECT_EQ(a.fringe.width(), b.fringe.width());
  EXPECT_EQ(a.fringe.height(), b.fringe.height());
  EXPECT_EQ(a.margin, b.margin);
  double most = 0.0;
  for (int y = 0; y < a.fringe.height(); ++y) {
    for (int x = 0; x < a.fringe.width(); ++x) most = std::max(most, std::abs(a.fringe.at(x, y) - b.fringe.at(x, y)));
  }
  return most;
}

// Returns the fringe by its definition, tap by tap. It covers fractional T, for which there is no textbook form.
std::complex<double> fringe_by_taps(const Image<double>& picture, int x, int y, double pitch) {
  const int margin = window_margin(pitch);
  std::complex<double> fringe, leak;
  double plain = 0.0, area = 0.0, turned = 0.0;
  for (int u = -margin; u <= margin; ++u) area += pitch - std::abs(u);
  for (int u = -margin; u <= margin; ++u) turned += (pitch - std::abs(u)) / area * std::cos(kTwoPi * u / pitch);
  for (int v = -margin; v <= margin; ++v) {
    for (int u = -margin; u <= margin; ++u) {
      const double weight = (pitch - std::abs(u)) * (pitch - std::abs(v)) / (area * area);
      fringe += weight * picture.at(x + u, y + v) * std::polar(1.0, -kTwoPi * u / pitch);
      plain += weight * picture.at(x + u, y + v);
    }
  }
  return fringe - turned * plain;
}

TEST(SamplingMoire, TextbookAndWindowedDftAreTheSameNumber) {
  std::mt19937_64 rng(kMoireSeed);
  SCOPED_TRACE(::testing::Message() << "seed " << kMoireSeed);
  for (const int pitch : {3, 4, 7, 16, 29, 31, 40}) {
    const Image<double> picture = random_picture(131, 97, rng);
    for (const Axis axis : {Axis::kX, Axis::kY}) {
      const FringeField textbook = sampling_moire_textbook(picture.view(), axis, pitch);
      EXPECT_LT(largest_difference(textbook, sampling_moire(picture.view(), axis, pitch)), 1e-12 * largest(textbook))
          << "T = " << pitch;
    }
  }
}

TEST(SamplingMoire, RoundOffDoesNotGrowAlongAPictureOf4000Pixels) {
  std::mt19937_64 rng(kMoireSeed);
  const Image<double> picture = random_picture(4000, 63, rng);
  const FringeField textbook = sampling_moire_textbook(picture.view(), Axis::kX, 31);
  EXPECT_LT(largest_difference(textbook, sampling_moire(picture.view(), Axis::kX, 31)), 1e-12 * largest(textbook));
}

TEST(SamplingMoire, AFractionalPitchIsTheSameTriangleTapByTap) {
  std::mt19937_64 rng(kMoireSeed);
  const Image<double> picture = random_picture(80, 71, rng);
  for (const double pitch : {2.5, 6.3, 28.99, 30.5}) {
    const FringeField field = sampling_moire(picture.view(), Axis::kX, pitch);
    for (int y = 0; y < field.fringe.height(); y += 3) {
      for (int x = 0; x < field.fringe.width(); x += 5) {
        const auto expected = fringe_by_taps(picture, x + field.margin, y + field.margin, pitch);
        // The limit is 1e-12 of the grey levels, because the fringe itself may be near zero at a pixel.
        EXPECT_LT(std::abs(field.fringe.at(x, y) - expected), 1e-12 * 255.0) << "T = " << pitch;
      }
    }
  }
}

TEST(SamplingMoire, AnEvenlyLitSheetHasNoFringe) {
  const Image<double> sheet(70, 70, 200.0);
  for (const double pitch : {3.0, 29.0, 31.0, 2.5, 28.99, 30.37}) {
    EXPECT_LT(largest(sampling_moire(sheet.view(), Axis::kX, pitch)), 1e-13 * 200.0) << "T = " << pitch;
    EXPECT_LT(std::abs(window_response(pitch, 0.0)), 1e-14) << "T = " << pitch;
  }
}

// The sampled triangle of integer T has a closed response to exp(2 pi i f x), with d = f - 1/T.
//     (sin(pi T d) / (T sin(pi d)))^2
// At f = -1/P it is sinc^2(1 + T/P), except that sin(pi d) replaces pi d. The relative difference is at most (pi d)^2 /
// 3 to this order.
TEST(SamplingMoire, TheResponseToTheMirrorTermIsSincSquared) {
  for (const int pitch : {25, 29, 31, 36}) {
    const double d = 1.0 / pitch + 1.0 / 29.3;
    const double sampled = std::pow(std::sin(kPi * pitch * d) / (pitch * std::sin(kPi * d)), 2);
    const double sinc = std::pow(std::sin(kPi * pitch * d) / (kPi * pitch * d), 2);
    const double response = window_response(pitch, -1.0 / 29.3);
    EXPECT_NEAR(response, sampled, 1e-14);
    EXPECT_NEAR(response / sinc, 1.0, 1.1 * std::pow(kPi * d, 2) / 3.0);
  }
  EXPECT_NEAR(window_response(31.0, -1.0 / 29.0), 0.0011, 0.00005);
}

TEST(SamplingMoire, APureCosineComesOutAsFringeAndMirrorTermAndNothingElse) {
  for (const double pitch : {29.0, 31.0, 30.5}) {
    Image<double> picture(140, 70);
    for (int y = 0; y < 70; ++y) {
      for (int x = 0; x < 140; ++x) picture.at(x, y) = 90.0 + 40.0 * std::cos(kTwoPi * x / 29.3 + 0.7);
    }
    const FringeField field = sampling_moire(picture.view(), Axis::kX, pitch);
    for (int x = 0; x < field.fringe.width(); ++x) {
      const std::complex<double> wave = std::polar(20.0, kTwoPi * (x + field.margin) / 29.3 + 0.7);
      const auto expected =
          window_response(pitch, 1.0 / 29.3) * wave + window_response(pitch, -1.0 / 29.3) * std::conj(wave);
      EXPECT_LT(std::abs(field.fringe.at(x, 0) - expected), 1e-12) << "T = " << pitch;
    }
  }
}

TEST(SamplingMoire, APictureSmallerThanOneWindowHasNoField) {
  const Image<double> small(60, 61);
  EXPECT_EQ(sampling_moire(small.view(), Axis::kX, 31.0).fringe.width(), 0);
  EXPECT_EQ(sampling_moire(Image<double>(61, 61).view(), Axis::kX, 31.0).fringe.width(), 1);
  EXPECT_EQ(sampling_moire(Image<double>(61, 61).view(), Axis::kX, 2.0).fringe.width(), 0);
}

TEST(SamplingMoire, AMissingPixelAffectsOnlyTheWindowsThatContainIt) {
  Image<double> picture = crossed_cosine(90, 90, {.pitch_px = 7.0});
  picture.at(45, 40) = std::numeric_limits<double>::quiet_NaN();
  const FringeField field = sampling_moire(picture.view(), Axis::kY, 7.0);
  for (int y = 0; y < field.fringe.height(); ++y) {
    for (int x = 0; x < field.fringe.width(); ++x) {
      const bool holds_it = std::abs(x + field.margin - 45) < 7 && std::abs(y + field.margin - 40) < 7;
      EXPECT_EQ(std::isnan(std::abs(field.fringe.at(x, y))), holds_it) << x << ' ' << y;
    }
  }
}

}  // namespace
}  // namespace moiregauge::internal
