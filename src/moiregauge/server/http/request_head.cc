// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/request_head.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace moiregauge::internal {
namespace {

using Parse = tl::expected<void, BadRequest>;

tl::unexpected<BadRequest> refused(int status, std::string message) {
  return tl::unexpected(BadRequest{status, std::move(message)});
}

bool is_token_character(char c) {
  if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')) return true;
  return std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

bool is_token(std::string_view text) { return !text.empty() && std::ranges::all_of(text, is_token_character); }

// Visible ASCII, spaces and tabs, and the bytes of other encodings.
bool is_value_character(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte >= 0x20 && byte != 0x7F) || c == '\t';
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return out;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Removes a line from the bytes. A carriage return or line feed of its own is no line end.
std::optional<std::string_view> take_line(std::string_view& bytes) {
  const auto end = bytes.find("\r\n");
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = bytes.substr(0, end);
  bytes.remove_prefix(end + 2);
  if (line.find_first_of("\r\n") != std::string_view::npos) return std::nullopt;
  return line;
}

Parse read_method(std::string_view word, RequestHead& head) {
  if (word == "GET")
    head.method = HttpMethod::kGet;
  else if (word == "POST")
    head.method = HttpMethod::kPost;
  else if (is_token(word))
    return refused(405, "the method is not served: the request: use GET or POST");
  else
    return refused(400, "the method is not a word: the request: use GET or POST");
  return {};
}

Parse read_target(std::string_view target, RequestHead& head) {
  if (target.size() > kMaxTarget) return refused(414, "the address is too long: the request: shorten it");
  const bool is_plain = std::ranges::all_of(target, [](char c) { return c > 0x20 && c < 0x7F && c != '#'; });
  if (target.empty() || target.front() != '/' || !is_plain)
    return refused(400, "the address is not a path: the request: begin it with /");
  const std::size_t question = std::min(target.find('?'), target.size());
  auto path = percent_decoded(target.substr(0, question), PlusSign::kLiteral);
  auto parameters = query_parameters(target.substr(std::min(question + 1, target.size())));
  if (!path || !parameters)
    return refused(400, "the address cannot be decoded: the request: encode it as UTF-8, each name once");
  head.path = *std::move(path);
  head.parameters = *std::move(parameters);
  return {};
}

Parse read_request_line(std::string_view line, RequestHead& head) {
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || first == last)
    return refused(400, "the first line is incomplete: the request: send METHOD PATH HTTP/1.1");
  const std::string_view version = line.substr(last + 1);
  if (version != "HTTP/1.1") {
    if (version.starts_with("HTTP/")) return refused(505, "the version is not served: the request: use HTTP/1.1");
    return refused(400, "the version is missing: the request: use HTTP/1.1");
  }
  return read_method(line.substr(0, first), head).and_then([&] {
    return read_target(line.substr(first + 1, last - first - 1), head);
  });
}

Parse read_header(std::string_view line, RequestHead& head) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon)))
    return refused(400, "a header has no valid name: the request: send NAME: VALUE");
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (!std::ranges::all_of(value, is_value_character))
    return refused(400, "a header contains a control character: the request: remove it");
  std::string name = lower_case(line.substr(0, colon));
  if (std::ranges::find(head.headers, name, &Parameters::value_type::first) != head.headers.end())
    return refused(400, "a header is repeated: the request: send each once");
  if (head.headers.size() == kMaxHeaders) return refused(431, "there are too many headers: the request: send up to 64");
  head.headers.emplace_back(std::move(name), value);
  return {};
}

Parse read_length(RequestHead& head) {
  const auto has = [&](std::string_view name) {
    return std::ranges::find(head.headers, name, &Parameters::value_type::first) != head.headers.end();
  };
  if (has("transfer-encoding"))
    return refused(501, "the body has a transfer encoding: the request: send it with Content-Length");
  if (!has("content-length")) {
    if (head.method == HttpMethod::kPost)
      return refused(411, "the length is missing: the request: send Content-Length");
    return {};
  }
  const std::string_view text = head.header("content-length");
  const bool is_digits = std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  if (text.empty() || text.size() > 15 || !is_digits)
    return refused(400, "the length is not a number: the request: correct Content-Length");
  std::from_chars(text.data(), text.data() + text.size(), head.content_length);
  if (head.method == HttpMethod::kGet && head.content_length > 0)
    return refused(400, "a GET has a body: the request: remove it");
  return {};
}

Parse read_connection(RequestHead& head) {
  head.can_stay_open = lower_case(head.header("connection")).find("close") == std::string::npos;
  const std::string expected = lower_case(head.header("expect"));
  if (!expected.empty() && expected != "100-continue")
    return refused(417, "the expectation is unknown: the request: remove Expect");
  head.expects_continue = !expected.empty();
  if (head.header("host").empty()) return refused(400, "the host is missing: the request: send Host");
  return {};
}

}  // namespace

std::size_t head_length(std::string_view bytes) {
  const auto end = bytes.find("\r\n\r\n");
  return end == std::string_view::npos ? 0 : end + 4;
}

tl::expected<RequestHead, BadRequest> parse_request_head(std::string_view bytes) {
  RequestHead head;
  if (bytes.size() > kMaxHead) return refused(431, "the head is too long: the request: send up to 16 kB");
  const auto first = take_line(bytes);
  if (!first) return refused(400, "a line end is malformed: the request: end lines with CR LF");
  if (const auto read = read_request_line(*first, head); !read) return tl::unexpected(read.error());
  while (true) {
    const auto line = take_line(bytes);
    if (!line) return refused(400, "a line end is malformed: the request: end lines with CR LF");
    if (line->empty()) break;
    if (const auto read = read_header(*line, head); !read) return tl::unexpected(read.error());
  }
  if (!bytes.empty()) return refused(400, "bytes follow the head: the request: end it with an empty line");
  const auto checked = read_length(head).and_then([&] { return read_connection(head); });
  if (!checked) return tl::unexpected(checked.error());
  return head;
}

}  // namespace moiregauge::internal
