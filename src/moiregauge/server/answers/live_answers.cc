// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/answers/routes.h"
#include "moiregauge/server/api/job_request.h"
#include "moiregauge/server/api/json_body.h"

namespace moiregauge::internal {
namespace {

constexpr std::chrono::seconds kMaxSearch(15);  // for cameras

// Reads a line of `live --list`: "camera:ID  model  (where)".
nlohmann::ordered_json camera_json(const std::string& line) {
  const auto end = line.find("  ");
  std::string source = line.substr(0, end);
  const auto name = end == std::string::npos ? end : line.find_first_not_of(' ', end);
  constexpr std::string_view kPrefix = "camera:";
  if (source.starts_with(kPrefix)) source.erase(0, kPrefix.size());
  return {{"id", source}, {"name", name == std::string::npos ? "" : line.substr(name)}};
}

long whole_in(const nlohmann::json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_number_integer() ? json[key].get<long>() : -1;
}

}  // namespace

Answer answer_cameras(ServerState& state, const Request&) {
  ChildRequest request;
  request.argv = {own_program(), "live", "--list"};
  request.folder = state.folder.root();
  request.max_time = kMaxSearch;
  request.reads_stdout = true;
  auto program = RunningProgram::start(request);
  if (!program) return error_answer(503, "the cameras cannot be searched: the server: try again");
  (void)program->wait(kMaxSearch);
  const std::string text = program->take_stdout();
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
    const std::string line = text.substr(at, end - at);
    if (line.starts_with("camera:")) list.push_back(camera_json(line));
  }
  return json_text_answer(200, json_answer_text({{"cameras", std::move(list)}}));
}

Answer answer_live(ServerState& state, const Request&) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Job& job : state.queue.jobs()) {
    if (job.command.action == "live" && !job.has_ended())
      list.push_back({{"id", job.id}, {"source", job.command.input}, {"command", command_line(job.command)}});
  }
  return json_text_answer(200, json_answer_text({{"live", std::move(list)}}));
}

Answer answer_new_live(ServerState& state, const Request& request) {
  return added_job_answer(state, parse_json_body(request.body).and_then(live_body));
}

Answer answer_stop_live(ServerState& state, const Request& request) {
  if (!state.queue.cancel(segment_of("/api/live/*/stop", request.head.path)))
    return error_answer(404, "the live source is unknown: the request: reload the page");
  return json_text_answer(200, "{}\n");
}

Answer answer_live_frame(ServerState& state, const Request& request) {
  const auto job = state.queue.job(request.head.parameter("id"));
  if (!job || job->command.action != "live")
    return error_answer(404, "the live source is unknown: the request: reload the page");
  std::ifstream in(state.queue.preview_path(*job), std::ios::binary);
  Answer answer;
  answer.type = "image/jpeg";
  answer.body.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  if (answer.body.empty()) return error_answer(404, "there is no picture: the live source: wait for its first frame");
  const auto line = nlohmann::json::parse(job->live_line, nullptr, false);
  answer.headers = {{"X-Frame", std::to_string(std::max(0L, whole_in(line, "frame")))}};
  return answer;
}

}  // namespace moiregauge::internal
