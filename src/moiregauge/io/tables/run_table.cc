// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/tables/run_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/nearest_word.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/journal/run_file.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using StoredJson = nlohmann::json;

constexpr const char* kHeader = "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status";
constexpr std::size_t kColumns = 8;
// Bytes of a line (chosen). Limits the search for the end of a quoted name.
constexpr std::size_t kLongestLine = std::size_t{1} << 16;
constexpr double kNone = kNotMeasured;

// Splits a line by RFC 4180. Returns nothing if a quote is not closed.
std::optional<std::vector<std::string>> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (is_quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += c, ++i;
    } else if (c == '"' && (is_quoted || fields.back().empty())) {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  if (is_quoted) return std::nullopt;
  return fields;
}

std::optional<double> csv_real(const std::string& text) {
  if (text == "NaN") return kNone;
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<long> whole(const std::string& text) {
  long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

constexpr std::array kStatuses{Status::kOk,          Status::kUntrusted,     Status::kCameraMoved,
                               Status::kBlurred,     Status::kSaturated,     Status::kPartlyCovered,
                               Status::kLost,        Status::kReferenceLost, Status::kOrderUnproven,
                               Status::kDecodeError, Status::kTooCoarse};

std::optional<Status> status_of(const std::string& word) {
  for (const Status status : kStatuses) {
    if (word == word_for(status)) return status;
  }
  return std::nullopt;
}

std::size_t index_of(RunTable& table, const std::string& name) {
  const auto found =
      std::find_if(table.markers.begin(), table.markers.end(), [&](const TableMarker& m) { return m.name == name; });
  if (found != table.markers.end()) return static_cast<std::size_t>(found - table.markers.begin());
  table.markers.push_back({name, {}, 0.0});
  return table.markers.size() - 1;
}

// Returns the sample of a line. Fails with the mistake.
tl::expected<Sample, std::string> sample_of(const std::string& line, RunTable& table) {
  const auto fields = fields_of(line);
  if (!fields || fields->size() < kColumns) return tl::unexpected(std::string("it has fewer than eight columns"));
  const auto& f = *fields;
  const auto frame = whole(f[0]);
  if (!frame) return tl::unexpected(fmt::format("\"{}\" is not a frame number", f[0]));
  std::array<double, 5> numbers{};
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const std::string& text = f[k == 0 ? 1 : k + 2];
    const auto value = csv_real(text);
    if (!value) return tl::unexpected(fmt::format("\"{}\" is not a number", text));
    numbers[k] = *value;
  }
  const auto status = status_of(f[7]);
  if (!status) return tl::unexpected(fmt::format("\"{}\" is not a status", f[7]));
  Sample sample;
  sample.frame = *frame;
  sample.time_s = numbers[0];
  sample.marker = index_of(table, f[2]);
  sample.displacement = {numbers[1], numbers[2]};
  sample.u = {numbers[3], numbers[4]};
  sample.status = *status;
  return sample;
}

double json_number(const StoredJson& json, const char* key) {
  return json.contains(key) && json[key].is_number() ? json[key].get<double>() : 0.0;
}
std::string text_in(const StoredJson& json, const char* key) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
}

// Reads the exported values of run.json. Returns false if it is no run.json.
bool take_run_json(const StoredJson& json, RunTable& table) {
  if (!json.is_object() || !json.contains("moiregauge")) return false;
  table.version = text_in(json, "moiregauge");
  table.method = text_in(json, "method");
  if (json.contains("input") && json["input"].is_object()) {
    table.input = text_in(json["input"], "path");
    table.input_sha256 = text_in(json["input"], "sha256");
  }
  if (json.contains("reference_frame") && json["reference_frame"].is_number_integer())
    table.reference_frame = json["reference_frame"].get<long>();
  table.complete = !json.contains("complete") || !json["complete"].is_boolean() || json["complete"].get<bool>();
  if (!json.contains("markers") || !json["markers"].is_array()) return true;
  for (const StoredJson& marker : json["markers"]) {
    if (!marker.is_object() || text_in(marker, "role") != "target") continue;
    table.markers.push_back({text_in(marker, "name"),
                             {json_number(marker, "x_mm"), json_number(marker, "y_mm")},
                             json_number(marker, "z_mm")});
  }
  return true;
}

