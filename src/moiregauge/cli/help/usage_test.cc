// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/usage.h"

#include <string>

#include <gtest/gtest.h>

#include "moiregauge/cli/commands.h"

namespace moiregauge::internal::cli {
namespace {

// Returns the message on a command line that the parser must refuse.
std::string error_for(const std::string& words) {
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
  EXPECT_EQ(error_for("mesure clip.mp4"), "the command is unknown: mesure: did you mean moiregauge measure?");
  EXPECT_EQ(error_for("measure clip.mp4 --pich 10mm"), "the option is unknown: measure --pich: did you mean --pitch?");
  EXPECT_EQ(error_for("measure clip.mp4 -pitch 10mm"), "the option is unknown: measure -pitch: did you mean --pitch?");
  EXPECT_EQ(error_for("solve run --cammera=x.toml"), "the option is unknown: solve --cammera: did you mean --camera?");
}

TEST(UsageMistake, WithoutANearWordItNamesTheHelp) {
  EXPECT_EQ(error_for("frobnicate"), "the command is unknown: frobnicate: list the commands with moiregauge -h");
  EXPECT_EQ(error_for("measure x --frobnicate"),
            "the option is unknown: measure --frobnicate: list the options with moiregauge measure -h");
}

TEST(UsageMistake, AMissingArgumentIsShownAtItsPosition) {
  EXPECT_EQ(
      error_for("calibrate a.png"),
      "an argument is missing: calibrate (--pitch is required): write moiregauge calibrate PHOTOS --pitch LENGTH");
  EXPECT_EQ(error_for("measure --pitch 10mm"),
            "an argument is missing: measure (INPUT is required): write moiregauge measure INPUT");
}

// The unknown option is the mistake, even if its value was parsed as the input.
TEST(UsageMistake, ReportsTheUnknownOptionBeforeAMissingArgument) {
  EXPECT_EQ(error_for("measure --pich=10mm"), "the option is unknown: measure --pich: did you mean --pitch?");
}

TEST(UsageMistake, AnOptionBeforeTheCommandIsReported) {
  EXPECT_EQ(
      error_for("--quiet measure x"),
      "the option comes before its command: --quiet: put it after the command (moiregauge measure -h lists them)");
}

TEST(UsageMistake, ANumberMustBeValid) {
  EXPECT_EQ(
      error_for("measure x --fps fast"),
      "the value is not a usable number: measure --fps = fast: give a number (moiregauge measure -h explains it)");
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
