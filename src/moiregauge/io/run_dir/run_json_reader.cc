// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/run_json_reader.h"

#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

using ReadJson = nlohmann::ordered_json;  // keeps the order of names

const ReadJson& member(const ReadJson& json, const char* key) {
  static const ReadJson nothing;
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found == json.end() ? nothing : *found;
}

std::optional<double> number_of_key(const ReadJson& json, const char* key) {
  const ReadJson& value = member(json, key);
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

std::string text_of_key(const ReadJson& json, const char* key) {
  const ReadJson& value = member(json, key);
  return value.is_string() ? value.get<std::string>() : std::string{};
}

std::vector<std::string> texts_of_key(const ReadJson& json, const char* key) {
  std::vector<std::string> texts;
  for (const ReadJson& value : member(json, key)) {
    if (value.is_string()) texts.push_back(value.get<std::string>());
  }
  return texts;
}

std::vector<PixelRegion> regions_in_json(const ReadJson& json, const char* key) {
  std::vector<PixelRegion> regions;
  for (const ReadJson& value : member(json, key)) {
    std::vector<double> numbers;
    for (const ReadJson& number : value) numbers.push_back(number.is_number() ? number.get<double>() : 0.0);
    if (numbers.size() == 4) regions.push_back({numbers[0], numbers[1], numbers[2], numbers[3]});
  }
  return regions;
}

std::optional<FrameRange> range_of_key(const ReadJson& config, const char* key) {
  const ReadJson& json = member(config, key);
  if (!json.is_object()) return std::nullopt;
  FrameRange range;
  if (const auto first_s = number_of_key(json, "first_s")) {
    range.seconds = TimeRange{*first_s, number_of_key(json, "end_s").value_or(TimeRange{}.end_s)};
    return range;
  }
  range.first = static_cast<long>(number_of_key(json, "first").value_or(0.0));
  range.end = static_cast<long>(number_of_key(json, "end").value_or(-1.0));
  return range;
}

MarkerChoice choice_in(const ReadJson& json) {
  MarkerChoice choice{
      texts_of_key(json, "references"), texts_of_key(json, "targets"), texts_of_key(json, "ignored"), {}};
  const ReadJson& names = member(json, "names");
  if (!names.is_object()) return choice;
  for (const auto& [from, to] : names.items()) {
    if (to.is_string()) choice.names.push_back({from, to.get<std::string>()});
  }
  return choice;
}

}  // namespace

std::string input_sha256_of_run(std::istream& run_json) {
  const auto json = nlohmann::json::parse(run_json, nullptr, false);
  if (json.is_discarded() || !json.contains("input") || !json["input"].contains("sha256")) return {};
  const auto& sha256 = json["input"]["sha256"];
  return sha256.is_string() ? sha256.get<std::string>() : std::string{};
}

std::optional<ResultOptions> options_of_results(std::istream& run_json) {
  const ReadJson json = ReadJson::parse(run_json, nullptr, false);
  const ReadJson& config = member(json, "config");
  if (!config.is_object()) return std::nullopt;
  const ReadJson &area = member(config, "area"), &scale = member(config, "print_scale"), &input = member(json, "input");
  ResultOptions out;
  out.method = text_of_key(json, "method");
  out.choice = choice_in(member(config, "choice"));
  out.area = {regions_in_json(area, "regions_px"), regions_in_json(area, "excluded_px")};
  out.rest = range_of_key(config, "rest");
  out.zero = range_of_key(config, "zero");
  out.readout_s = number_of_key(config, "readout_s");
  out.print_scale = number_of_key(scale, "factor").value_or(1.0);
  out.u_print_scale = number_of_key(scale, "u");
  out.slow_motion = number_of_key(input, "slow_motion").value_or(1.0);
  out.fps = number_of_key(input, "fps");
  out.time_source = text_of_key(input, "time_source");
  return out;
}

}  // namespace moiregauge::internal
