// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/help/completion.h"

#include <string>

#include <gtest/gtest.h>

namespace moiregauge::internal::cli {
namespace {

struct Tree {
  CLI::App app{"a program"};
  std::string word;
  CLI::Option* add(const std::string& names, const std::string& type) {
    return app.add_option(names, word, "of [x]: 'it'")->type_name(type);
  }
};

TEST(Completion, ATypeNameDeterminesThePossibleValues) {
  Tree tree;
  EXPECT_TRUE(value_words(*tree.add("--site", "FILE")).files);
  EXPECT_TRUE(value_words(*tree.add("--out", "DIR")).folders);
  EXPECT_EQ(value_words(*tree.add("--axes", "print|image")).words, (std::vector<std::string>{"print", "image"}));
  const ValueWords length = value_words(*tree.add("--pitch", "LENGTH"));
  EXPECT_FALSE(length.files || length.folders || !length.words.empty());
}

TEST(Completion, SpecialCharactersOfZshAreQuoted) {
  Tree tree;
  CLI::App* command = tree.app.add_subcommand("go", "now");
  command->add_option("--it", tree.word, "of [x]: 'it'")->type_name("FILE");
  EXPECT_NE(zsh_completion(tree.app).find(R"('*--it[of \[x\]\: '\''it'\'']:FILE:_files')"), std::string::npos)
      << zsh_completion(tree.app);
}

}  // namespace
}  // namespace moiregauge::internal::cli
