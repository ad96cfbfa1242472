// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/request_head.h"

#include <string>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

const std::string kHost = "Host: 127.0.0.1:1\r\n";

int status_of(const std::string& bytes) {
  const auto head = parse_request_head(bytes);
  return head ? 200 : head.error().status;
}

TEST(RequestHead, TheAddressAndItsParametersAreDecodedOnce) {
  const auto head = parse_request_head("GET /api/frame?path=a%20b%2Bc&x=1+2&y= HTTP/1.1\r\n" + kHost + "\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->path, "/api/frame");
  EXPECT_EQ(head->parameter("path"), "a b+c");
  EXPECT_EQ(head->parameter("x"), "1 2");
  EXPECT_EQ(head->parameter("y"), "");
  const auto twice = parse_request_head("GET /%252e HTTP/1.1\r\n" + kHost + "\r\n");
  ASSERT_TRUE(twice);
  EXPECT_EQ(twice->path, "/%2e");
}

TEST(RequestHead, AMessageWhoseEndIsAmbiguousIsRefused) {
  const std::string post = "POST / HTTP/1.1\r\n" + kHost;
  EXPECT_EQ(status_of(post + "Content-Length: 2\r\n\r\n"), 200);
  EXPECT_EQ(status_of(post + "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n"), 501);
  EXPECT_EQ(status_of(post + "Content-Length: 2\r\nContent-Length: 2\r\n\r\n"), 400);
  EXPECT_EQ(status_of(post + "Content-Length: +2\r\n\r\n"), 400);
  EXPECT_EQ(status_of(post + "Content-Length : 2\r\n\r\n"), 400);
  EXPECT_EQ(status_of(post + "X: a\r\n b: c\r\nContent-Length: 2\r\n\r\n"), 400);
  EXPECT_EQ(status_of(post + "X: a\nContent-Length: 2\r\n\r\n"), 400);
  EXPECT_EQ(status_of(post + "\r\n"), 411);
}

TEST(RequestHead, NamesAreNotCaseSensitiveAndValuesAreTrimmed) {
  const auto head = parse_request_head("GET / HTTP/1.1\r\nhOsT:\t a \r\nCONNECTION: Close\r\n\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->header("host"), "a");
  EXPECT_FALSE(head->can_stay_open);
}

TEST(RequestHead, BytesThatAreNotUtf8AreRefused) {
  for (const char* path : {"%ff", "%c0%ae", "%ed%a0%80", "%f4%90%80%80", "%e0%80%af", "%00", "%4", "%zz"})
    EXPECT_EQ(status_of(std::string("GET /") + path + " HTTP/1.1\r\n" + kHost + "\r\n"), 400) << path;
  EXPECT_EQ(status_of("GET /%e2%82%ac HTTP/1.1\r\n" + kHost + "\r\n"), 200);
}

TEST(JsonString, NoMarkupAndNoBrokenTextLeavesAsItIs) {
  EXPECT_EQ(json_string("a\"<b>\n"), "\"a\\u0022\\u003cb\\u003e\\u000a\"");
  EXPECT_EQ(json_string("\xff"), "\"?\"");
}

}  // namespace
}  // namespace moiregauge::internal
