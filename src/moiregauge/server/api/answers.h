// SPDX-License-Identifier: Apache-2.0
// The answers of the server, one function for each address (docs/cli/serve.md).
#pragma once

#include "moiregauge/server/api/server_state.h"

namespace moiregauge::internal {

// The page and its parts.
[[nodiscard]] Answer answer_page(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_script(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_style(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_session(ServerState& state, const Request& request);

// The folder.
[[nodiscard]] Answer answer_entries(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_thumbnail(ServerState& state, const Request& request);

// One frame.
[[nodiscard]] Answer answer_frame(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_inspect(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_site(ServerState& state, const Request& request);

}  // namespace moiregauge::internal
