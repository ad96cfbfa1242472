// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/site_file.h"

#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/units/units.h"

namespace moiregauge::internal {
namespace {

constexpr const char* kSheet = R"(
[grating]
pitch_mm = 10
pattern = "grid"
[[target]]
name = "mid"
grating_mm = [0.0, 0]
grating_size_mm = [60.0, 60.0]
z_mm = -30.0
[[reference]]
name = "NW"
circle_mm = [-395.0, 34.0]
circle_diameter_mm = 20.0
grating_mm = [-352.0, 34.0]
grating_size_mm = [50.0, 50.0]
pitch_mm = 5.0
angle_deg = 90.0
[known_to]
position_mm = 0.1
)";

std::string all(const tl::expected<Site, SiteErrors>& read) {
  std::string text;
  if (!read) {
    for (const std::string& line : read.error()) text += line + "\n";
  }
  return text;
}

TEST(SiteFile, AMarkerHasTheDefaultPitchAndPatternUnlessItStatesItsOwn) {
  const auto site = parse_site(kSheet, "site.toml");
  ASSERT_TRUE(site) << all(site);
  ASSERT_EQ(site->markers.size(), 2U);
  const Marker& reference = site->markers[0];
  EXPECT_EQ(reference.name, "NW") << "references come first";
  EXPECT_EQ(reference.grating->pitch_mm, 5.0);
  EXPECT_NEAR(reference.grating->angle_rad, kPi / 2, 1e-15);
  EXPECT_EQ(reference.circle->diameter_mm, 20.0);
  EXPECT_FALSE(reference.z_mm);
  EXPECT_EQ(site->markers[1].grating->pitch_mm, 10.0);
  EXPECT_EQ(site->markers[1].grating->pattern, Pattern::kGrid);
  EXPECT_EQ(site->markers[1].z_mm, -30.0);
  EXPECT_EQ(site->known_to.position_mm, 0.1);
  EXPECT_EQ(site->known_to.height_mm, 3.0) << "the default where the file is silent";
}

TEST(SiteFile, AWrittenSiteReadsBackTheSameToTheLastBit) {
  Site site = parse_site(kSheet, "site.toml").value();
  site.markers[0].circle->centre.x = -0.1 - 0.2;
  site.markers[0].grating->angle_rad = 1.0 / 3.0;
  const auto again = parse_site(write_site(site), "again.toml");
  ASSERT_TRUE(again) << all(again) << write_site(site);
  EXPECT_EQ(again->markers[0].circle->centre.x, site.markers[0].circle->centre.x);
  EXPECT_EQ(again->markers[0].grating->angle_rad, site.markers[0].grating->angle_rad);
  EXPECT_EQ(again->known_to.rotation_rad, site.known_to.rotation_rad);
  EXPECT_EQ(write_site(*again), write_site(site));
}

TEST(SiteFile, AllMistakesOfMeaningAreListedWithTheirPositions) {
  const auto site = parse_site(
      "[grating]\npitch = 10.0\npitch_mm = -1\npattern = \"gird\"\n[[target]]\nname = \"a\"\ngrating_mm = [0.0]\n"
      "grating_size_mm = [0.0, 5.0]\n[[target]]\nname = \"a\"\nz_mm = \"high\"\n[known_to]\nheight_mm = nan\n",
      "site.toml");
  const std::string text = all(site);
  ASSERT_FALSE(site);
  EXPECT_NE(text.find("site.toml:2:1: the key \"pitch\" is unknown, did you mean \"pitch_mm\"?"), std::string::npos)
      << text;
  EXPECT_NE(text.find("site.toml:3:12: pitch_mm must be greater than 0, not -1"), std::string::npos) << text;
  EXPECT_NE(text.find("site.toml:4:11: the pattern \"gird\" is unknown"), std::string::npos) << text;
  EXPECT_NE(text.find("site.toml:7:14: grating_mm must be two finite numbers"), std::string::npos) << text;
  EXPECT_NE(text.find("site.toml:10:8: a marker named \"a\" already exists"), std::string::npos) << text;
  EXPECT_NE(text.find("site.toml:10:8: marker \"a\" has neither circle_mm nor grating_mm"), std::string::npos) << text;
  EXPECT_NE(text.find("site.toml:11:8: z_mm must be a finite number"), std::string::npos) << text;
  EXPECT_NE(text.find("site.toml:13:13: height_mm must be a finite number"), std::string::npos) << text;
}

TEST(SiteFile, ASiteWithoutTargetsIsRefused) {
  EXPECT_NE(all(parse_site("[grating]\npitch_mm = 1.0\n", "s")).find("no [[target]]"), std::string::npos);
}

TEST(SiteFile, AMarkerWithoutAnyPitchIsRefusedAndACircleNeedsNone) {
  const auto bare = parse_site("[[target]]\ngrating_mm = [0, 0]\ngrating_size_mm = [5, 5]\n", "s");
  EXPECT_NE(all(bare).find("the pitch is missing"), std::string::npos) << all(bare);
  const std::string target = "[[target]]\ngrating_mm = [0, 0]\ngrating_size_mm = [5, 5]\npitch_mm = 1\n";
  const auto circle = parse_site("[[reference]]\ncircle_mm = [0, 0]\n" + target, "s");
  ASSERT_TRUE(circle) << all(circle);
  EXPECT_EQ(circle->markers[0].name, "R1");
}

TEST(SiteFile, ATargetWithoutAGratingIsRefusedAtItsLine) {
  const auto site = parse_site("[[target]]\ncircle_mm = [0, 0]\ncircle_diameter_mm = 20\n", "s");
  EXPECT_NE(all(site).find("s:2:"), std::string::npos) << all(site);
  EXPECT_NE(all(site).find("add grating_mm"), std::string::npos) << all(site);
}

TEST(SiteFile, AGratingOfMorePitchesThanAPictureShowsIsRefusedAtItsLine) {
  const auto with_size = [](const std::string& size) {
    return parse_site("[[target]]\ngrating_mm = [0, 0]\ngrating_size_mm = " + size + "\npitch_mm = 10\n", "s");
  };
  EXPECT_NE(all(with_size("[1e7, 1e7]")).find("s:3:"), std::string::npos) << all(with_size("[1e7, 1e7]"));
  EXPECT_TRUE(with_size("[3000, 3000]"));
}

std::string with_channels(const std::string& channels) { return kSheet + channels; }

TEST(SiteFile, ChannelsAreReadAndWritten) {
  const auto file = parse_site_file(with_channels(R"(
[[channel]]
name = "rise"
expression = "mid.dy"
[[channel]]
name = "slope"
unit = "rad"
expression = '2 * rise / 1200 + "mid".dx'
)"),
                                    "s");
  ASSERT_TRUE(file) << file.error().front();
  ASSERT_EQ(file->channels.size(), 2U);
  EXPECT_EQ(file->channels[0].unit, "");
  EXPECT_EQ(file->channels[1].unit, "rad");
  const auto again = parse_site_file(write_site(file->site, file->channels), "s");
  ASSERT_TRUE(again) << again.error().front();
  ASSERT_EQ(again->channels.size(), 2U);
  EXPECT_EQ(again->channels[1].name, "slope");
  EXPECT_EQ(again->channels[1].unit, "rad");
  EXPECT_EQ(again->channels[1].expression, "2 * rise / 1200 + \"mid\".dx");
}

// The channels begin in line 20. Columns point into the expression.
TEST(SiteFile, EveryMistakeOfAChannelHasItsPosition) {
  const auto file = parse_site_file(with_channels("[[channel]]\n"
                                                  "name = \"a\"\n"
                                                  "expression = \"mid.dy - top.dy\"\n"
                                                  "[[channel]]\n"
                                                  "name = \"b\"\n"
                                                  "expression = \"a + mid.dz\"\n"
                                                  "[[channel]]\n"
                                                  "name = \"b\"\n"
                                                  "expression = \"NW.dx\"\n"
                                                  "[[channel]]\n"
                                                  "name = \"9\"\n"
                                                  "unit = \"m m\"\n"
                                                  "expresion = \"mid.dx\"\n"),
                                    "s");
  ASSERT_FALSE(file);
  const std::vector<std::string> expected{
      "s:22:24: no target has the name 'top', use one of mid (put other characters than letters and digits in quotes)",
      "s:25:23: a target has no quantity 'dz', use dx, dy or rotation",
      "s:27:8: a channel named \"b\" already exists",
      "s:28:15: no target has the name 'NW', use one of mid (put other characters than letters and digits in quotes)",
      "s:29:1: the channel has no expression, add expression = \"...\", e.g. \"mid.dy - left.dy\"",
      "s:30:8: the channel has no proper name, begin with a letter, then use letters, digits and _",
      "s:31:8: the unit cannot be read, write up to 16 letters, digits, / and ^",
      "s:32:1: the key \"expresion\" is unknown, did you mean \"expression\"?"};
  EXPECT_EQ(file.error(), expected);
}

TEST(SiteFile, TooManyGratingsAtOnePositionAreRefused) {
  std::string text;
  for (int i = 0; i < 40; ++i)
    text +=
        "[[target]]\ngrating_mm = [" + std::to_string(0.1 * i) + ", 0]\ngrating_size_mm = [40, 40]\npitch_mm = 10\n";
  const std::string problem = all(parse_site(text, "s"));
  EXPECT_NE(problem.find("s:18:"), std::string::npos) << "the fifth, and only that: " << problem;
  EXPECT_EQ(problem.find('\n'), problem.size() - 1) << "one line: " << problem;
  EXPECT_TRUE(parse_site(text.substr(0, text.find("[[target]]", text.find("0.400000") - 30)), "s"));
}

TEST(SiteFile, ANameIsNeitherAFormulaNorAControl) {
  const auto named = [](const std::string& name) {
    return parse_site(
        "[[target]]\nname = \"" + name + "\"\ngrating_mm = [0, 0]\ngrating_size_mm = [5, 5]\npitch_mm = 1\n", "s");
  };
  for (const char* name : {"=cmd|calc", "+1", "-1", "@SUM(A1)",
                           "a\xc2\x9b"
                           "b",
                           "a\xc2\x85"
                           "b",
                           "a\xe2\x80\xae"
                           "b"})
    EXPECT_NE(all(named(name)).find("s:2:"), std::string::npos) << name;
  for (const char* name : {"mid", "a-1", "a=b", "Brücke 3", "橋"}) EXPECT_TRUE(named(name)) << name;
}

TEST(SiteFile, AMistakeOfSyntaxIsOneLineWithItsPosition) {
  for (const char* text :
       {"[", "[\n", "a = 10,0\n", "a = 1\na = 2\n", "[grating]\npitch_mm = 1\n[grating]\n", "x = \"open", "=",
        "a = [1, 2", "\xff\xfe", "a.b = 1\na = 2\n", "[[target]]\n[target]\n", "a = 99999999999999999999\n"}) {
    const auto site = parse_site(text, "site.toml");
    ASSERT_FALSE(site) << text;
    EXPECT_EQ(site.error()[0].rfind("site.toml:", 0), 0U) << site.error()[0];
    EXPECT_EQ(site.error()[0].find('\n'), std::string::npos) << site.error()[0];
  }
}

// The error text of toml11 for such a string reads beyond the text.
TEST(SiteFile, InvalidUtf8IsReportedWithItsLine) {
  for (const char* line : {"name = 'Br\xfc"
                           "cke'",
                           "name = \"\xc3\"", "# \xff", "t =' \xf0\x9f own'"}) {
    EXPECT_EQ(all(parse_site(fmt::format("# Brücke\n{}\n", line), "s")),
              "s:2:1: the text is not UTF-8, save the file as UTF-8\n");
  }
}

TEST(SiteFile, InputThatCouldExhaustTheParserIsRefusedFirst) {
  EXPECT_NE(all(parse_site("a = " + std::string(1000, '['), "s")).find("nested deeper than 32"), std::string::npos);
  EXPECT_NE(all(parse_site(std::string(3000, 'a') + " = 1\n" + "a" + std::string(40, '.'), "s")).find("nest"),
            std::string::npos);
  EXPECT_NE(all(parse_site(std::string(65 * 1024, ' '), "s")).find("64 kB"), std::string::npos);
}

// toml11 4.4 exhausts the stack on the first, and does not return from the second.
TEST(SiteFile, AnArrayThatIsNotClosedIsReported) {
  EXPECT_EQ(all(parse_site("g=[\n[0.0[=", "s")), "s:2:1: a ] is missing before this line's =\n");
  EXPECT_NE(all(parse_site("a = [[1, 2, # first\n [3, 4]]\n", "s")).find("s:"), std::string::npos);
  EXPECT_EQ(all(parse_site("a = [1, 2 # first\nb = 3\n", "s")), "s:2:1: a ] is missing before this line's =\n");
}

TEST(SiteFile, BracketsAndHashesInStringsAreText) {
  const auto site = all(parse_site("name = \"a[b=c # d\"\nother = '''[x\n# = '''\n", "s"));
  EXPECT_EQ(site.find("] is missing"), std::string::npos) << site;
  EXPECT_NE(site.find("s:2:1: the key \"other\" is unknown"), std::string::npos) << site;
}

TEST(SiteFile, AMissingFileIsNamed) {
  EXPECT_NE(all(read_site("/nowhere/site.toml")).find("/nowhere/site.toml: cannot be read"), std::string::npos);
}

TEST(SiteFile, AControlCharacterIsRefused) {
  const auto site = parse_site("# a comment\n# with \x01 in it\n", "s.toml");
  ASSERT_FALSE(site);
  EXPECT_EQ(site.error().front(), "s.toml:2:1: there is a control character, write plain text");
}

TEST(SiteFile, ANumberOutOfRangeIsRefused) {
  for (const char* number : {"1e999", "-1e999", "nan", "inf", "99999999999999999999"}) {
    const auto site = parse_site(
        std::string("[[target]]\ngrating_mm = [0.0, 0.0]\ngrating_size_mm = [4.0, 4.0]\npitch_mm = ") + number,
        "s.toml");
    ASSERT_FALSE(site) << number;
    // toml11 4 refuses a number beyond its range before the key is known, at the end of the number.
    const std::string& error = site.error().front();
    const bool is_beyond_range = std::string_view(number).find('9') != std::string_view::npos;
    const std::string end = "s.toml:4:" + std::to_string(12 + std::strlen(number));
    EXPECT_TRUE(error == "s.toml:4:12: pitch_mm must be a finite number" ||
                (is_beyond_range && error == end + ": the value must be a finite number"))
        << error;
  }
}

TEST(SiteFile, AMistakeIsOneLineWhateverTheKeyHolds) {
  const auto site = parse_site(
      "\"a\\nb\\u001b\" = 1\n[[target]]\ngrating_mm = [0.0, 0.0]\ngrating_size_mm = [4.0, 4.0]\npitch_mm = 1.0\n",
      "s.toml");
  ASSERT_FALSE(site);
  EXPECT_EQ(site.error(), std::vector<std::string>{"s.toml:1:16: the key \"a?b?\" is unknown"});
}

}  // namespace
}  // namespace moiregauge::internal
