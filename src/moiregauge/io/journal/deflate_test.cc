// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/deflate.h"

#include <gtest/gtest.h>

#include "moiregauge/io/journal/stored_bytes.h"

namespace moiregauge::internal {
namespace {

TEST(Deflate, RestoresTheBytes) {
  for (const std::string& bytes :
       {std::string(), std::string("a"), std::string(5000, '\0'), std::string("\x00\xff\x01", 3)})
    EXPECT_EQ(inflated(deflated(bytes)), bytes);
}

TEST(Deflate, RefusesBytesThatItDidNotMake) {
  const std::string whole = deflated("three frames of a print, three frames of a print");
  for (std::size_t size = 0; size < whole.size(); ++size) ASSERT_FALSE(inflated(whole.substr(0, size))) << size;
  EXPECT_FALSE(inflated(whole + "x"));
}

// False lengths must not allocate memory: above the limit, or more than so few bytes can expand to.
TEST(Deflate, RefusesAFalseLength) {
  const std::string whole = deflated("three frames");
  for (const std::size_t length : {std::size_t{1}, std::size_t{13}, kMaxInflated, std::size_t{0xffffffff}}) {
    std::string bytes;
    append_little_endian(bytes, length, 4);
    EXPECT_FALSE(inflated(bytes + whole.substr(4))) << length;
  }
}

}  // namespace
}  // namespace moiregauge::internal