std::string no_run(const std::string& dir) {
  std::error_code error;
  const fs::path place(dir);
  if (!fs::exists(place, error))
    return fmt::format("the folder does not exist: {}: give a folder that `measure` wrote", dir);
  if (!fs::is_directory(place, error))
    return fmt::format("the input is not a folder: {}: give a folder that `measure` wrote", dir);
  if (fs::exists(place / std::string(kRunFileName), error))
    return fmt::format(
        "the run is not finished: {}: finish it with measure --resume, or run `moiregauge solve {} -o NEW` and export "
        "NEW",
        dir, dir);
  return fmt::format("the folder has no run.json: {}: give a folder that `measure` wrote", dir);
}

}  // namespace

tl::expected<void, std::string> parse_displacement_csv(std::istream& csv, RunTable& table) {
  std::string line;
  if (!std::getline(csv, line) || line.substr(0, line.find_last_not_of('\r') + 1).rfind(kHeader, 0) != 0)
    return tl::unexpected(fmt::format("line 1 does not have the columns {}", kHeader));
  for (long number = 2; std::getline(csv, line); ++number) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    // A quoted name may contain line feeds.
    std::string more;
    while (line.size() < kLongestLine && std::count(line.begin(), line.end(), '"') % 2 != 0 && std::getline(csv, more))
      line += "\n" + more;
    auto sample = sample_of(line, table);
    if (!sample) return tl::unexpected(fmt::format("line {}, {}", number, sample.error()));
    table.samples.push_back(*sample);
  }
  return {};
}

tl::expected<RunTable, std::string> read_run_table(const std::string& dir) {
  const fs::path place(dir);
  for (const char* name : {"run.json", "displacement.csv"}) {
    std::error_code ignored;
    const std::string path = (place / name).string();
    if (!fs::exists(path, ignored)) continue;
    if (const std::string kind = kind_unless_plain(path); !kind.empty())
      return tl::unexpected(
          fmt::format("the run cannot be read: {} is {}: give a folder that `measure` wrote", path, kind));
  }
  std::ifstream run_json(place / "run.json");
  std::error_code error;
  if (!run_json || !fs::is_directory(place, error)) return tl::unexpected(no_run(dir));
  RunTable table;
  const StoredJson json = StoredJson::parse(run_json, nullptr, false);
  if (json.is_discarded() || !take_run_json(json, table))
    return tl::unexpected(fmt::format("run.json is damaged: {}: measure again", (place / "run.json").string()));
  std::ifstream csv(place / "displacement.csv");
  if (!csv)
    return tl::unexpected(
        fmt::format("the run has no samples, because it was refused: {}: see overlay.png in it", dir));
  if (const auto read = parse_displacement_csv(csv, table); !read)
    return tl::unexpected(fmt::format("displacement.csv is damaged: {} ({}): write it again with `moiregauge solve {}`",
                                      (place / "displacement.csv").string(), read.error(), dir));
  return table;
}

tl::expected<RunTable, std::string> selected(RunTable table, const Selection& selection) {
  std::vector<std::size_t> kept;  // old indices
  std::vector<std::string_view> names;
  for (const TableMarker& marker : table.markers) names.emplace_back(marker.name);
  for (const std::string& name : selection.markers) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const auto near = nearest_word(name, names);
      return tl::unexpected(fmt::format("the target does not exist: --markers {}: {}choose from {}", name,
                                        near ? fmt::format("did you mean {}? ", *near) : "", fmt::join(names, ", ")));
    }
    const auto index = static_cast<std::size_t>(found - names.begin());
    if (std::find(kept.begin(), kept.end(), index) == kept.end()) kept.push_back(index);
  }
  if (selection.markers.empty()) {
    for (std::size_t i = 0; i < table.markers.size(); ++i) kept.push_back(i);
  }
  std::vector<Sample> samples;
  FrameSelector selector(selection.frames);
  for (Sample sample : table.samples) {
    const auto place = std::find(kept.begin(), kept.end(), sample.marker);
    if (place == kept.end()) continue;
    if (selection.frames.seconds && std::isnan(sample.time_s))
      return tl::unexpected(
          std::string("the run has no times: --frames in seconds: give it times with moiregauge solve --fps"));
    if (!selector.holds(sample.frame, sample.time_s)) continue;
    sample.marker = static_cast<std::size_t>(place - kept.begin());
    if (selection.only_ok && sample.status != Status::kOk) sample.displacement = sample.u = {kNone, kNone};
    samples.push_back(sample);
  }
  if (samples.empty())
    return tl::unexpected(std::string("the selection contains no row: --markers, --frames: choose a wider range"));
  std::vector<TableMarker> markers;
  markers.reserve(kept.size());
  for (const std::size_t i : kept) markers.push_back(table.markers[i]);
  table.markers = std::move(markers);
  table.samples = std::move(samples);
  return table;
}

}  // namespace moiregauge::internal
