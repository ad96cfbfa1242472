// SPDX-License-Identifier: Apache-2.0
// Everything that the answers of one server share.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "moiregauge/server/api/stored_runs.h"
#include "moiregauge/server/api/tickets.h"
#include "moiregauge/server/folder/confined_folder.h"
#include "moiregauge/server/folder/entries.h"
#include "moiregauge/server/folder/frame_store.h"
#include "moiregauge/server/folder/upload_folder.h"
#include "moiregauge/server/http/request.h"
#include "moiregauge/server/jobs/job_queue.h"

namespace moiregauge::internal {

struct ServerState {
  // `publish_event` receives events for all open pages. Called on any thread.
  ServerState(ConfinedFolder shown, std::function<void(std::string)> publish_event, int jobs_at_once);
  ConfinedFolder folder;
  std::string token;
  bool is_token_in_page = true;  // false beyond this computer: the user brings it
  std::int64_t max_upload = 0;   // bytes of one file
  FrameStore frames;
  EntryList entries;
  StoredRuns runs;
  Tickets tickets;
  UploadFolder uploads;
  std::function<void(std::string)> publish;
  JobQueue queue;  // last: its commands use all members above

  [[nodiscard]] PathRules path_rules() const;
  // Reports to all pages that the folder has changed.
  void publish_entries() const { publish(event_text("entries", "{}")); }
};

// Returns an answer in JSON.
[[nodiscard]] Answer json_text_answer(int status, std::string json);
// Returns a message without the absolute path of the folder, which the page does not know.
[[nodiscard]] std::string without_root(const ServerState& state, std::string_view message);
// Returns the answer to a path that is missing or outside the folder.
[[nodiscard]] Answer no_such_path();
// Returns a whole number of a parameter, or `otherwise` if it is missing. Fails (-1): no number from 0 to `highest`.
[[nodiscard]] long whole_parameter(const RequestHead& head, std::string_view name, long otherwise, long highest);

}  // namespace moiregauge::internal
