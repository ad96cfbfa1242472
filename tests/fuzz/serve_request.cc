// SPDX-License-Identifier: Apache-2.0
// Input: the head and the body of a request of `moiregauge serve`, divided by the first empty line.
// Requires: a decoded path is UTF-8 without NUL, and a body has one length. A command that a body starts names no path that the
// folder refuses, and no option outside the list. What a body inspects has the same options in its command line.
#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "moiregauge/server/api/inspect_request.h"
#include "moiregauge/server/api/job_request.h"
#include "moiregauge/server/api/json_body.h"
#include "moiregauge/server/folder/confined_folder.h"
#include "moiregauge/server/http/request_head.h"
#include "moiregauge/server/jobs/job.h"
#include "tests/fuzz/input_file.h"

namespace {

using namespace moiregauge::internal;

void check_head(const std::string& text) {
  const std::size_t length = head_length(text);
  const auto head = parse_request_head(text.substr(0, length));
  if (!head) {
    fuzz::demand(head.error().status >= 400 && !head.error().message.empty());
    return;
  }
  fuzz::demand(head->path.starts_with('/') && is_utf8(head->path) && head->path.find('\0') == std::string::npos);
  fuzz::demand(head->content_length >= 0 && head->header("transfer-encoding").empty() && !head->header("host").empty());
  for (const auto& [name, value] : head->parameters) fuzz::demand(is_utf8(name) && is_utf8(value));
}

void check_job(const tl::expected<JobBody, std::string>& body) {
  if (!body) return;
  const auto command = job_command(body->action, body->arguments, {is_relative_path, is_relative_path});
  if (!command) return;
  fuzz::demand(command->output.empty() || is_relative_path(command->output));
  fuzz::demand(is_relative_path(command->input) || is_live_address(command->input));
  for (const std::string& word : command->arguments)
    fuzz::demand(!word.empty() && word.find('\0') == std::string::npos);
  Job job;
  job.command = *command;
  fuzz::demand(nlohmann::json::accept(job_json(job)));
}

void check_body(const std::string& text) {
  const auto json = parse_json_body(text);
  if (!json) return;
  fuzz::demand(json->is_object());
  check_job(job_body(*json));
  check_job(live_body(*json));
  const auto inspected = inspect_body(*json);
  if (!inspected) return;
  fuzz::demand(!inspected->path.empty() && inspected->frame >= 0);
  const auto words = option_words(*inspected, "");
  fuzz::demand(words.size() % 2 == 0);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::text_of({data, size});
  check_head(text);
  check_body(text.substr(head_length(text)));
  fuzz::demand(nlohmann::json::accept(json_string(text)));
  (void)read_child_line(text);
  return 0;
}
