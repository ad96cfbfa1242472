// SPDX-License-Identifier: Apache-2.0
// Tests identification among false candidates, on a part of tools/identity-study's scenes with other seeds.
#include <gtest/gtest.h>

#include "common/identity_verdict.h"

namespace moiregauge::internal::test {
namespace {

constexpr std::uint64_t kFirstSeed = 700'001;
constexpr int kScenesPerTest = 6;

// Returns true if the error is below five times u, with the right references and target.
bool is_sound(const IdentityVerdict& v) { return v.error_mm < 5.0 * v.u_mm; }

class CrowdedScenes : public testing::TestWithParam<int> {};

TEST_P(CrowdedScenes, ReferencesAndTargetAreIdentified) {
  for (int i = 0; i < kScenesPerTest; ++i) {
    const CrowdedScene scene = crowded_scene(kFirstSeed + static_cast<std::uint64_t>(kScenesPerTest * GetParam() + i));
    const Shots shots = shots_of(scene);
    for (const Knowledge knowledge : {Knowledge::kSite, Knowledge::kPitchOnly}) {
      const IdentityVerdict v = judged(scene, shots, knowledge);
      EXPECT_NE(v.verdict, Verdict::kWrong) << "seed " << scene.scenario.seed << ": " << v.words;
      EXPECT_EQ(v.verdict, Verdict::kRight) << "seed " << scene.scenario.seed << ": " << v.words;
      EXPECT_TRUE(is_sound(v)) << "seed " << scene.scenario.seed << ": " << v.error_mm << " mm, u " << v.u_mm;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Physics, CrowdedScenes, testing::Range(0, 9));

TEST(Crowded, AMissingCircleIsNotReplacedByAFalseCandidate) {
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 6; ++seed) {
    const CrowdedScene scene = crowded_scene(seed, Fault::kCircleMissing);
    const Shots shots = shots_of(scene);
    for (const Knowledge knowledge : {Knowledge::kSite, Knowledge::kPitchOnly}) {
      const IdentityVerdict v = judged(scene, shots, knowledge);
      EXPECT_EQ(v.verdict, Verdict::kRefused) << "seed " << seed << ": " << v.words;
      EXPECT_FALSE(v.words.empty());
    }
  }
}

}  // namespace
}  // namespace moiregauge::internal::test
