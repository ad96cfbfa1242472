// SPDX-License-Identifier: Apache-2.0
// A request and its answer, as values.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "moiregauge/server/http/url_text.h"

namespace moiregauge::internal {

enum class HttpMethod { kGet, kPost };

struct RequestHead {
  HttpMethod method = HttpMethod::kGet;
  std::string path;                                          // decoded, begins with '/'
  Parameters parameters;                                     // decoded
  std::vector<std::pair<std::string, std::string>> headers;  // names in lower case, no name twice
  std::int64_t content_length = 0;                           // bytes
  bool can_stay_open = true;
  bool expects_continue = false;

  // Returns the value of a header or parameter, or an empty text.
  [[nodiscard]] std::string_view header(std::string_view name) const;
  [[nodiscard]] std::string_view parameter(std::string_view name) const;
};

struct Request {
  RequestHead head;
  std::string body;
};

// Bytes of a file that follow the head of an answer. It owns the descriptor.
class AnswerFile {
 public:
  AnswerFile(int file, std::int64_t size) : file_(file), size_(size) {}
  AnswerFile(const AnswerFile&) = delete;
  AnswerFile& operator=(const AnswerFile&) = delete;
  ~AnswerFile();
  [[nodiscard]] std::int64_t size() const { return size_; }
  // Appends up to `most` bytes from `offset` on. Returns false if the file has become shorter.
  [[nodiscard]] bool read(std::int64_t offset, std::size_t most, std::string& out) const;

 private:
  int file_;
  std::int64_t size_;
};

struct Answer {
  int status = 200;
  std::string type = "application/json";
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;
  std::shared_ptr<AnswerFile> file;  // replaces the body
  bool is_event_stream = false;      // the connection then receives every published event
};

// Returns an error as JSON: {"error": message}. Bytes that are not UTF-8 are replaced.
[[nodiscard]] Answer error_answer(int status, std::string_view message);
// Returns a text as a JSON string with its quotes. Also '<', '>' and '&' are escaped.
[[nodiscard]] std::string json_string(std::string_view text);
// Returns the head of an answer on the wire. A negative length: the body ends with the connection.
[[nodiscard]] std::string answer_head(const Answer& answer, std::int64_t length, bool stays_open);

}  // namespace moiregauge::internal
