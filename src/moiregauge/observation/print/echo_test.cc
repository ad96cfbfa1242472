// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/print/echo.h"

#include <cmath>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "moiregauge/observation/print/picture_for_tests.h"

namespace moiregauge::internal {
namespace {

using test::kSide, test::print, test::upright;

constexpr int kFrames = 24;
using Plane = std::vector<double>;

struct Film {
  double share = 0.0;      // weight of the previous output, 1
  double exposure = 0.0;   // relative to the frame interval, 1
  double texture = 0.0;    // rms of a structure that is printed on the sheet, grey levels
  double per_frame = 0.0;  // px. Movement in one direction, instead of to and fro.
  bool averages = false;   // stores the mean of two frames
  bool sinusoidal = false;
  double across = 0.7;  // movement along y, relative to that along x
};

// Position of the sheet, px.
struct At {
  double x = 0.0, y = 0.0;
};
// `time`: in frames.
At position(double time, double reach_px, const Film& film) {
  if (film.per_frame > 0.0) return {0.94 * film.per_frame * time, 0.34 * film.per_frame * time};
  return {reach_px * std::sin(0.61 * time), film.across * reach_px * std::sin(0.43 * time + 1.0)};
}

// Structure of 12 waves of 3 to 8 px that the sheet carries along.
class Texture {
 public:
  explicit Texture(double rms) {
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<double> direction(0.0, kTwoPi), period(3.0, 8.0);
    for (auto& wave : waves_) {
      const double angle = direction(rng), k = kTwoPi / period(rng);
      wave = {k * std::cos(angle), k * std::sin(angle), direction(rng), rms * std::sqrt(2.0 / kWaves)};
    }
  }
  double operator()(double x, double y) const {
    double sum = 0.0;
    for (const auto& [kx, ky, phase, size] : waves_) sum += size * std::cos(kx * x + ky * y + phase);
    return sum;
  }

 private:
  static constexpr int kWaves = 12;
  struct Wave {
    double kx, ky, phase, size;
  };
  std::array<Wave, kWaves> waves_{};
};

// Renders one frame in light without noise, in steps over the exposure.
Plane exposed(int frame, double reach_px, const Film& film, const Texture& texture) {
  const int steps = film.exposure > 0.0 ? 12 : 1;
  Plane light(std::size_t{kSide} * kSide);
  for (int k = 0; k < steps; ++k) {
    const At at = position(frame + film.exposure * ((k + 0.5) / steps - 0.5), reach_px, film);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double px = x - 0.5 * kSide - at.x, py = 0.5 * kSide - y - at.y;
        const double printed = film.sinusoidal ? test::cosines(px, py) : test::crossed_lines(px, py);
        const double grey = test::is_inside(px, py) ? printed : test::kPaper;
        light[static_cast<std::size_t>(y * kSide + x)] += (grey + (film.texture > 0.0 ? texture(px, py) : 0.0)) / steps;
      }
    }
  }
  return light;
}

// Sums of a film of a grating that moves by up to `reach_px`. Sensor and memory of the camera hold whole grey levels.
EchoSums sums_of(double reach_px, const Film& film, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> noise(0.0, test::kNoise);
  const Texture texture(film.texture);
  tl::expected<PrintModel, PatchFitFailure> model = tl::unexpected(PatchFitFailure::kNoPattern);
  EchoWatch watch;
  Plane last, sensor;
  for (int frame = 0; frame < kFrames; ++frame) {
    Plane now = exposed(frame, reach_px, film, texture);
    Image<std::uint8_t> stored(kSide, kSide);
    for (std::size_t i = 0; i < now.size(); ++i) {
      now[i] = std::round(now[i] + noise(rng));
      if (film.averages && frame > 0) std::tie(now[i], sensor[i]) = std::pair(0.5 * (now[i] + sensor[i]), now[i]);
      if (!last.empty()) now[i] += film.share * (last[i] - now[i]);
      stored.at(static_cast<int>(i) % kSide, static_cast<int>(i) / kSide) =
          static_cast<std::uint8_t>(std::lround(std::clamp(now[i], 0.0, 255.0)));
    }
    if (frame == 0) sensor = now;
    last = now;
    const double lag = film.averages && frame > 0 ? 0.5 : 0.0;  // frames
    const At start = position(0, reach_px, film), at = position(frame - lag, reach_px, film);
    if (!model) model = learn_print(stored.view(), upright(), print(), {.use = TemplateUse::kOn});
    if (!model) return {};
    const Extent<frame::Board> moved{at.x - start.x, at.y - start.y};
    const auto fit = read_points(stored.view(), upright(), {print(), moved}, *model);
    if (!fit) {
      ADD_FAILURE() << "frame " << frame;
      return {};
    }
    watch.add({stored.view(), {}}, {{0, &*model, &*fit, 1.0}});
  }
  return watch.sums();
}

