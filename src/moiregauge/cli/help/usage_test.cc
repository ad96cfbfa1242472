// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/usage.h"

#include <string>

#include <gtest/gtest.h>

#include "moiregauge/cli/commands.h"

namespace moiregauge::internal::cli {
namespace {

// Returns the message on a command line that the parser must refuse.
std::string told(const std::string& words) {
  int exit_code = 0;
  const auto tree = command_tree(exit_code);
  try {
    tree->parse(words, false);
  } catch (const CLI::ParseError& error) {
    return usage_mistake(*tree, error);
  }
  return "understood";
}

TEST(UsageMistake, NamesTheNearestWord) {
  EXPECT_EQ(told("mesure clip.mp4"), "unknown command: mesure: did you mean moiregauge measure?");
  EXPECT_EQ(told("measure clip.mp4 --pich 10mm"), "unknown option: measure --pich: did you mean --pitch?");
  EXPECT_EQ(told("measure clip.mp4 -pitch 10mm"), "unknown option: measure -pitch: did you mean --pitch?");
  EXPECT_EQ(told("solve run --cammera=x.toml"), "unknown option: solve --cammera: did you mean --camera?");
}

TEST(UsageMistake, WithoutANearWordItNamesTheHelp) {
  EXPECT_EQ(told("frobnicate"), "unknown command: frobnicate: moiregauge -h lists the commands");
  EXPECT_EQ(told("measure x --frobnicate"),
            "unknown option: measure --frobnicate: moiregauge measure -h lists the options");
}

TEST(UsageMistake, AMissingArgumentIsShownAtItsPosition) {
  EXPECT_EQ(told("calibrate a.png"),
            "something is missing: calibrate: --pitch is required: write moiregauge calibrate PHOTOS --pitch LENGTH");
  EXPECT_EQ(told("measure --pitch 10mm"),
            "something is missing: measure: INPUT is required: write moiregauge measure INPUT");
}

// The unknown option is the mistake, even if its value was parsed as the input.
TEST(UsageMistake, ReportsTheUnknownOptionBeforeAMissingArgument) {
  EXPECT_EQ(told("measure --pich=10mm"), "unknown option: measure --pich: did you mean --pitch?");
}

TEST(UsageMistake, AnOptionBeforeTheCommandIsReported) {
  EXPECT_EQ(told("--quiet measure x"),
            "unknown option: --quiet: it goes behind its command: moiregauge measure -h lists a command's options");
}

TEST(UsageMistake, ANumberMustBeValid) {
  EXPECT_EQ(told("measure x --fps fast"),
            "not a number to use: measure --fps = fast: moiregauge measure -h says what it takes");
}

TEST(FirstText, ShowsExistingCommandsOnly) {
  int exit_code = 0;
  const auto tree = command_tree(exit_code);
  const std::string words = first_text(*tree);
  EXPECT_NE(words.find("moiregauge measure clip.mp4 --pitch 10mm"), std::string::npos);
  for (std::size_t at = words.find("  moiregauge "); at != std::string::npos;
       at = words.find("  moiregauge ", at + 1)) {
    const std::string command = words.substr(at + 13, words.find(' ', at + 13) - at - 13);
    EXPECT_NO_THROW(static_cast<void>(tree->get_subcommand(command))) << command;
  }
}

}  // namespace
}  // namespace moiregauge::internal::cli
