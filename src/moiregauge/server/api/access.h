// SPDX-License-Identifier: Apache-2.0
// Checks the sender of a request before anything of it is used.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "moiregauge/server/http/request.h"

namespace moiregauge::internal {

struct AccessRules {
  std::string scheme = "http";
  int port = 0;
  std::string token;
  // Beyond this computer: returns true if a certificate is issued for the host. Empty: only names of this computer.
  std::function<bool(const std::string& host)> is_issued_for;
};

// Returns the refusal of a request, or nothing. A page of another site can send requests to this server, and it can
// make its own name point here. So the Host must be this server's, the Origin must be this page, and addresses under
// /api need the token, which no other page knows.
[[nodiscard]] std::optional<Answer> access_refusal(const AccessRules& rules, const RequestHead& head);

// Returns true if two texts are equal. The time depends on the lengths alone.
[[nodiscard]] bool is_same_secret(std::string_view a, std::string_view b);

}  // namespace moiregauge::internal
