// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "moiregauge/live/publisher.h"

namespace moiregauge::internal {

// Facts about a live run that do not follow from its observations.
struct LiveFacts {
  std::string source;     // SOURCE as typed
  std::string end;        // "stopped", "finished", "source lost", "running" (a segment of a run that continued)
  std::string begin_utc;  // start of this process
  long resumed_at = -1;   // first frame number of this process, if it continues a run; -1: it does not
  std::vector<std::pair<std::string, std::string>> settings;
  LiveHealth health;
  struct Outlet {
    std::string name, state;
    long lost_rows = 0;
  };
  std::vector<Outlet> outlets;
};

// Returns live.json (docs/file-formats.md).
[[nodiscard]] std::string live_json(const LiveFacts& facts);

}  // namespace moiregauge::internal
