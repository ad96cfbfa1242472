// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace moiregauge::internal {

struct UsageError {
  std::string message;  // several lines for a site file with several mistakes
};
[[nodiscard]] inline tl::unexpected<UsageError> usage(std::string message) {
  return tl::unexpected(UsageError{std::move(message)});
}

}  // namespace moiregauge::internal
