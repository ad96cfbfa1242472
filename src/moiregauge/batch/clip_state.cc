// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/clip_state.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/control_characters.h"
#include "moiregauge/base/file_hash.h"
#include "moiregauge/base/sha256.h"
#include "moiregauge/io/pictures/picture_source.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {
namespace {

using StateJson = nlohmann::ordered_json;

std::string hash_of_texts(const std::vector<std::string>& texts) {
  Sha256 sum;
  for (const std::string& text : texts) {
    sum.add(std::as_bytes(std::span(text)));
    sum.add(std::as_bytes(std::span("", 1)));  // ends the text, so "ab", "c" differs from "a", "bc"
  }
  return sum.hex();
}

std::vector<std::string> files_of(const Clip& clip) {
  return files_of_input(clip.input, {}).value_or(std::vector<std::string>{});
}

std::string stamp_of(const Clip& clip) {
  std::int64_t bytes = 0, newest = 0;
  const auto files = files_of(clip);
  for (const std::string& file : files) {
    struct stat about {};
    if (::stat(file.c_str(), &about) != 0) continue;
    bytes += about.st_size;
    newest = std::max(newest, std::int64_t{about.st_mtim.tv_sec} * 1'000'000'000 + about.st_mtim.tv_nsec);
  }
  return fmt::format("{} files, {} bytes, {} ns", files.size(), bytes, newest);
}

bool is_same_input(const Clip& clip, const ClipIdentity& now, const ClipIdentity& then) {
  if (now.stamp == then.stamp) return true;
  return !then.fingerprint.empty() && fingerprint_of(clip) == then.fingerprint;  // a copy has another time
}

// A higher limit than that of a clip which it ended may let the clip finish.
bool is_raised(double now, double then) { return then > 0.0 && (now == 0.0 || now > then); }

bool may_succeed_now(const ClipState& state, const ClipOptions& options) {
  if (state.exit_code == static_cast<int>(Exit::kOutputUnwritable)) return true;
  if (state.is_timed_out) return is_raised(options.time_limit_s, state.time_limit_s);
  // A failed allocation is an internal error, or ends the process.
  const bool may_lack_memory = state.exit_code == static_cast<int>(Exit::kInternalError) ||
                               state.exit_code > static_cast<int>(Exit::kOutputUnwritable);
  return may_lack_memory &&
         is_raised(static_cast<double>(options.memory_limit_bytes), static_cast<double>(state.memory_limit_bytes));
}

}  // namespace

std::optional<ClipState> read_state(const BatchFolder& folder, const std::string& name) {
  std::ifstream file(folder.state(name));
  if (!file) return std::nullopt;
  try {
    const StateJson json = StateJson::parse(file);
    ClipState state;
    state.is_finished = json.at("finished").get<bool>();
    state.identity = {json.at("options").get<std::string>(), json.at("stamp").get<std::string>(),
                      json.at("fingerprint").get<std::string>()};
    state.exit_code = json.at("exit_code").get<int>();
    state.is_timed_out = json.at("timed_out").get<bool>();
    state.message = json.at("message").get<std::string>();
    state.wall_s = json.at("seconds").get<double>();
    state.cpu_s = json.at("cpu_s").get<double>();
    state.max_resident_bytes = json.at("max_resident_bytes").get<std::int64_t>();
    state.time_limit_s = json.at("time_limit_s").get<double>();
    state.memory_limit_bytes = json.at("memory_limit_bytes").get<std::int64_t>();
    return state;
  } catch (const StateJson::exception&) {
    return std::nullopt;
  }
}

tl::expected<void, std::string> write_state(const BatchFolder& folder, const std::string& name,
                                            const ClipState& state) {
  const StateJson json{{"finished", state.is_finished},
                       {"options", state.identity.options},
                       {"stamp", state.identity.stamp},
                       {"fingerprint", state.identity.fingerprint},
                       {"exit_code", state.exit_code},
                       {"timed_out", state.is_timed_out},
                       {"message", with_controls_escaped(state.message)},
                       {"seconds", state.wall_s},
                       {"cpu_s", state.cpu_s},
                       {"max_resident_bytes", state.max_resident_bytes},
                       {"time_limit_s", state.time_limit_s},
                       {"memory_limit_bytes", state.memory_limit_bytes}};
  return write_file_atomically(folder.state(name).string(), json.dump() + "\n");
}

ClipIdentity identity_of(const Clip& clip, const ClipOptions& options) {
  std::vector<std::string> texts = options.measure;
  for (const std::string_view option : {"--site=", "--camera="})
    for (const std::string& argument : options.measure)
      if (argument.starts_with(option)) texts.push_back(sha256_of_files({argument.substr(option.size())}));
  if (!options.names_markers && !clip.site.empty()) texts.push_back(sha256_of_files({clip.site}));
  return {hash_of_texts(texts), stamp_of(clip), ""};
}

std::string fingerprint_of(const Clip& clip) { return quick_fingerprint(files_of(clip)); }

Need need_of(const Clip& clip, const ClipOptions& options, const std::optional<ClipState>& state, bool retry) {
  if (!state) return Need::kMeasure;
  const ClipIdentity now = identity_of(clip, options);
  if (now.options != state->identity.options) return Need::kRestart;
  if (!is_same_input(clip, now, state->identity)) return Need::kRestart;
  if (!state->is_finished) return Need::kMeasure;
  const bool has_results =
      state->exit_code == static_cast<int>(Exit::kMeasured) || state->exit_code == static_cast<int>(Exit::kIncomplete);
  if (has_results) return Need::kNothing;
  return retry || may_succeed_now(*state, options) ? Need::kMeasure : Need::kNothing;
}

}  // namespace moiregauge::internal
