// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/jobs/job_arguments.h"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "moiregauge/base/control_characters.h"
#include "moiregauge/server/folder/confined_folder.h"
#include "moiregauge/server/folder/names.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxArguments = 400, kMaxArgument = 4096;

enum class ValueKind { kFlag, kText, kInput, kOutput, kTable };

struct AllowedOption {
  std::string_view name;
  ValueKind kind;
};

using enum ValueKind;

constexpr auto kScene = std::to_array<AllowedOption>({{"--site", kInput},
                                                      {"--camera", kInput},
                                                      {"--readout", kText},
                                                      {"--fps", kText},
                                                      {"--slow-motion", kText},
                                                      {"--rest", kText},
                                                      {"--zero", kText},
                                                      {"--method", kText},
                                                      {"--print-scale", kText},
                                                      {"--u-print-scale", kText},
                                                      {"--references", kText},
                                                      {"--targets", kText},
                                                      {"--ignore", kText},
                                                      {"--name", kText},
                                                      {"--region", kText},
                                                      {"--exclude-region", kText}});
constexpr auto kMeasure = std::to_array<AllowedOption>({{"--pitch", kText},
                                                        {"--axes", kText},
                                                        {"--tone", kText},
                                                        {"--template", kText},
                                                        {"--reference-frame", kText},
                                                        {"--frames", kText},
                                                        {"--max-pixels", kText},
                                                        {"--figures", kText},
                                                        {"--video", kFlag},
                                                        {"--exaggerate", kText},
                                                        {"--threads", kText},
                                                        {"--resume", kFlag},
                                                        {"--restart", kFlag},
                                                        {"--stabilised", kOutput},
                                                        {"-o", kOutput},
                                                        {"--out", kOutput}});
constexpr auto kSolve = std::to_array<AllowedOption>({{"--figures", kText}, {"-o", kOutput}, {"--out", kOutput}});
constexpr auto kDerive = std::to_array<AllowedOption>({{"--channel", kText},
                                                       {"--filter", kText},
                                                       {"--detrend", kFlag},
                                                       {"--velocity", kText},
                                                       {"--resample", kText},
                                                       {"--median", kText},
                                                       {"--modes", kFlag},
                                                       {"-o", kTable},
                                                       {"--out", kTable}});
constexpr auto kCompare = std::to_array<AllowedOption>({{"--channel", kText},
                                                        {"--column", kText},
                                                        {"--time-column", kText},
                                                        {"--rate", kText},
                                                        {"--unit", kText},
                                                        {"--sign", kText},
                                                        {"--scale", kText},
                                                        {"--offset", kText},
                                                        {"-o", kOutput},
                                                        {"--out", kOutput}});
constexpr auto kExport = std::to_array<AllowedOption>({{"--format", kText},
                                                       {"--markers", kText},
                                                       {"--frames", kText},
                                                       {"--time", kText},
                                                       {"--axis", kText},
                                                       {"--decimal-comma", kFlag},
                                                       {"--separator", kText},
                                                       {"--only-ok", kFlag},
                                                       {"--gaps", kText},
                                                       {"--replace", kFlag},
                                                       {"-o", kTable},
                                                       {"--out", kTable}});
constexpr auto kInspect = std::to_array<AllowedOption>(
    {{"--frame", kText}, {"--pitch", kText}, {"--axes", kText}, {"-o", kOutput}, {"--out", kOutput}});
// Outlets that open connections to other hosts are left to the command line.
constexpr auto kLive = std::to_array<AllowedOption>(
    {{"--pitch", kText},    {"--axes", kText},        {"--tone", kText},         {"--template", kText},
     {"--pace", kText},     {"--for", kText},         {"--segment", kText},      {"--keep", kText},
     {"--quota", kText},    {"--alarm", kText},       {"--record", kText},       {"--record-full", kFlag},
     {"--exposure", kText}, {"--gain", kText},        {"--pixel-format", kText}, {"--sensor-region", kText},
     {"--trigger", kText},  {"--packet-size", kText}, {"--mosaic", kText},       {"--patience", kText},
     {"--resume", kFlag},   {"--restart", kFlag},     {"-o", kOutput},           {"--out", kOutput}});

struct AllowedAction {
  std::string_view name;
  std::size_t paths;  // positional arguments
  std::span<const AllowedOption> options;
  bool has_scene = true;  // also the options in kScene
};
constexpr auto kActions = std::to_array<AllowedAction>({{"measure", 1, kMeasure},
                                                        {"solve", 1, kSolve},
                                                        {"derive", 1, kDerive},
                                                        {"compare", 2, kCompare},
                                                        {"export", 1, kExport, false},
                                                        {"inspect", 1, kInspect},
                                                        {"live", 1, kLive}});

const AllowedOption* find_in(std::span<const AllowedOption> options, std::string_view name) {
  const auto found = std::ranges::find(options, name, &AllowedOption::name);
  return found == options.end() ? nullptr : &*found;
}

const AllowedOption* allowed_option(const AllowedAction& action, std::string_view name) {
  const AllowedOption* own = find_in(action.options, name);
  return own != nullptr || !action.has_scene ? own : find_in(kScene, name);
}

tl::unexpected<std::string> refused_argument(const char* what, std::string_view where, const char* remedy) {
  return tl::unexpected(fmt::format("{}: {}: {}", what, where, remedy));
}