// A share s shows the previous frame with s, and earlier ones with s^2 and less. Those add up to s / (1 - s) at most.
TEST(Echo, EdgesThatMoveShowTheShareOfThePreviousFrame) {
  for (const double share : {0.1, 0.2}) {
    for (const double exposure : {0.0, 0.9}) {
      const EchoShare found = share_by_edges(sums_of(3.0, {share, exposure, 0.0}, 11));
      EXPECT_GT(found.share, share - 4.0 * found.u) << share << ", exposure " << exposure;
      EXPECT_LT(found.share, share / (1.0 - share) + 4.0 * found.u) << share << ", exposure " << exposure;
      EXPECT_GT(found.share, 4.0 * found.u) << share << ", exposure " << exposure;
    }
  }
}

// An exposure smears alike before and after its middle, and a structure of the paper is no echo.
TEST(Echo, AnExposureAndStructureOfThePaperAreNone) {
  for (const double exposure : {0.0, 0.9}) {
    for (const double texture : {0.0, 3.0}) {
      const EchoShare found = share_by_edges(sums_of(3.0, {0.0, exposure, texture}, 12));
      EXPECT_LT(std::abs(found.share), 4.0 * found.u + 0.003) << exposure << ", texture " << texture;
      EXPECT_LT(found.u, 0.02);
    }
  }
}

// The mean of two frames lies in the middle of its images, so their edges are alike on both sides and show no share. It
// adds the variance D^2 / 4, three times that of the longest exposure. D is a chord of sines of w = 0.43 and 0.61 per
// frame. The slope of D^2 is then too small by cos(w), and in a mean also by cos^2(w / 2). So b is larger by 1.10 to
// 1.34.
TEST(Echo, AMeanOfTwoFramesShowsAsBlur) {
  const EchoSums mean = sums_of(1.5, {.averages = true}, 21), exposed = sums_of(1.5, {.exposure = 1.0}, 21);
  EXPECT_LT(std::abs(share_by_edges(mean).share), 0.03);
  EXPECT_NEAR(mean.blur.slope, 1.22 / 4.0, 0.12 / 4.0 + 3.0 * mean.blur.u);
  EXPECT_NEAR(exposed.blur.slope, 1.22 / 12.0, 0.12 / 12.0 + 3.0 * exposed.blur.u);
  EXPECT_GT(mean.blur.slope - 2.0 * mean.blur.u, kBlurOfExposure);
}

// Moved along its diagonal, a sinusoidal grating hardly differs from its images before and after. The noise of the
// template then looks like them, up to 0.19 in a frame. Two equal frames have a share of 0.1.
TEST(Echo, ASinusoidalGratingIsNoImageOnBothSides) {
  const EchoShare found = sums_of(4.0, {.sinusoidal = true, .across = 1.3}, 22).both_sides;
  EXPECT_TRUE(std::isinf(found.u) || std::abs(found.share) < 0.02) << found.share << ", u " << found.u;
  const EchoShare lines = sums_of(4.0, {.across = 1.3}, 22).both_sides;
  EXPECT_LT(std::abs(lines.share), 0.01);
  EXPECT_LT(lines.u, 0.01);
}

// Mean share by the noise of four films.
EchoShare mean_share_by_noise(double reach_px, const Film& film) {
  constexpr int kFilms = 4;
  EchoShare mean{0.0, 0.0};
  double variances = 0.0;
  for (int k = 0; k < kFilms; ++k) {
    const EchoShare one = share_by_noise(sums_of(reach_px, film, 20 + static_cast<std::uint64_t>(k)));
    mean.share += one.share / kFilms, variances += one.u * one.u;
  }
  mean.u = std::sqrt(variances) / kFilms;
  return mean;
}

// Below a third of a pixel only the noise of the pixels that change shows the share. A fixed part of the residuals does
// not count. A part that moves with the sheet follows the distances: without beta it would be a share of 0.04.
TEST(Echo, TheNoiseOfPixelsThatChangeShowsTheShareOfSlowMovement) {
  for (const double texture : {0.0, 6.0}) {
    const EchoShare without = mean_share_by_noise(0.45, {0.0, 0.0, texture});
    EXPECT_LT(std::abs(without.share), 4.0 * without.u) << texture;
    EXPECT_LT(without.u, 0.009) << texture;
  }
  const EchoShare found = mean_share_by_noise(0.2, {0.3, 0.0, 0.0});
  EXPECT_GT(found.share, 4.0 * found.u);
  EXPECT_LT(found.share, 0.3 + 4.0 * found.u);
}

