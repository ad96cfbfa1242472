// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/control_characters.h"

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

TEST(ControlCharacters, PlainTextOfAnyLanguageStaysAsItIs) {
  for (const char* text : {"", "tower 1", "Brücke", "橋脚", "+\xf0\x9f\x8c\x89", "two\nlines\tand a tab"}) {
    EXPECT_EQ(with_controls_escaped(text), text);
  }
  EXPECT_FALSE(has_control_character("Brücke 橋脚 \xf0\x9f\x8c\x89"));
}

TEST(ControlCharacters, NoTerminalControlRemains) {
  EXPECT_EQ(with_controls_escaped("a\x1b[31mb\r\x7f"), "a\\u001b[31mb\\u000d\\u007f");
  EXPECT_EQ(with_controls_escaped("\xc2\x9b\xc2\x85"), "\\u009b\\u0085") << "C1 in UTF-8";
  EXPECT_EQ(with_controls_escaped("\xe2\x80\xae"
                                  "fdp"),
            "\\u202efdp")
      << "right to left";
  EXPECT_EQ(with_controls_escaped("\xe2\x81\xa6"), "\\u2066");
  for (const char* text : {"\x1b", "\n", "\xc2\x9b", "\xe2\x80\xae", "\xd8\x9c"})
    EXPECT_TRUE(has_control_character(text));
}

TEST(ControlCharacters, BytesThatAreNoUtf8AreShownAsNumbers) {
  EXPECT_EQ(with_controls_escaped("\x9b"
                                  "31m"),
            "\\x9b31m")
      << "C1 of an 8-bit terminal";
  EXPECT_EQ(with_controls_escaped("\xc0\x9b"), "\\xc0\\x9b") << "too long for its code";
  EXPECT_EQ(with_controls_escaped("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a pair";
  EXPECT_EQ(with_controls_escaped("\xe2\x80"), "\\xe2\\x80") << "cut";
  EXPECT_TRUE(has_control_character("\xff"));
}

}  // namespace
}  // namespace moiregauge::internal