bool is_number_text(std::string_view text) { return text.find_first_not_of("+-.0123456789") == std::string_view::npos; }

bool is_plain_text(std::string_view text) {
  return !text.empty() && text.size() <= kMaxArgument && !has_control_character(text);
}

// A table is written over any file of its name, so it must look like one.
bool is_table_name(std::string_view path) {
  constexpr std::array<std::string_view, 6> kEndings = {".csv", ".xlsx", ".mat", ".h5", ".uff", ".hdf5"};
  return std::ranges::any_of(kEndings, [path](std::string_view ending) { return path.ends_with(ending); });
}

// Reads arguments one by one into a command.
class ArgumentReader {
 public:
  ArgumentReader(const AllowedAction& action, const PathRules& paths) : action_(action), paths_(paths) {}

  tl::expected<JobCommand, std::string> read(const std::vector<std::string>& arguments) {
    command_.action = action_.name;
    command_.arguments = arguments;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      const std::string& word = arguments[i];
      if (!is_plain_text(word))
        return refused_argument("an argument is empty or not plain text", action_.name, "correct it");
      const AllowedOption* option = word.starts_with('-') ? allowed_option(action_, word) : nullptr;
      if (word.starts_with('-') && option == nullptr)
        return refused_argument("the option is not allowed here", word, "use the command line");
      if (option != nullptr && option->kind != kFlag && ++i == arguments.size())
        return refused_argument("the option has no value", word, "add it");
      const auto taken = option == nullptr       ? positional(word)
                         : option->kind == kFlag ? Taken()
                                                 : value(*option, arguments[i]);
      if (!taken) return tl::unexpected(taken.error());
    }
    if (positions_ != action_.paths) return refused_argument("a path is missing", action_.name, "choose an entry");
    return std::move(command_);
  }

 private:
  using Taken = tl::expected<void, std::string>;

  Taken positional(const std::string& word) {
    if (++positions_ > action_.paths) return refused_argument("there are too many paths", word, "remove it");
    const bool is_address = action_.name == "live" && is_live_address(word);
    if (!is_address && !paths_.exists(word))
      return refused_argument("nothing is there", word, "choose an entry of the folder");
    if (positions_ == 1) command_.input = word;
    return {};
  }

  Taken value(const AllowedOption& option, const std::string& word) {
    if (!is_plain_text(word) || (word.starts_with('-') && !is_number_text(word)))
      return refused_argument("the value is not plain text", option.name, "correct it");
    if (option.kind == kInput && !paths_.exists(word))
      return refused_argument("the file does not exist in the folder", word, "choose another");
    if (option.kind == kOutput || option.kind == kTable) {
      if (word.starts_with('-') || !paths_.can_be_made(word))
        return refused_argument("the output would be outside the folder", word, "choose another name");
      if (option.kind == kTable && !is_table_name(word))
        return refused_argument("the name is not that of a table", word, "end it in .csv, .xlsx, .mat, .h5 or .uff");
      if (option.name != "--stabilised") command_.output = word;
    }
    return {};
  }

  const AllowedAction& action_;
  const PathRules& paths_;
  JobCommand command_;
  std::size_t positions_ = 0;
};

// Returns the folder that a command writes by default, next to its input.
std::string default_folder(const JobCommand& command) {
  const std::string_view suffix = command.action == "live"      ? "-live"
                                  : command.action == "inspect" ? "-inspect"
                                                                : "-moiregauge";
  return without_picture_extension(command.input).append(suffix);
}

// The commands themselves write to the working folder, and shorten some names.
bool is_default_elsewhere(const std::string& input) {
  const std::string stem = without_picture_extension(input);
  return input.find_first_of("/%") != std::string::npos || stem.ends_with('_') || stem.ends_with('-');
}

void state_output(JobCommand& command) {
  if (!command.output.empty()) return;
  if (command.action == "measure" || command.action == "inspect" || command.action == "live") {
    if (command.action == "live" && is_live_address(command.input)) return;
    command.output = default_folder(command);
    if (is_default_elsewhere(command.input)) command.arguments.insert(command.arguments.end(), {"-o", command.output});
  } else {
    command.output = command.input;
  }
}

}  // namespace

bool is_live_address(std::string_view source) {
  return source == "camera" || source.starts_with("camera:") || source.starts_with("rtsp://") ||
         source.starts_with("rtsps://") || source.starts_with("http://") || source.starts_with("https://");
}

tl::expected<JobCommand, std::string> job_command(std::string_view action, const std::vector<std::string>& arguments,
                                                  const PathRules& paths) {
  const auto* found = std::ranges::find(kActions, action, &AllowedAction::name);
  if (found == kActions.end())
    return tl::unexpected(std::string(
        "the action is unknown: the request: use measure, solve, derive, compare, export, inspect or live"));
  if (arguments.size() > kMaxArguments)
    return tl::unexpected(std::string("there are too many arguments: the request: send up to 400"));
  return ArgumentReader(*found, paths).read(arguments).map([](JobCommand command) {
    state_output(command);
    return command;
  });
}

std::optional<JobCommand> resumed(JobCommand command) {
  if (command.action != "measure" && command.action != "live") return std::nullopt;
  std::erase(command.arguments, "--restart");
  if (std::ranges::find(command.arguments, "--resume") == command.arguments.end())
    command.arguments.emplace_back("--resume");
  return command;
}

}  // namespace moiregauge::internal
