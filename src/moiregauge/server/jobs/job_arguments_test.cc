// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/jobs/job_arguments.h"

#include <gtest/gtest.h>

#include "moiregauge/server/jobs/job.h"

namespace moiregauge::internal {
namespace {

using Words = std::vector<std::string>;

const PathRules kPaths{
    [](std::string_view path) { return path == "a.mp4" || path == "sub/b c.mp4" || path == "run"; },
    [](std::string_view path) { return path.find("..") == std::string_view::npos && !path.starts_with('/'); }};

bool is_allowed(std::string_view action, const Words& words) { return job_command(action, words, kPaths).has_value(); }

TEST(JobArguments, OnlyListedOptionsWithPathsInTheFolderAreAllowed) {
  EXPECT_TRUE(is_allowed("measure", {"a.mp4", "--pitch", "10mm"}));
  EXPECT_TRUE(is_allowed("compare", {"run", "a.mp4", "--sign", "-1"}));
  EXPECT_FALSE(is_allowed("measure", {"a.mp4", "--pitch", "--help"}));
  EXPECT_FALSE(is_allowed("measure", {"a.mp4", "--out=/elsewhere/x"}));
  EXPECT_FALSE(is_allowed("measure", {"a.mp4", "-o", "../x"}));
  EXPECT_FALSE(is_allowed("measure", {"a.mp4", "--json"}));
  EXPECT_FALSE(is_allowed("measure", {"nowhere.mp4"}));
  EXPECT_FALSE(is_allowed("measure", {"a.mp4", "a.mp4"}));
  EXPECT_FALSE(is_allowed("measure", {"a.mp4", "--pitch", "10mm\n"}));
  EXPECT_FALSE(is_allowed("export", {"run", "-o", "a.mp4"}));
  EXPECT_FALSE(is_allowed("live", {"a.mp4", "--publish", "http://host/"}));
  EXPECT_FALSE(is_allowed("serve", {"a.mp4"}));
}

TEST(JobArguments, TheRunOfAClipIsNextToIt) {
  const auto top = job_command("measure", {"a.mp4", "--pitch", "10mm"}, kPaths);
  ASSERT_TRUE(top);
  EXPECT_EQ(top->output, "a-moiregauge");
  EXPECT_EQ(command_line(*top), "moiregauge measure a.mp4 --pitch 10mm");
  const auto nested = job_command("measure", {"sub/b c.mp4", "--pitch", "10mm"}, kPaths);
  ASSERT_TRUE(nested);
  EXPECT_EQ(command_line(*nested), "moiregauge measure 'sub/b c.mp4' --pitch 10mm -o 'sub/b c-moiregauge'");
}

TEST(JobArguments, AResumedRunDoesNotStartAgain) {
  const auto command = job_command("measure", {"a.mp4", "--pitch", "10mm", "--restart"}, kPaths);
  ASSERT_TRUE(command);
  EXPECT_EQ(command_line(*resumed(*command)), "moiregauge measure a.mp4 --pitch 10mm --resume");
}

TEST(ChildLine, WhatIsNoProgressIsAMessage) {
  EXPECT_EQ(read_child_line(R"({"type":"progress","stage":"solving","done":3,"expected":null})").done, 3);
  EXPECT_EQ(read_child_line(R"({"type":"note","text":"a \"b\""})").text, "a \"b\"");
  EXPECT_EQ(read_child_line(R"({"type":"samples","marker":{"T1":[[0,null]]}})").samples, R"({"T1":[[0,null]]})");
  EXPECT_EQ(read_child_line(R"({"type":"view","frame":7,"reference_from_frame":[1,0,2,0,1,3,0,0,1]})").view,
            "[1,0,2,0,1,3,0,0,1]");
  EXPECT_EQ(read_child_line(R"({"type":"view","frame":7,"reference_from_frame":null})").frame, 7);
  for (const char* line : {"", "error: a: b: c", R"({"type":"samples"})", R"({"type":)", R"({"type":"x"})",
                           R"({"type":"view","frame":7})", R"({"type":"view","reference_from_frame":[1,"<b>"]})"})
    EXPECT_EQ(read_child_line(line).kind, ChildLine::Kind::kMessage) << line;
}

}  // namespace
}  // namespace moiregauge::internal
