// SPDX-License-Identifier: Apache-2.0
// Reads the head of an HTTP/1.1 request strictly (RFC 9112). Two readers of one message can then never disagree about
// its end, which is how requests are smuggled.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "moiregauge/server/http/request.h"

namespace moiregauge::internal {

inline constexpr std::size_t kMaxHead = 16384;  // bytes
inline constexpr std::size_t kMaxHeaders = 64;
inline constexpr std::size_t kMaxTarget = 8192;  // bytes

struct BadRequest {
  int status = 400;
  std::string message;
};

// Returns the length of the head with its empty line. Returns 0 if the bytes hold no complete head.
[[nodiscard]] std::size_t head_length(std::string_view bytes);

// Reads a complete head. Refuses every form that a browser does not send. Examples are bare line ends, folded lines,
// spaces around names, repeated headers, chunked bodies, and targets that are not a path.
[[nodiscard]] tl::expected<RequestHead, BadRequest> parse_request_head(std::string_view bytes);

}  // namespace moiregauge::internal
