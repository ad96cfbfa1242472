// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/manifest.h"

#include <cstdint>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/batch/run_name.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kManifestVersion = 1;
constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20;
constexpr double kMaxTimeLimit_s = 1e15;  // so that milliseconds fit into 64 bits
constexpr std::string_view kNotInNames("./\0", 3);

// JSON holds UTF-8 only, but a path may hold any bytes. Those become hexadecimal digits.
void put_path(Json& json, const std::string& key, const std::string& path) {
  try {
    static_cast<void>(Json(path).dump());
    json[key] = path;
  } catch (const Json::exception&) {
    std::string digits;
    for (const char c : path) digits += fmt::format("{:02x}", static_cast<unsigned char>(c));
    json[key + "_hex"] = digits;
  }
}

// Throws if the path has a NUL, because the system would end it there.
std::string path_of(const Json& json, const std::string& key) {
  std::string path;
  if (json.contains(key)) {
    path = json.at(key).get<std::string>();
  } else {
    const std::string digits = json.value(key + "_hex", "");
    for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
      path += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  if (path.find('\0') != std::string::npos) throw std::invalid_argument(key);
  return path;
}

// Throws unless the value is a whole number from `min` to `max`.
std::int64_t whole_of(const Json& json, const char* key, std::int64_t min, std::int64_t max) {
  const Json& value = json.at(key);
  const bool is_whole =
      value.is_number_integer() && !(value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX);
  if (!is_whole || value.get<std::int64_t>() < min || value.get<std::int64_t>() > max) throw std::out_of_range(key);
  return value.get<std::int64_t>();
}

std::string clip_line(const Clip& clip) {
  Json json{{"name", clip.name}};
  put_path(json, "input", clip.input);
  if (!clip.site.empty()) put_path(json, "site", clip.site);
  return json.dump() + "\n";
}

std::string header_line(const ClipOptions& options) {
  Json arguments = Json::array();
  for (const std::string& argument : options.measure) {
    Json json = Json::object();
    put_path(json, "value", argument);
    arguments.push_back(json);
  }
  return Json{{"batch", kManifestVersion},
              {"measure", arguments},
              {"names_markers", options.names_markers},
              {"threads", options.threads},
              {"time_limit_s", options.time_limit_s},
              {"memory_limit_bytes", options.memory_limit_bytes}}
             .dump() +
         "\n";
}

ClipOptions options_of(const Json& json) {
  ClipOptions options;
  for (const Json& argument : json.at("measure")) options.measure.push_back(path_of(argument, "value"));
  options.names_markers = json.at("names_markers").get<bool>();
  options.threads = static_cast<int>(whole_of(json, "threads", 1, INT32_MAX));
  options.time_limit_s = json.at("time_limit_s").get<double>();
  if (!(options.time_limit_s >= 0.0 && options.time_limit_s <= kMaxTimeLimit_s))
    throw std::out_of_range("time_limit_s");
  options.memory_limit_bytes = whole_of(json, "memory_limit_bytes", 0, INT64_MAX);
  return options;
}

// Reads the lines of a manifest. A name with a dot, slash or NUL would be another folder, or one outside OUT.
tl::expected<void, std::string> read_lines(const fs::path& path, const std::function<void(ClipOptions)>& see_options,
                                           const std::function<void(const Clip&)>& see) {
  std::ifstream file(path);
  const auto failed = [&](const std::string& why) {
    return tl::unexpected(
        fmt::format("the list of clips cannot be read: {} ({}): give the folder of a batch", path.string(), why));
  };
  if (!file) return failed("no such file");
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    try {
      if (line.size() > kMaxLineBytes) return failed(fmt::format("line {} is too long", number));
      const Json json = Json::parse(line);
      if (number == 1) {
        if (json.at("batch") != kManifestVersion) return failed("it is from another version");
        see_options(options_of(json));
        continue;
      }
      const Clip clip{json.at("name").get<std::string>(), path_of(json, "input"), path_of(json, "site")};
      if (clip.name.empty() || clip.name.find_first_of(kNotInNames) != std::string::npos)
        return failed(fmt::format("line {} has no valid name", number));
      see(clip);
    } catch (const std::exception&) {
      return failed(fmt::format("line {} is damaged", number));
    }
  }
  return number > 0 ? tl::expected<void, std::string>{} : failed("it is empty");
}

}  // namespace

tl::expected<void, std::string> write_manifest(const fs::path& path, const Manifest& manifest) {
  std::string text = header_line(manifest.options);
  for (const Clip& clip : manifest.clips) text += clip_line(clip);
  return write_file_atomically(path.string(), text);
}

tl::expected<Manifest, std::string> read_manifest(const fs::path& path) {
  Manifest manifest;
  const auto read = read_lines(
      path, [&](ClipOptions options) { manifest.options = std::move(options); },
      [&](const Clip& clip) { manifest.clips.push_back(clip); });
  if (!read) return tl::unexpected(read.error());
  return manifest;
}

tl::expected<void, std::string> for_each_clip(const fs::path& path, const std::function<void(const Clip&)>& see) {
  return read_lines(
      path, [](const ClipOptions&) {}, see);
}

tl::expected<std::vector<Clip>, std::string> register_clips(const BatchFolder& folder, std::vector<Clip> clips) {
  Manifest known;
  std::error_code ignored;
  if (fs::exists(folder.clips(), ignored)) {
    auto read = read_manifest(folder.clips());
    if (!read) return tl::unexpected(read.error());
    known = *std::move(read);
  }
  RunNames names;
  std::map<std::string, std::size_t> place;
  for (std::size_t i = 0; i < known.clips.size(); ++i) {
    names.keep(known.clips[i].input, known.clips[i].name);
    place[known.clips[i].input] = i;
  }
  std::vector<std::string> inputs;
  inputs.reserve(clips.size());
  for (const Clip& clip : clips) inputs.push_back(clip.input);
  const auto given = names.names_of(inputs);
  bool is_changed = known.clips.empty();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    clips[i].name = given[i];
    const auto [entry, is_new] = place.emplace(clips[i].input, known.clips.size());
    if (is_new)
      known.clips.push_back(clips[i]);
    else
      known.clips[entry->second].site = clips[i].site;
    is_changed = is_changed || is_new;
  }
  if (!is_changed) return clips;
  if (const auto written = write_manifest(folder.clips(), known); !written) return tl::unexpected(written.error());
  return clips;
}

}  // namespace moiregauge::internal
