// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/frame/occlusion.h"

#include <gtest/gtest.h>

#include "moiregauge/observation/frame/observe.h"
#include "moiregauge/observation/frame/track.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {
namespace {

// Reference frame of a small scene with a noise of 1.5 grey levels, and the first reference in frame 2.
struct Scene {
  simulator::Scenario scenario = *simulator::built_in("small-1xyz");
  Reference reference;
  Image<std::uint8_t> now = picture(2);
  std::size_t marker = 0;
  Scene() {
    const auto first = picture(0);
    reference = *make_reference({first.view(), 8}, simulator::site_of(scenario), Camera{}, {});
    learn_prints({first.view(), 8}, reference);
  }
  [[nodiscard]] Image<std::uint8_t> picture(long frame) const {
    return render8(scenario, frame, {0, simulator::Area::kMarkersOnly});
  }
  [[nodiscard]] const PrintModel& print() const { return *reference.prints[marker]; }
  [[nodiscard]] const PatchFit& at_rest() const { return *reference.seen.markers[marker].points; }
  // Adds light to the part of the grating that u and v (window coordinates) span.
  void reflect(double u0, double u1, double v0, double v1, int levels) {
    for (int y = 0; y < now.height(); ++y) {
      for (int x = 0; x < now.width(); ++x) {
        const auto at = at_rest().window_from_image(ImagePoint{double(x), double(y)});
        if (at.x > u0 && at.x < u1 && at.y > v0 && at.y < v1)
          now.at(x, y) = static_cast<std::uint8_t>(std::min(255, now.at(x, y) + levels));
      }
    }
  }
  [[nodiscard]] std::optional<PatchFit> fit() const {
    auto fit = read_points(LumaView(now.view()), reference.view, {*reference.site.markers[marker].grating}, print());
    return fit ? std::optional(*std::move(fit)) : std::nullopt;
  }
};

// A reflection of 3 levels over a ninth of the window raises sigma^2 from 2.2 to 3.1, and fivefold in its blocks.
TEST(Occlusion, AFaintReflectionOverANinthIsFound) {
  Scene scene;
  auto fit = scene.fit();
  ASSERT_TRUE(fit);
  EXPECT_FALSE(find_occluded_blocks({scene.now.view(), 8}, scene.print(), scene.at_rest(), *fit).any_now);
  scene.reflect(-0.34, 0.34, -0.34, 0.34, 3);
  fit = scene.fit();
  ASSERT_TRUE(fit);
  const double ratio = fit->sigma * fit->sigma / (scene.at_rest().sigma * scene.at_rest().sigma);
  EXPECT_GT(ratio, 1.2);
  EXPECT_LT(ratio, 2.0);
  const auto covered = find_occluded_blocks({scene.now.view(), 8}, scene.print(), scene.at_rest(), *fit);
  EXPECT_TRUE(covered.any_now);
  EXPECT_FALSE(covered.any_then);
  int blocks = 0;
  for (const bool b : covered.now) blocks += b;
  EXPECT_NEAR(blocks, 4, 1) << "a ninth of 36 blocks";
}

// A window that is covered elsewhere, too, has no free part.
TEST(Occlusion, AFreePartMustFitLikeTheReferenceFrame) {
  Scene scene;
  BlockSet covered{};
  covered[0] = true;
  auto fit = scene.fit();
  ASSERT_TRUE(fit);
  EXPECT_TRUE(free_points({scene.now.view(), 8}, scene.print(), scene.at_rest(), *fit, covered));
  scene.reflect(-0.5, 0.5, -0.5, 0.5, 8);
  fit = scene.fit();
  ASSERT_TRUE(fit);
  EXPECT_FALSE(free_points({scene.now.view(), 8}, scene.print(), scene.at_rest(), *fit, covered));
}

}  // namespace
}  // namespace moiregauge::internal
