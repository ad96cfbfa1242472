// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>

#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/answers/routes.h"
#include "moiregauge/server/api/json_body.h"

namespace moiregauge::internal {
namespace {

// A report contains its own script. In a sandbox it has an origin of its own, so it cannot read this page's token.
constexpr const char* kReportPolicy =
    "sandbox allow-scripts allow-downloads allow-popups; default-src 'none'; script-src 'unsafe-inline'; style-src "
    "'unsafe-inline'; img-src data: blob:; font-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::shared_ptr<AnswerFile> plain_file(const ServerState& state, std::string_view path) {
  auto file = state.folder.open_file(path, O_RDONLY);
  struct stat facts {};
  if (!file || ::fstat(file->get(), &facts) != 0 || !S_ISREG(facts.st_mode)) return nullptr;
  return std::make_shared<AnswerFile>(file->release(), facts.st_size);
}

// Returns letters, digits and ._- of a name, because the header has no encoding.
std::string header_name(std::string_view path) {
  std::string name = std::filesystem::path(path).filename().string();
  for (char& c : name) {
    const bool is_plain =
        (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-' || c == '_';
    if (!is_plain) c = '_';
  }
  return name;
}

std::string asked_path(const RequestHead& head) {
  const std::string_view run = head.parameter("run"), name = head.parameter("name");
  if (run.empty()) return std::string(head.parameter("path"));
  return fmt::format("{}/{}", run, name);
}

}  // namespace

Answer answer_file(ServerState& state, const Request& request) {
  const std::string path = asked_path(request.head);
  auto file = plain_file(state, path);
  if (!file) return no_such_path();
  Answer answer;
  answer.type = "application/octet-stream";
  answer.headers = {{"Content-Disposition", fmt::format("attachment; filename=\"{}\"", header_name(path))},
                    {"Content-Security-Policy", "default-src 'none'; sandbox"}};
  answer.file = std::move(file);
  return answer;
}

Answer answer_ticket(ServerState& state, const Request& request) {
  const auto json = parse_json_body(request.body);
  if (!json) return error_answer(400, json.error());
  const bool has_names = json->size() == 2 && json->contains("run") && json->contains("name") &&
                         (*json)["run"].is_string() && (*json)["name"] == "report.html";
  if (!has_names) return error_answer(400, "the body is incomplete: the request: send run, and the name report.html");
  const std::string path = (*json)["run"].get<std::string>() + "/report.html";
  if (!plain_file(state, path)) return no_such_path();
  return json_text_answer(200, json_answer_text({{"url", "/report/" + state.tickets.add(path)}}));
}

Answer answer_report(ServerState& state, const Request& request) {
  const auto path = state.tickets.path_of(segment_of("/report/*", request.head.path));
  auto file = path ? plain_file(state, *path) : nullptr;
  if (!file) return error_answer(404, "the address has expired: the report: open it again from the page");
  Answer answer;
  answer.type = "text/html; charset=utf-8";
  answer.headers = {{"Content-Security-Policy", kReportPolicy}};
  answer.file = std::move(file);
  return answer;
}

}  // namespace moiregauge::internal
