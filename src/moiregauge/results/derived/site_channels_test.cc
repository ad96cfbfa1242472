// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/site_channels.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

Site site_with_targets(const std::vector<std::string>& names) {
  Site site;
  for (const std::string& name : names)
    site.markers.push_back({name, Role::kTarget, std::nullopt, Grating{{}, 40.0, 40.0, 10.0}, std::nullopt});
  return site;
}

const std::vector<ChannelText> kTexts{{"sag", "", "sag(left, mid, right)"},
                                      {"d", "um", "1000 * (mid.dy - 'left'.dy)"},
                                      {"twice", "", "2 * sag + mid.dy"}};

TEST(SiteChannels, ARenamedTargetIsRenamedInEveryExpression) {
  const Site site = site_with_targets({"left", "mid", "right"});
  const std::vector<NewName> names{{"left", "pier 1"}, {"mid", "left"}};
  const auto renamed = renamed_channels(kTexts, site, names);
  ASSERT_EQ(renamed.size(), 3U);
  EXPECT_EQ(renamed[0].expression, "sag('pier 1', left, right)");
  EXPECT_EQ(renamed[1].expression, "1000 * (left.dy - 'pier 1'.dy)");
  EXPECT_EQ(renamed[2].expression, "2 * sag + left.dy");
  const std::vector<std::string> targets{"pier 1", "left", "right"};
  const auto read = read_site_channels(renamed, targets);
  EXPECT_TRUE(read.omitted.empty());
  ASSERT_EQ(read.channels.size(), 3U);
  EXPECT_EQ(read.channels[0].terms[0].targets, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(read.channels[1].unit, "um");
}

// Two names may be exchanged: each place is replaced once.
TEST(SiteChannels, NamesCanBeExchanged) {
  const Site site = site_with_targets({"a", "b"});
  const auto renamed = renamed_channels({{"d", "", "a.dy - b.dy"}}, site, std::vector<NewName>{{"a", "b"}, {"b", "a"}});
  EXPECT_EQ(renamed[0].expression, "b.dy - a.dy");
}

TEST(SiteChannels, AChannelOfATargetThatIsNotMeasuredIsOmittedWithItsReason) {
  const std::vector<std::string> targets{"mid", "right"};
  const auto read = read_site_channels(kTexts, targets);
  EXPECT_TRUE(read.channels.empty());
  ASSERT_EQ(read.omitted.size(), 3U);
  EXPECT_EQ(read.omitted[0], "sag: no target has the name 'left'");
  EXPECT_EQ(read.omitted[2], "twice: no earlier channel has the name 'sag'");
}

}  // namespace
}  // namespace moiregauge::internal
