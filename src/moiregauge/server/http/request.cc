// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/request.h"

#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

std::string_view value_of(const Parameters& pairs, std::string_view name) {
  const auto found = std::ranges::find(pairs, name, &Parameters::value_type::first);
  return found == pairs.end() ? std::string_view{} : found->second;
}

struct Reason {
  int status;
  const char* text;
};
constexpr Reason kReasons[] = {{200, "OK"},
                               {400, "Bad Request"},
                               {403, "Forbidden"},
                               {404, "Not Found"},
                               {405, "Method Not Allowed"},
                               {408, "Request Timeout"},
                               {409, "Conflict"},
                               {411, "Length Required"},
                               {413, "Content Too Large"},
                               {414, "URI Too Long"},
                               {415, "Unsupported Media Type"},
                               {417, "Expectation Failed"},
                               {422, "Unprocessable Content"},
                               {429, "Too Many Requests"},
                               {431, "Request Header Fields Too Large"},
                               {500, "Internal Server Error"},
                               {501, "Not Implemented"},
                               {503, "Service Unavailable"},
                               {505, "HTTP Version Not Supported"},
                               {507, "Insufficient Storage"}};

const char* reason_of(int status) {
  const auto* found = std::ranges::find(kReasons, status, &Reason::status);
  return found == std::end(kReasons) ? "Unknown" : found->text;
}

}  // namespace

std::string_view RequestHead::header(std::string_view name) const { return value_of(headers, name); }
std::string_view RequestHead::parameter(std::string_view name) const { return value_of(parameters, name); }

AnswerFile::~AnswerFile() { ::close(file_); }

bool AnswerFile::read(std::int64_t offset, std::size_t most, std::string& out) const {
  const std::size_t before = out.size();
  const auto wanted = std::min<std::int64_t>(static_cast<std::int64_t>(most), size_ - offset);
  out.resize(before + static_cast<std::size_t>(std::max<std::int64_t>(wanted, 0)));
  const ssize_t got = ::pread(file_, out.data() + before, out.size() - before, offset);
  out.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return got > 0 || wanted <= 0;
}

std::string json_string(std::string_view text) {
  if (!is_utf8(text)) {
    std::string ascii(text);
    std::ranges::replace_if(
        ascii, [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
    return json_string(ascii);
  }
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '<' || c == '>' || c == '&' || static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + "\"";
}

Answer error_answer(int status, std::string_view message) {
  return {status, "application/json", {}, fmt::format("{{\"error\":{}}}\n", json_string(message)), nullptr, false};
}

std::string answer_head(const Answer& answer, std::int64_t length, bool stays_open) {
  std::string head = fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nX-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: "
      "same-origin\r\nReferrer-Policy: no-referrer\r\nConnection: {}\r\n",
      answer.status, reason_of(answer.status), answer.type, stays_open ? "keep-alive" : "close");
  bool is_cache_stated = false;
  for (const auto& [name, value] : answer.headers) {
    head += fmt::format("{}: {}\r\n", name, value);
    is_cache_stated = is_cache_stated || name == "Cache-Control";
  }
  if (!is_cache_stated) head += "Cache-Control: no-store\r\n";
  if (length >= 0) head += fmt::format("Content-Length: {}\r\n", length);
  return head + "\r\n";
}

}  // namespace moiregauge::internal