// Movement in one direction has the same distance in every frame. Neighbours have the same distance on the sheet and
// no echo, so the structure of the paper is no share.
TEST(Echo, TheNoiseShowsTheShareOfMovementInOneDirection) {
  for (const double per_frame : {0.1, 0.2, 0.28, 0.4}) {
    for (const double texture : {0.0, 3.0}) {
      const EchoShare without = mean_share_by_noise(0.0, {0.0, 0.0, texture, per_frame});
      EXPECT_LT(std::abs(without.share), 4.0 * without.u) << per_frame << " px, texture " << texture;
    }
    const EchoShare found = mean_share_by_noise(0.0, {0.3, 0.0, 0.0, per_frame});
    EXPECT_GT(found.share, 4.0 * found.u) << per_frame << " px";
    EXPECT_LT(found.share, 0.3 + 4.0 * found.u) << per_frame << " px";
  }
}

// An error of the template acts alike while the grating moves in one direction. u of the edges must include it.
TEST(Echo, EdgesThatMoveInOneDirectionShowNoShareBeyondTheirUncertainty) {
  for (const double per_frame : {0.35, 0.45, 0.55}) {
    double squares = 0.0, variances = 0.0;
    constexpr int kFilms = 6;
    for (int k = 0; k < kFilms; ++k) {
      const EchoShare one =
          share_by_edges(sums_of(0.0, {0.0, 0.0, 0.0, per_frame}, 30 + static_cast<std::uint64_t>(k)));
      squares += one.share * one.share, variances += one.u * one.u;
    }
    // chi-square of six films: below 3.75 times its mean with a probability of 0.999.
    EXPECT_LT(squares, 3.75 * variances) << per_frame << " px";
  }
}

// Shares of gratings that move in one direction, each with an error of its template.
EchoShare share_of_gratings(double echo, double template_error, std::uint64_t seed) {
  constexpr double kByNoise = 0.04;  // u of one grating in one frame
  constexpr std::size_t kGratings = 5;
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> standard;
  std::array<double, kGratings> own{};
  for (double& share : own) share = echo + template_error * standard(rng);
  EchoSums sums;
  for (int frame = 0; frame < kFrames; ++frame) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kGratings; ++i) {
      const double share = own[i] + kByNoise * standard(rng);
      sum += share / kGratings;
      add_grating(i, share, kByNoise, sums);
    }
    const double u = kByNoise / std::sqrt(double{kGratings});
    add_share({sum, u, u, 0.0}, sums);
  }
  return share_by_edges(sums);
}

// An echo is alike in all gratings, an error of a template is not. With such errors, too, a share of 3 u is as rare as 3
// sigma (0.0013). So at most 5.2 + 4 sqrt(5.2) of 4000 draws are beyond. Alike gratings keep the u of their noise.
TEST(Echo, ErrorsThatDifferBetweenGratingsAreNoShare) {
  for (const double error : {0.02, 0.1}) {
    int beyond = 0;
    for (std::uint64_t seed = 0; seed < 4000; ++seed) {
      const EchoShare one = share_of_gratings(0.0, error, 100 + seed);
      beyond += one.share > 3.0 * one.u;
    }
    EXPECT_LE(beyond, 14) << "errors of " << error;
  }
  const EchoShare alike = share_of_gratings(0.1, 0.0, 7);
  EXPECT_GT(alike.share, 3.0 * alike.u);
}

// Returns true if the shares of a target that moves to and fro end the work within 24 frames.
bool ends_early(double echo, std::uint64_t seed) {
  constexpr double kByNoise =
      0.025;  // u of one frame. That of 24 frames is above 0.003, which would end the work, too.
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> standard;
  EchoSums sums;
  bool ended = false;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double direction = frame % 2 == 0 ? kByNoise : -kByNoise;
    add_share({echo + kByNoise * standard(rng), kByNoise, direction, 0.0}, sums);
    ended = ended || is_decided(sums);
  }
  return ended;
}

// Frames without an echo end the work early. Those with the smallest one that matters do not. 3e-5 of all shares are 4 u
// below the limit, so less than 1.5 of 2000 recordings of 24 frames. More than 6 have a probability of 0.001.
TEST(Echo, CertainlyNoEchoEndsTheWork) {
  int without = 0, with = 0;
  constexpr int kRecordings = 2000;
  for (std::uint64_t seed = 0; seed < kRecordings; ++seed)
    without += ends_early(0.0, 5000 + seed), with += ends_early(kLeastEcho, 5000 + seed);
  EXPECT_GT(without, kRecordings / 2);
  EXPECT_LE(with, 6);
}

