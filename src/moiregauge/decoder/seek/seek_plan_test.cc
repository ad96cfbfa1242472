// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/seek/seek_plan.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

// Groups of four pictures in the order of decoding. Closed: a key frame, then the frame three later, then two between.
std::vector<PacketNote> closed_groups(int groups) {
  std::vector<PacketNote> packets;
  std::int64_t decoded = -2;
  for (std::int64_t first = 0; first < 4 * groups; first += 4)
    for (const std::int64_t shown : {first, first + 3, first + 1, first + 2})
      packets.push_back({shown, decoded++, shown == first, false});
  return packets;
}

// Open: the two frames before each key frame come after it.
std::vector<PacketNote> open_groups(int groups) {
  std::vector<PacketNote> packets{{0, -2, true, false}};
  std::int64_t decoded = -1;
  for (std::int64_t key = 3; key <= 3 * groups; key += 3)
    for (const std::int64_t shown : {key, key - 2, key - 1}) packets.push_back({shown, decoded++, shown == key, false});
  return packets;
}

TEST(SeekPlan, StartsAtTheKeyFrameBeforeAClosedGroup) {
  const auto plan = plan_seek(closed_groups(5), 14, 0);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->packet, 12);
  EXPECT_EQ(plan->first_frame, 12);
  EXPECT_EQ(plan->first_time, 12);
  EXPECT_EQ(plan->begin_time, 0);
}

TEST(SeekPlan, ReachesAKeyFrameWithLeadingFramesFromTheOneBefore) {
  const auto plan = plan_seek(open_groups(5), 10, 0);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->first_frame, 9);
  EXPECT_EQ(plan->packet, 4) << "packets 4, 5, 6 are frames 6, 4, 5; packet 7 is frame 9, before frames 7 and 8";
}

TEST(SeekPlan, TheMarginIsDecodedToo) {
  EXPECT_EQ(plan_seek(closed_groups(5), 14, 3)->first_frame, 8);
  EXPECT_EQ(plan_seek(closed_groups(5), 15, 3)->first_frame, 12);
}

TEST(SeekPlan, NumbersFollowTheOrderOfTimesWhateverTheirSteps) {
  std::vector<PacketNote> packets = closed_groups(5);
  for (PacketNote& packet : packets) packet.shown = *packet.shown * *packet.shown;
  EXPECT_EQ(plan_seek(packets, 14, 0)->first_frame, 12);
  EXPECT_EQ(plan_seek(packets, 14, 0)->first_time, 144);
}

TEST(SeekPlan, HiddenFramesHaveNoNumber) {
  std::vector<PacketNote> packets = closed_groups(5);
  packets[2].is_hidden = true;
  EXPECT_EQ(plan_seek(packets, 14, 0)->first_frame, 11);
}

TEST(SeekPlan, TimesThatDoNotDetermineNumbersGiveNoPlan) {
  std::vector<PacketNote> packets = closed_groups(5);
  packets[2].shown = packets[3].shown;
  EXPECT_FALSE(plan_seek(packets, 14, 0));
  packets[2].shown.reset();
  EXPECT_FALSE(plan_seek(packets, 14, 0));
}

TEST(SeekPlan, ThereIsNothingToSkipInTheFirstGroup) {
  EXPECT_FALSE(plan_seek(closed_groups(5), 3, 0));
  EXPECT_FALSE(plan_seek(closed_groups(5), 0, 3));
  EXPECT_FALSE(plan_seek(open_groups(5), 5, 0)) << "the key frame 3 is reached from frame 0";
  EXPECT_FALSE(plan_seek(closed_groups(5), 20, 0)) << "there are 20 frames";
}

TEST(SeekPlan, ReadingEndsWhenLaterPacketsChangeNothing) {
  const std::vector<PacketNote> all = open_groups(8);
  const auto whole = plan_seek(all, 10, 1);
  ASSERT_TRUE(whole);
  std::vector<PacketNote> some;
  for (const PacketNote& packet : all) {
    some.push_back(packet);
    if (is_enough(some, 10)) break;
  }
  ASSERT_LT(some.size(), all.size());
  const auto plan = plan_seek(some, 10, 1);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->packet, whole->packet);
  EXPECT_EQ(plan->first_frame, whole->first_frame);
}

}  // namespace
}  // namespace moiregauge::internal
