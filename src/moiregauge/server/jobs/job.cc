// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/jobs/job.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

using JobJson = nlohmann::ordered_json;

constexpr std::size_t kMaxLines = 20;

std::string dumped(const JobJson& json) { return json.dump(-1, ' ', false, JobJson::error_handler_t::replace); }

long whole_number(const nlohmann::json& json, const char* key, long otherwise) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number_integer() ? found->get<long>() : otherwise;
}

bool is_matrix_or_null(const nlohmann::json& json) {
  return json.is_null() || (json.is_array() && json.size() == 9 &&
                            std::ranges::all_of(json, [](const nlohmann::json& value) { return value.is_number(); }));
}

}  // namespace

const char* word_for(JobState state) {
  constexpr std::array kWords = {"queued", "running", "done", "failed", "cancelled"};
  return kWords[static_cast<std::size_t>(state)];
}

void Job::add_line(std::string line) {
  lines.push_back(std::move(line));
  if (lines.size() > kMaxLines) lines.pop_front();
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    const bool is_plain = !word.empty() && std::ranges::all_of(word, [](char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
             std::string_view("_@%+=:,./-").find(c) != std::string_view::npos;
    });
    std::string quoted = word;
    if (!is_plain) {
      for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 4)
        quoted.replace(at, 1, "'\\''");
      quoted = fmt::format("'{}'", quoted);
    }
    line += fmt::format("{}{}", line.empty() ? "" : " ", quoted);
  }
  return line;
}

std::string command_line(const JobCommand& command) {
  std::vector<std::string> words{"moiregauge", command.action};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  return shell_line(words);
}

std::string job_json(const Job& job) {
  JobJson json{{"id", job.id},
               {"action", job.command.action},
               {"command", command_line(job.command)},
               {"state", word_for(job.state)}};
  json["exit_code"] = job.exit_code ? JobJson(*job.exit_code) : JobJson(nullptr);
  json["input"] = job.command.input;
  json["run"] = job.command.output;
  json["output"] = job.command.output;
  json["frames_done"] = job.frames_done;
  json["frames"] = job.frames;
  json["seconds"] = job.seconds;
  json["stage"] = job.stage;
  json["lines"] = job.lines;
  return dumped(json);
}

std::string preview_name(const Job& job) { return fmt::format(".moiregauge-preview-{}.jpg", job.id); }

std::string event_text(std::string_view name, std::string_view data) {
  return fmt::format("event: {}\ndata: {}\n\n", name, data);
}

ChildLine read_child_line(std::string_view line) {
  ChildLine out;
  out.text = line;
  if (!line.starts_with("{\"type\":")) return out;
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("type") || !json["type"].is_string()) return out;
  const std::string type = json["type"];
  if (type == "progress") {
    out.kind = ChildLine::Kind::kProgress;
    out.done = whole_number(json, "done", 0);
    out.expected = whole_number(json, "expected", -1);
    if (json.contains("stage") && json["stage"].is_string()) out.stage = json["stage"];
  } else if (type == "samples" && json.contains("marker") && json["marker"].is_object()) {
    out.kind = ChildLine::Kind::kSamples;
    out.samples = dumped(json["marker"]);
  } else if (type == "view" && json.contains("reference_from_frame") &&
             is_matrix_or_null(json["reference_from_frame"])) {
    out.kind = ChildLine::Kind::kView;
    out.frame = whole_number(json, "frame", -1);
    out.view = dumped(json["reference_from_frame"]);
  } else if (type == "note" && json.contains("text") && json["text"].is_string()) {
    out.text = json["text"];
  }
  return out;
}

}  // namespace moiregauge::internal