// A grating that moves by `step` px per frame. Its structure is a wave of 4 px along both axes with the variance
// `structure`, relative to that of the residuals.
struct MovingGrating {
  At step;
  double structure = 0.05, echo = 0.0, pixels = 3000.0;
};
// Adds the products of the residuals.
void add_moving_grating(std::size_t marker, const MovingGrating& grating, std::mt19937_64& rng, EchoSums& sums) {
  const auto& [step, structure, echo, pixels] = grating;
  std::normal_distribution<double> noise(0.0, 1.0 / std::sqrt(pixels));
  for (int frame = 0; frame < kFrames; ++frame) {
    std::vector<NoiseProduct> same, others;
    for (int k = 1; k <= 7; ++k) {
      for (int e = 0; e < 49; ++e) {
        const int ex = e % 7 - 3, ey = e / 7 - 3;
        const double dx = k * step.x - ex, dy = k * step.y - ey;
        if (std::hypot(dx, dy) > kLargestDistance_px) continue;
        const bool is_same = ex == 0 && ey == 0, is_echo = is_same && k == 1;
        const double beta = structure * std::cos(kPi / 2.0 * dx) * std::cos(kPi / 2.0 * dy);
        (is_same ? same : others).push_back({dx, dy, is_echo, beta + (is_echo ? echo : 0.0) + noise(rng)});
      }
    }
    add_products(marker, same, pixels, sums);
    add_products(marker, others, pixels, sums);
  }
}

// The structure of a template differs from grating to grating. Gratings that move by half a pixel in one direction show a
// share only if two lags are near enough. With one structure for all, the strong one of two such gratings was a share
// of 0.06 in simulated footage of a lens of -2 %.
TEST(Echo, AStructureThatDiffersBetweenGratingsIsNoShare) {
  constexpr std::uint64_t kSeed = 17;
  const auto share_of = [](double echo) {
    std::mt19937_64 rng(kSeed);
    EchoSums sums;
    for (const std::size_t marker : {0U, 2U}) add_moving_grating(marker, {{0.44, -0.52}, 0.05, echo}, rng, sums);
    for (const std::size_t marker : {1U, 3U}) add_moving_grating(marker, {{0.45, -0.30}, 0.5, echo}, rng, sums);
    return share_by_noise(sums);
  };
  const EchoShare without = share_of(0.0), with = share_of(0.1);
  EXPECT_LT(std::abs(without.share), 3.0 * without.u) << "seed " << kSeed;
  EXPECT_NEAR(with.share, 0.1, 3.0 * with.u) << "seed " << kSeed;
  EXPECT_GT(with.share, 4.0 * with.u) << "seed " << kSeed;
}

// A vibration blurs its target, and the blur returns with its phase. That looks like an echo in one of five gratings. The
// uncertainty of the share then covers the difference of the gratings.
TEST(Echo, AnEchoOfOneGratingAloneIsNoShare) {
  constexpr std::uint64_t kSeed = 18;
  std::mt19937_64 rng(kSeed);
  EchoSums sums;
  for (std::size_t marker = 0; marker < 5; ++marker)
    add_moving_grating(marker, {{0.2, 0.1}, 0.05, marker == 4 ? 0.4 : 0.0}, rng, sums);
  const EchoShare found = share_by_noise(sums);
  EXPECT_LT(found.share, 3.0 * found.u) << "seed " << kSeed;
}

// Behind a filter that keeps edges, the few products that blur leaves have larger errors than those of independent pixels.
// A share known to a tenth or worse decides nothing.
TEST(Echo, AShareByFewPixelsIsNone) {
  constexpr std::uint64_t kSeed = 19;
  const auto share_of = [](double pixels) {
    std::mt19937_64 rng(kSeed);
    EchoSums sums;
    add_moving_grating(0, {{0.2, 0.1}, 0.05, 0.9, pixels}, rng, sums);
    return share_by_noise(sums);
  };
  EXPECT_TRUE(std::isinf(share_of(3.0).u)) << "seed " << kSeed;
  EXPECT_NEAR(share_of(300.0).share, 0.9, 4.0 * share_of(300.0).u) << "seed " << kSeed;
}

TEST(Echo, AGratingAtRestDecidesNothing) {
  const EchoSums sums = sums_of(0.005, {0.3, 0.0, 0.0}, 14);
  EXPECT_TRUE(std::isinf(share_by_edges(sums).u));
  EXPECT_TRUE(std::isinf(share_by_noise(sums).u));
}

}  // namespace
}  // namespace moiregauge::internal
