// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/app/inspect_frame.h"
#include "moiregauge/base/atomic_file.h"
#include "moiregauge/image/upper_bits.h"
#include "moiregauge/io/config/site_draft.h"
#include "moiregauge/io/config/site_file.h"
#include "moiregauge/io/pictures/luma_jpeg.h"
#include "moiregauge/server/answers/answers.h"
#include "moiregauge/server/api/inspect_request.h"
#include "moiregauge/server/api/inspection_view.h"
#include "moiregauge/server/api/json_body.h"
#include "moiregauge/server/jobs/job.h"

namespace moiregauge::internal {
namespace {

using FrameJson = nlohmann::ordered_json;

constexpr long kMaxFrame = 1'000'000'000;
constexpr long kMaxWidth = 8192;  // px

Answer json_answer(int status, const FrameJson& json) {
  return {status, "application/json", {}, json_answer_text(json), nullptr, false};
}

// Puts the site of a text into the options, as --site does with a file. Fails with the mistakes.
tl::expected<void, std::string> put_site(const InspectBody& body, InspectOptions& options) {
  if (body.site_text.empty()) return {};
  auto site = parse_site(body.site_text, "site.toml");
  if (!site) return tl::unexpected(fmt::format("{}", fmt::join(site.error(), "\n")));
  auto chosen = choose_markers(*site, options.choice);
  if (!chosen) return tl::unexpected(chosen.error());
  options.site = *std::move(chosen);
  options.pitch_mm.reset();
  return {};
}

tl::expected<InspectOptions, std::string> options_of(const InspectBody& body) {
  MeasureArgs args = body.args;
  if (!body.site_text.empty()) args.pitch = args.axes = "";
  auto options = parse_inspect_options(args);
  if (!options) return tl::unexpected(options.error().message);
  if (const auto put = put_site(body, *options); !put) return tl::unexpected(put.error());
  return *std::move(options);
}

// Returns the markers that the choice excludes, as an inspection without the choice finds them.
NamedPositions ignored_positions(const InspectBody& body, const KeptFrame& frame) {
  const MarkerChoiceArgs& choice = body.args.choice;
  const bool excludes = !choice.ignored.empty() || !choice.references.empty() || !choice.targets.empty();
  if (!excludes) return {};
  InspectBody all = body;
  all.args.choice = {{}, {}, {}, {}, choice.regions, choice.excluded_regions};
  const auto options = options_of(all);
  if (!options) return {};
  const Inspection seen = inspect_picture({frame.frame().luma, frame.input.bits}, *options);
  return seen.reference ? named_positions(seen) : NamedPositions{};
}

std::vector<std::string> command_words(const char* command, const InspectBody& body) {
  std::vector<std::string> words{"moiregauge", command, body.path};
  const std::string site = body.site_text.empty() ? "" : site_path(body.path);
  const auto options = option_words(body, site);
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

FrameJson mistake_json(const std::string& text) {
  // "file:line:column: what is wrong"
  const auto first = text.find(':'), second = text.find(':', first + 1), third = text.find(':', second + 1);
  FrameJson json{{"line", 0}, {"column", 0}, {"text", text}};
  if (third == std::string::npos) return json;
  json["line"] = std::atoi(text.c_str() + first + 1);
  json["column"] = std::atoi(text.c_str() + second + 1);
  json["text"] = text.substr(text.find_first_not_of(' ', third + 1));
  return json;
}

}  // namespace

Answer answer_frame(ServerState& state, const Request& request) {
  const auto full = state.folder.existing(request.head.parameter("path"));
  const long number = whole_parameter(request.head, "frame", 0, kMaxFrame);
  const long width = whole_parameter(request.head, "max_width", 1600, kMaxWidth);
  if (!full) return no_such_path();
  if (number < 0 || width < 16)
    return error_answer(400, "a number is out of range: frame, max_width: give a whole number");
  const auto frame = state.frames.frame(*full, number);
  if (!frame) return error_answer(422, without_root(state, frame.error()));
  const InputInfo& input = (*frame)->input;
  const auto grey = upper_bits((*frame)->frame().luma, input.bits);
  Answer answer;
  answer.type = "image/jpeg";
  answer.body = luma_jpeg(shrunk_to_width(grey.view(), static_cast<int>(width)).view());
  const auto add = [&](const char* name, const std::string& value) { answer.headers.emplace_back(name, value); };
  add("X-Frame", std::to_string((*frame)->number));
  add("X-Frames", std::to_string(input.frames));
  add("X-Fps", fmt::format("{:.17g}", input.fps));
  add("X-Width", std::to_string(grey.width()));
  add("X-Height", std::to_string(grey.height()));
  add("X-Time", std::isfinite((*frame)->time_s) ? fmt::format("{:.9g}", (*frame)->time_s) : "");
  return answer;
}

Answer answer_inspect(ServerState& state, const Request& request) {
  const auto json = parse_json_body(request.body);
  if (!json) return error_answer(400, json.error());
  const auto body = inspect_body(*json);
  if (!body) return error_answer(400, body.error());
  const auto full = state.folder.existing(body->path);
  if (!full) return no_such_path();
  const auto options = options_of(*body);
  if (!options) return error_answer(422, options.error());
  const auto frame = state.frames.frame(*full, body->frame);
  if (!frame) return error_answer(422, without_root(state, frame.error()));
  InputInfo input = (*frame)->input;
  input.path = body->path;
  const InspectReport report =
      inspect_frame(input, (*frame)->frame(), *options, [&] { return (*frame)->next_quantiser(); });
  if (report.seen.is_choice_unknown) return error_answer(422, report.seen.missing);
  FrameJson answer = inspection_view(report, ignored_positions(*body, **frame));
  if (report.seen.reference && report.seen.unit == BoardUnit::kMillimetre)
    answer["site"] = site_draft(report.seen, fmt::format("{}, frame {}", body->path, body->frame));
  auto words = command_words("inspect", *body);
  if (body->frame > 0) words.insert(words.end(), {"--frame", std::to_string(body->frame)});
  answer["command"] = shell_line(words);
  answer["measure"] = shell_line(command_words("measure", *body));
  return json_answer(200, answer);
}

Answer answer_site(ServerState& state, const Request& request) {
  const auto json = parse_json_body(request.body);
  if (!json) return error_answer(400, json.error());
  const bool has_texts = json->size() == 2 && json->contains("path") && json->contains("text") &&
                         (*json)["path"].is_string() && (*json)["text"].is_string();
  if (!has_texts) return error_answer(400, "the body is incomplete: the request: send path and text");
  const std::string path = (*json)["path"], text = (*json)["text"];
  const auto clip = state.folder.existing(path);
  const std::string site = site_path(path);
  const auto full = clip ? state.folder.creatable(site) : std::nullopt;
  if (!full) return no_such_path();
  if (const auto read = parse_site_file(text, std::filesystem::path(site).filename().string()); !read) {
    FrameJson errors = FrameJson::array();
    for (const std::string& mistake : read.error()) errors.push_back(mistake_json(mistake));
    const std::string first = errors.empty() ? "" : errors.front()["text"].get<std::string>();
    return json_answer(422,
                       {{"error", fmt::format("the site file has mistakes: {}: {}", site, first)}, {"errors", errors}});
  }
  if (const auto written = write_file_atomically(*full, text); !written)
    return error_answer(507,
                        without_root(state, "the site file could not be written: " + written.error() + ": free space"));
  state.publish_entries();
  return json_answer(200, {{"path", site}, {"command", shell_line({"moiregauge", "measure", path, "--site", site})}});
}

}  // namespace moiregauge::internal
