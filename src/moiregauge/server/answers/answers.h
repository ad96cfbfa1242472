// SPDX-License-Identifier: Apache-2.0
// The answers of the server, one function for each address (docs/cli/serve.md).
#pragma once

#include "moiregauge/server/api/job_request.h"
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

// Commands.
// Adds a command to the queue. Returns its id and command line.
[[nodiscard]] Answer added_job_answer(ServerState& state, const tl::expected<JobBody, std::string>& body);
[[nodiscard]] Answer answer_jobs(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_new_job(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_cancel(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_resume(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_events(ServerState& state, const Request& request);

// Cameras.
[[nodiscard]] Answer answer_cameras(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_live(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_new_live(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_stop_live(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_live_frame(ServerState& state, const Request& request);

// Runs.
[[nodiscard]] Answer answer_run(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_series(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_run_frame(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_run_markers(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_file(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_batch(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_ticket(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_report(ServerState& state, const Request& request);

// Uploads.
[[nodiscard]] Answer answer_received(ServerState& state, const Request& request);
[[nodiscard]] Answer answer_upload(ServerState& state, const Request& request);

}  // namespace moiregauge::internal
