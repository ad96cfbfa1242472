// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace moiregauge::internal {

struct OutputError {
  bool usage = false;   // the path is not free for a run: exit 2 instead of 6
  std::string message;  // "what happened: where: what to do"
};

}  // namespace moiregauge::internal
