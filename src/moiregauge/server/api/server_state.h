// SPDX-License-Identifier: Apache-2.0
// Everything that the answers of one server share.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "moiregauge/server/folder/confined_folder.h"
#include "moiregauge/server/folder/entries.h"
#include "moiregauge/server/folder/frame_store.h"
#include "moiregauge/server/http/request.h"

namespace moiregauge::internal {

struct ServerState {
  explicit ServerState(ConfinedFolder shown) : folder(std::move(shown)), entries(folder.root()) {}
  ConfinedFolder folder;
  std::string token;
  bool is_token_in_page = true;  // false beyond this computer: the user brings it
  std::int64_t max_upload = 0;   // bytes
  FrameStore frames;
  EntryList entries;
};

// Returns a message without the absolute path of the folder, which the page does not know.
[[nodiscard]] std::string without_root(const ServerState& state, std::string_view message);
// Returns the answer to a path that is missing or outside the folder.
[[nodiscard]] Answer no_such_path();
// Returns a whole number of a parameter, or `otherwise` if it is missing. Fails (-1): no number from 0 to `highest`.
[[nodiscard]] long whole_parameter(const RequestHead& head, std::string_view name, long otherwise, long highest);

}  // namespace moiregauge::internal
