// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/report/page_scripts.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

std::string page() {
  return assembled_page("a <b> & c", {{"report", "application/json", for_script(R"({"input": "</script>"})")},
                                      {"run", "application/json", "{}"},
                                      {"samples", "text/plain", "AAAA"},
                                      {"overlay", "text/plain", ""}});
}

TEST(PageScripts, AScriptIsAddedOnceAndThenReplaced) {
  const std::string before = page();
  const auto once = page_with(before, {"derived", "application/json", R"({"one sag": 1})"});
  ASSERT_TRUE(once);
  const auto twice = page_with(*once, {"derived", "application/json", R"({"two": 2})"});
  ASSERT_TRUE(twice);
  EXPECT_NE(once->find("one sag"), std::string::npos);
  EXPECT_EQ(twice->find("one sag"), std::string::npos);
  const std::string added = "\n<script type=\"application/json\" id=\"derived\">{\"two\": 2}</script>";
  const std::size_t at = twice->find(added);
  ASSERT_NE(at, std::string::npos);
  // All other bytes are those of the page before.
  EXPECT_EQ(twice->substr(0, at) + twice->substr(at + added.size()), before);
}

TEST(PageScripts, AnotherFileIsNoReport) {
  EXPECT_FALSE(page_with("<html><title>x</title></html>", {"derived", "application/json", "{}"}));
  const std::string whole = page();
  EXPECT_FALSE(page_with(whole.substr(0, whole.find("id=\"samples\"")), {"derived", "application/json", "{}"}));
}

TEST(PageScripts, ATitleThatIsNoUtf8IsEscaped) {
  EXPECT_NE(assembled_page("na\xffme", {}).find("<title>na\\xffme"), std::string::npos);
}

TEST(PageScripts, EveryStatusHasItsOwnNumber) {
  for (std::size_t k = 0; k < page_statuses().size(); ++k)
    EXPECT_EQ(status_code(page_statuses()[k]), static_cast<double>(k));
}

}  // namespace
}  // namespace moiregauge::internal
