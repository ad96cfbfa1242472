// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/inspect_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace moiregauge::internal {
namespace {

using BodyJson = nlohmann::json;

constexpr std::size_t kMaxListed = 500;

tl::unexpected<std::string> wrong_value(const std::string& key) {
  return tl::unexpected(fmt::format("a value has the wrong type: {}: see the address's documentation", key));
}

bool read_names(const BodyJson& value, std::vector<std::string>& out) {
  if (!value.is_array() || value.size() > kMaxListed) return false;
  for (const BodyJson& name : value) {
    if (!name.is_string()) return false;
    out.push_back(name.get<std::string>());
  }
  return true;
}

// Reads [x, y, width, height].
std::optional<std::string> region_text(const BodyJson& value) {
  if (!value.is_array() || value.size() != 4) return std::nullopt;
  std::string text;
  for (const BodyJson& number : value) {
    if (!number.is_number() || !std::isfinite(number.get<double>())) return std::nullopt;
    text += fmt::format("{}{:.6g}", text.empty() ? "" : ",", number.get<double>());
  }
  return text;
}

// Reads one region, or a list of them.
bool read_regions(const BodyJson& value, std::vector<std::string>& out) {
  if (!value.is_array() || value.size() > kMaxListed) return false;
  if (value.empty()) return true;
  if (value.front().is_number()) {
    const auto text = region_text(value);
    if (text) out.push_back(*text);
    return text.has_value();
  }
  return std::ranges::all_of(value, [&](const BodyJson& region) {
    return !region.empty() && region.front().is_number() && read_regions(region, out);
  });
}

bool read_new_names(const BodyJson& value, std::vector<std::string>& out) {
  if (!value.is_object() || value.size() > kMaxListed) return false;
  for (const auto& [from, to] : value.items()) {
    if (!to.is_string()) return false;
    out.push_back(from + "=" + to.get<std::string>());
  }
  return true;
}

bool read_text(const BodyJson& value, std::string& out) {
  if (!value.is_string()) return false;
  out = value.get<std::string>();
  return true;
}

bool read_frame(const BodyJson& value, long& out) {
  if (!value.is_number_integer()) return false;
  out = value.get<long>();
  return out >= 0 && out <= 1'000'000'000;
}

bool read_value(const std::string& key, const BodyJson& value, InspectBody& body) {
  MarkerChoiceArgs& choice = body.args.choice;
  if (value.is_null()) return true;
  if (key == "path") return read_text(value, body.path);
  if (key == "pitch") return read_text(value, body.args.pitch);
  if (key == "axes") return read_text(value, body.args.axes);
  if (key == "site") return read_text(value, body.site_text);
  if (key == "frame") return read_frame(value, body.frame);
  if (key == "region") return read_regions(value, choice.regions);
  if (key == "exclude") return read_regions(value, choice.excluded_regions);
  if (key == "references") return read_names(value, choice.references);
  if (key == "targets") return read_names(value, choice.targets);
  if (key == "ignore") return read_names(value, choice.ignored);
  if (key == "names") return read_new_names(value, choice.names);
  return false;
}

std::string joined_names(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ",")); }

}  // namespace

tl::expected<InspectBody, std::string> inspect_body(const nlohmann::json& json) {
  InspectBody body;
  for (const auto& [key, value] : json.items()) {
    if (!read_value(key, value, body)) return wrong_value(key);
  }
  if (body.path.empty()) return wrong_value("path");
  return body;
}

std::vector<std::string> option_words(const InspectBody& body, const std::string& site) {
  std::vector<std::string> words;
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  const MarkerChoiceArgs& choice = body.args.choice;
  add("--site", site);
  if (site.empty()) add("--pitch", body.args.pitch);
  if (site.empty()) add("--axes", body.args.axes);
  add("--references", joined_names(choice.references));
  add("--targets", joined_names(choice.targets));
  add("--ignore", joined_names(choice.ignored));
  for (const std::string& name : choice.names) add("--name", name);
  for (const std::string& region : choice.regions) add("--region", region);
  for (const std::string& region : choice.excluded_regions) add("--exclude-region", region);
  return words;
}

}  // namespace moiregauge::internal
