// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/page.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "moiregauge/cli/commands.h"
#include "moiregauge/cli/help/command_list.h"
#include "moiregauge/cli/help/markdown.h"

namespace moiregauge::internal::cli {
namespace {

std::set<std::string> options_of(const CLI::App& command) {
  std::set<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) continue;
    for (const std::string& name : option->get_lnames()) names.insert("--" + name);
    for (const std::string& name : option->get_snames()) names.insert("-" + name);
  }
  return names;
}

std::set<std::string> options_on(const Page& page) {
  const auto documented = documented_options(page.markdown);
  return {documented.begin(), documented.end()};
}

// Every command has -h and --help: only the program's page describes them.
TEST(Pages, DescribeExactlyTheExistingOptions) {
  int exit_code = 0;
  const auto tree = command_tree(exit_code);
  const Page* whole = page_named("moiregauge");
  ASSERT_NE(whole, nullptr);
  EXPECT_EQ(options_on(*whole), options_of(*tree));
  for (const CLI::App* command : visible_commands(*tree)) {
    const Page* page = page_named(command->get_name());
    ASSERT_NE(page, nullptr) << "docs/cli/" << command->get_name() << ".md is missing";
    auto has = options_of(*command);
    has.erase("-h");
    has.erase("--help");
    EXPECT_EQ(options_on(*page), has) << "docs/cli/" << page->name << ".md";
  }
}

TEST(Pages, EveryPageBelongsToACommandAndTheMainPageListsAll) {
  int exit_code = 0;
  const auto tree = command_tree(exit_code);
  const Page* whole = page_named("moiregauge");
  ASSERT_NE(whole, nullptr);
  std::set<std::string> names{"moiregauge"};
  for (const CLI::App* command : visible_commands(*tree)) {
    names.insert(command->get_name());
    EXPECT_NE(whole->markdown.find("(" + command->get_name() + ".md)"), std::string_view::npos) << command->get_name();
  }
  for (const Page& page : pages()) EXPECT_TRUE(names.contains(std::string(page.name))) << page.name;
}

TEST(Pages, TextFitsTheTerminalAndLosesNoWord) {
  const std::string text = text_of_markdown(R"(# moiregauge x

One two `three` four five six.

| option | meaning |
|---|---|
| `--long-word B` | **must** be [used](../y.md#z) a\|b |
| `-a` | one two three |

| code | |
|---|---|
| 0 | one two three four five |
)",
                                            20);
  EXPECT_EQ(text,
            "moiregauge x\n\n  One two three four\n  five six.\n\n  --long-word B\n        must be used\n"
            "        (docs/y.md)\n        a|b\n  -a    one two\n        three\n\n  0  one two three\n     four five\n");
}

TEST(Pages, DashesCanBeCopiedFromAManPageAndDotsAreEscaped) {
  const std::string man =
      man_of_markdown("# moiregauge x\n\n    moiregauge x --a\n\n.5 of `--a`\n\n## What it is\n\n- one\n", "x", "Do x");
  EXPECT_NE(man.find(".SH NAME\nmoiregauge\\-x \\- Do x\n.SH SYNOPSIS\n.nf\nmoiregauge x \\-\\-a\n.fi\n"),
            std::string::npos)
      << man;
  EXPECT_NE(man.find("\n\\&.5 of \\fB\\-\\-a\\fR\n"), std::string::npos) << man;
  EXPECT_NE(man.find(".SH WHAT IT IS\n.IP \\(bu 3\none\n"), std::string::npos) << man;
}

}  // namespace
}  // namespace moiregauge::internal::cli
