// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/answers/routes.h"
#include "moiregauge/server/api/job_request.h"
#include "moiregauge/server/api/json_body.h"

namespace moiregauge::internal {
namespace {

std::string id_json(const Job& job) {
  return fmt::format("{{\"id\":\"{}\",\"command\":{}}}\n", job.id, json_string(command_line(job.command)));
}

}  // namespace

Answer added_job_answer(ServerState& state, const tl::expected<JobBody, std::string>& body) {
  if (!body) return error_answer(400, body.error());
  auto command = job_command(body->action, body->arguments, state.path_rules());
  if (!command) return error_answer(422, command.error());
  const auto job = state.queue.add(*std::move(command));
  if (!job) return error_answer(409, job.error());
  return json_text_answer(200, id_json(*job));
}

Answer answer_jobs(ServerState& state, const Request&) {
  std::string list;
  for (const Job& job : state.queue.jobs()) list += (list.empty() ? "" : ",") + job_json(job);
  return json_text_answer(200, "{\"jobs\":[" + list + "]}\n");
}

Answer answer_new_job(ServerState& state, const Request& request) {
  return added_job_answer(state, parse_json_body(request.body).and_then(job_body));
}

Answer answer_cancel(ServerState& state, const Request& request) {
  const std::string_view id = segment_of("/api/jobs/*/cancel", request.head.path);
  if (!state.queue.cancel(id)) return error_answer(404, "the job is unknown: the request: reload the page");
  return json_text_answer(200, "{}\n");
}

Answer answer_resume(ServerState& state, const Request& request) {
  const auto job = state.queue.resume(segment_of("/api/jobs/*/resume", request.head.path));
  if (!job) return error_answer(409, job.error());
  return json_text_answer(200, id_json(*job));
}

Answer answer_events(ServerState&, const Request&) {
  Answer answer;
  answer.type = "text/event-stream";
  answer.is_event_stream = true;
  return answer;
}

}  // namespace moiregauge::internal
