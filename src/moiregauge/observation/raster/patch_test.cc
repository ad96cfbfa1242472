// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/raster/patch.h"

#include <gtest/gtest.h>

#include "moiregauge/observation/print/picture_for_tests.h"

namespace moiregauge::internal {
namespace {

// Noise has an amplitude at every frequency, about as large as its u. Its phase is any number, with a u of about 1 rad,
// and must not become a displacement. A fringe of one grey level still has u = 0.03 rad.
TEST(ReadPatch, NoiseHasNoPhase) {
  const auto plan = plan_raster(test::print(), 1.0, {});
  ASSERT_TRUE(plan);
  const auto is_read = [&](double share, std::uint64_t seed) {
    const auto picture = test::sheet([=](double x, double y) { return 100.0 + share * test::cosines(x, y); }, seed);
    return read_patch(picture.view(), 8, test::upright(), *plan, {}).valid;
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_FALSE(is_read(0.0, seed)) << seed;
    EXPECT_TRUE(is_read(1.0 / 42.5, seed)) << seed;
  }
}

}  // namespace
}  // namespace moiregauge::internal
