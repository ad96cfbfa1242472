// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/results/derived/channel_parser.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

const std::vector<std::string> kTargets{"left", "mid", "right", "span 2", "größe"};

tl::expected<Channel, ChannelMistake> parsed(const std::string& text, const std::vector<Channel>& earlier = {}) {
  return parse_channel(text, kTargets, earlier);
}

// Returns the factor of a target's dy in the channel.
double factor_of_dy(const Channel& channel, std::size_t target) {
  for (const ChannelTerm& term : channel.terms) {
    if (term.kind == TermKind::kDy && term.targets.front() == target) return term.factor;
  }
  return 0.0;
}

TEST(ChannelParser, ASagIsTheMiddleMinusTheMeanOfTheEnds) {
  const auto sag = parsed("sag = mid.dy - (left.dy + right.dy) / 2");
  ASSERT_TRUE(sag) << sag.error().what;
  EXPECT_EQ(sag->name, "sag");
  EXPECT_EQ(sag->unit, "mm");
  EXPECT_EQ(sag->text, "mid.dy - (left.dy + right.dy) / 2");
  EXPECT_EQ(factor_of_dy(*sag, 0), -0.5);
  EXPECT_EQ(factor_of_dy(*sag, 1), 1.0);
  EXPECT_EQ(factor_of_dy(*sag, 2), -0.5);
}

TEST(ChannelParser, SignsAndProductsBindAsUsual) {
  const auto channel = parsed("c=-2*mid.dy+6/3*left.dy - -1e0*right.dy*(1-3)");
  ASSERT_TRUE(channel) << channel.error().what;
  EXPECT_EQ(factor_of_dy(*channel, 1), -2.0);
  EXPECT_EQ(factor_of_dy(*channel, 0), 2.0);
  EXPECT_EQ(factor_of_dy(*channel, 2), -2.0);
}

TEST(ChannelParser, EqualTermsAreMergedAndConstantsAdd) {
  const auto channel = parsed("c = mid.dy + mid.dy + 3 - 1");
  ASSERT_TRUE(channel);
  EXPECT_EQ(channel->terms.size(), 1U);
  EXPECT_EQ(factor_of_dy(*channel, 1), 2.0);
  EXPECT_EQ(channel->constant, 2.0);
}

TEST(ChannelParser, NamesWithOddCharactersAreQuoted) {
  EXPECT_TRUE(parsed("c = \"span 2\".dy - 'mid'.dy"));
  EXPECT_TRUE(parsed("c = größe.dy"));
}

TEST(ChannelParser, FunctionsHaveTheirUnits) {
  EXPECT_EQ(parsed("c = strain(left, right)")->unit, "um/m");
  EXPECT_EQ(parsed("c = rotation(left, mid, right)")->unit, "mrad");
  EXPECT_EQ(parsed("c = mid.rotation")->unit, "mrad");
  EXPECT_EQ(parsed("c = 2 * sag(left, mid, right) + chord(left, right)")->unit, "mm");
  EXPECT_EQ(parsed("slope [rad] = (right.dy - left.dy) / 110")->unit, "rad");
  const auto mean = parsed("c = mean(left.dy, mid.dy, right.dy, mid.dy)");
  ASSERT_TRUE(mean);
  EXPECT_EQ(factor_of_dy(*mean, 1), 0.5);
}

TEST(ChannelParser, AnEarlierChannelIsOneOfItsTerms) {
  const auto first = parsed("a = mid.dy - left.dy");
  ASSERT_TRUE(first);
  const auto second = parsed("b = a * 2 + left.dy", {*first});
  ASSERT_TRUE(second) << second.error().what;
  EXPECT_EQ(factor_of_dy(*second, 0), -1.0);
  EXPECT_EQ(factor_of_dy(*second, 1), 2.0);
  EXPECT_FALSE(parsed("a = mid.dy", {*first}));
}

TEST(ChannelParser, AMistakeHasItsColumn) {
  struct Wrong {
    const char* text;
    std::size_t column;
    const char* what;
  };
  for (const Wrong& wrong : {Wrong{"c = mid.dz", 9, "no quantity"},
                             Wrong{"c = middle.dy", 5, "no target"},
                             Wrong{"c = mid.dy * left.dy", 12, "not linear"},
                             Wrong{"c = 1 / mid.dy", 7, "not linear"},
                             Wrong{"c = mid.dy / 0", 12, "zero"},
                             Wrong{"c = (mid.dy", 12, "not closed"},
                             Wrong{"c = mid.dy)", 11, "more text"},
                             Wrong{"c = mid.dy +", 13, "too early"},
                             Wrong{"c = 3", 4, "no target"},
                             Wrong{"mid.dy", 7, "no name"},
                             Wrong{"2c = mid.dy", 1, "proper name"},
                             Wrong{"c = mid.dy + mid.rotation", 12, "two units"},
                             Wrong{"c = strain(mid, mid)", 17, "twice"},
                             Wrong{"c = strain(mid)", 5, "needs 2"},
                             Wrong{"c = sin(mid.dy)", 5, "no function"},
                             Wrong{"c = mid", 8, "without a quantity"},
                             Wrong{"c = 'mid.dy", 5, "does not end"},
                             Wrong{"c = 1e999 * mid.dy", 5, "cannot be read"},
                             Wrong{"c [m m] = mid.dy", 3, "unit"},
                             Wrong{"c = b", 5, "no earlier channel"}}) {
    const auto channel = parsed(wrong.text);
    ASSERT_FALSE(channel) << wrong.text;
    EXPECT_EQ(channel.error().column, wrong.column) << wrong.text;
    EXPECT_NE(channel.error().what.find(wrong.what), std::string::npos) << wrong.text << ": " << channel.error().what;
  }
}

TEST(ChannelParser, HostileTextEndsAtALimit) {
  EXPECT_FALSE(parsed("c = " + std::string(kMaxChannelText, '(')));
  EXPECT_FALSE(parsed("c = " + std::string(1000, '-') + "mid.dy"));
  EXPECT_FALSE(parsed("c = " + std::string(1000, '(') + "mid.dy" + std::string(900, ')')));
  EXPECT_FALSE(parsed(std::string("c = mid\0.dy", 11)));
}

}  // namespace
}  // namespace moiregauge::internal
