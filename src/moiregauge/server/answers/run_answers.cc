// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/api/json_body.h"
#include "moiregauge/server/api/marker_outline.h"
#include "moiregauge/server/folder/series_columns.h"

namespace moiregauge::internal {
namespace {

using RunJson = nlohmann::ordered_json;

constexpr std::int64_t kMaxRunJsonText = 64 << 20;  // bytes
constexpr long kMaxRunFrame = 1'000'000'000;

// Returns a file of a run that is inside the folder.
std::optional<std::string> run_file(const ServerState& state, const Request& request, const char* name) {
  return state.folder.existing(std::string(request.head.parameter("run")) + "/" + name);
}

std::optional<RunJson> read_run_json(const ServerState& state, const std::string& run) {
  const auto file = state.folder.open_file(run + "/run.json", O_RDONLY);
  struct stat facts {};
  if (!file || ::fstat(file->get(), &facts) != 0 || !S_ISREG(facts.st_mode) || facts.st_size > kMaxRunJsonText)
    return std::nullopt;
  std::string text;
  const AnswerFile bytes(::dup(file->get()), facts.st_size);
  if (!bytes.read(0, static_cast<std::size_t>(facts.st_size), text)) return std::nullopt;
  auto json = RunJson::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return json;
}

std::string text_of(const RunJson& json, const char* block, const char* key) {
  const auto found = json.find(block);
  if (found == json.end() || !found->is_object() || !found->contains(key) || !(*found)[key].is_string()) return {};
  return (*found)[key].get<std::string>();
}

// A run states its input as it was typed: relative to the folder, to the run's own parent, or absolute.
std::optional<std::string> input_of_run(const ServerState& state, const RunJson& json, const std::string& run) {
  std::string path = text_of(json, "input", "path");
  const std::string prefix = state.folder.root() + "/";
  if (path.starts_with(prefix)) path.erase(0, prefix.size());
  if (path.starts_with("./")) path.erase(0, 2);
  while (path.ends_with('/')) path.pop_back();
  if (state.folder.existing(path)) return path;
  const std::string sibling = std::string(folder_part(run)) + "/" + path;
  if (state.folder.existing(sibling)) return sibling;
  return std::nullopt;
}

// Returns the command that measures the same again, with the run's own site.
std::string command_of_run(const RunJson& json, const std::string& run) {
  std::vector<std::string> words{"moiregauge", "measure", text_of(json, "input", "path")};
  const auto config = json.find("config");
  const bool has_pitch =
      config != json.end() && config->is_object() && config->contains("pitch_mm") && (*config)["pitch_mm"].is_number();
  if (has_pitch)
    words.insert(words.end(), {"--pitch", fmt::format("{:.9g}mm", (*config)["pitch_mm"].get<double>())});
  else
    words.insert(words.end(), {"--site", run + "/site.toml"});
  if (const auto method = json.find("method");
      method != json.end() && method->is_string() && *method != std::string(kDefaultMethod))
    words.insert(words.end(), {"--method", method->get<std::string>()});
  return shell_line(words);
}

// Returns the markers of an observation as the page draws them.
RunJson observed_markers(const Reference& reference, const Observation& seen) {
  RunJson list = RunJson::array();
  const View view{seen.references_seen ? seen.stage1 : reference.view.ideal_from_board, reference.lens};
  for (std::size_t i = 0; i < reference.site.markers.size() && i < seen.markers.size(); ++i) {
    const Marker& marker = reference.site.markers[i];
    const MarkerObservation& now = seen.markers[i];
    RunJson json{{"name", marker.name}, {"role", marker.role == Role::kReference ? "reference" : "target"}};
    json["seen"] = now.loss == Loss::kNone;
    if (now.circle)
      json["circle"] = {
          {"x", now.circle->centre.x}, {"y", now.circle->centre.y}, {"diameter_px", now.circle->diameter_px}};
    const auto shift =
        std::isfinite(now.window_shift.x + now.window_shift.y) ? now.window_shift : Extent<frame::Board>{};
    if (marker.grating) json["grating"] = {{"outline", grating_outline(view, *marker.grating, shift)}};
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace

Answer answer_run(ServerState& state, const Request& request) {
  const std::string run(request.head.parameter("run"));
  auto json = read_run_json(state, run);
  if (!json) return no_such_path();
  (*json)["command"] = command_of_run(*json, run);
  if (const auto input = input_of_run(state, *json, run)) (*json)["clip"] = *input;
  return json_text_answer(200, json_answer_text(*json));
}

Answer answer_series(ServerState& state, const Request& request) {
  const auto file = run_file(state, request, "displacement.csv");
  if (!file) return no_such_path();
  const auto series = read_series(*file, std::string(request.head.parameter("marker")));
  if (!series) return error_answer(422, without_root(state, series.error()));
  Answer answer;
  answer.type = "application/octet-stream";
  answer.headers = {{"X-Columns", fmt::format("{}", fmt::join(kSeriesColumns, ","))},
                    {"X-Rows", std::to_string(series->rows())}};
  answer.body = series->bytes();
  return answer;
}

Answer answer_run_frame(ServerState& state, const Request& request) {
  const std::string run(request.head.parameter("run"));
  const auto json = read_run_json(state, run);
  if (!json) return no_such_path();
  const auto clip = input_of_run(state, *json, run);
  if (!clip)
    return error_answer(404, "the clip of this run is not in the folder: the run: put it there to see its frames");
  Request frame = request;
  frame.head.parameters.emplace_back("path", *clip);
  return answer_frame(state, frame);
}

Answer answer_run_markers(ServerState& state, const Request& request) {
  const auto file = run_file(state, request, "run.mgj");
  const long number = whole_parameter(request.head, "frame", 0, kMaxRunFrame);
  if (!file) return no_such_path();
  if (number < 0) return error_answer(400, "the number is out of range: frame: give a whole number");
  const auto kept = state.runs.read(*file);
  if (!kept) return error_answer(422, without_root(state, kept.error()));
  const ObservationLog& log = (*kept)->run.seen;
  if (!log.reference) return error_answer(422, "the run has no reference frame: the run: measure the clip again");
  // The frames are in order.
  std::size_t low = 0, high = log.observations.size();
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (log.observations[middle].frame < number)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == log.observations.size() || log.observations[low].frame != number)
    return error_answer(404, "the frame was not measured: the run: choose one of its rows");
  const Observation seen = log.observations[low];
  const RunJson json{{"frame", number},
                     {"width", log.reference->width},
                     {"height", log.reference->height},
                     {"references_seen", seen.references_seen},
                     {"markers", observed_markers(*log.reference, seen)}};
  return json_text_answer(200, json_answer_text(json));
}

}  // namespace moiregauge::internal
