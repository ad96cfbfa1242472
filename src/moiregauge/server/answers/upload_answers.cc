// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cstdint>

#include <fmt/format.h>

#include "moiregauge/server/answers/answers.h"

namespace moiregauge::internal {
namespace {

// Returns a number of bytes, or -1.
std::int64_t byte_count(const RequestHead& head, std::string_view name) {
  const std::string_view text = head.parameter(name);
  std::int64_t value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value >= 0 ? value : -1;
}

Answer received_answer(const tl::expected<std::int64_t, UploadFailure>& received) {
  if (!received) return error_answer(received.error().status, received.error().message);
  return json_text_answer(200, fmt::format("{{\"received\":{}}}\n", *received));
}

Answer bad_size() {
  return error_answer(400, "the size or offset is no number: the upload: send name, offset and size");
}

Answer too_large(const ServerState& state) {
  return error_answer(
      413, fmt::format("the file is larger than {} bytes: the upload: start the server with a larger --max-upload",
                       state.max_upload));
}

}  // namespace

Answer answer_received(ServerState& state, const Request& request) {
  const std::int64_t size = byte_count(request.head, "size");
  if (size < 0) return bad_size();
  if (size > state.max_upload) return too_large(state);
  return received_answer(state.uploads.received(request.head.parameter("name"), size));
}

Answer answer_upload(ServerState& state, const Request& request) {
  const std::int64_t size = byte_count(request.head, "size"), offset = byte_count(request.head, "offset");
  if (size <= 0 || offset < 0 || offset >= size) return bad_size();
  if (size > state.max_upload) return too_large(state);
  const auto received = state.uploads.add(request.head.parameter("name"), offset, size, request.body);
  if (received == size) state.publish_entries();
  return received_answer(received);
}

}  // namespace moiregauge::internal
