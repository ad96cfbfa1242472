// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal {

struct OutputError {
  bool usage = false;   // the place is somebody else's: exit 2, not 6
  std::string message;  // "what: where: what to do"
};

}  // namespace moiregauge::internal
