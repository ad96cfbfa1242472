// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/run_name.h"

#include <algorithm>
#include <filesystem>
#include <span>

#include "moiregauge/base/control_characters.h"
#include "moiregauge/base/sha256.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

// File systems allow 255 bytes. Suffixes of this program and of others need some.
constexpr std::size_t kMaxNameBytes = 80;

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_-+,()").find(c) != std::string_view::npos;
}

// Returns the length of the UTF-8 character at the start, by its first byte. An invalid byte has 1.
std::size_t character_bytes(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 1;
  return length <= text.size() && !has_control_character(text.substr(0, length)) ? length : 1;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

std::string with_folder(const std::string& input) {
  const fs::path path(input);
  const fs::path folder = path.filename() == "frames" ? path.parent_path().parent_path() : path.parent_path();
  return plain_run_name(input) + "-" + safe_name(folder.filename().string());
}

std::string with_digits(const std::string& input) {
  Sha256 sum;
  sum.add(std::as_bytes(std::span(input)));
  return with_folder(input) + "-" + sum.hex().substr(0, 8);
}

}  // namespace

std::string safe_name(std::string_view text) {
  std::string name;
  while (!text.empty()) {
    const std::size_t length = character_bytes(text);
    if (name.size() + length > kMaxNameBytes) break;
    if (length > 1 || is_plain(text.front()))
      name += text.substr(0, length);
    else
      name += '_';
    text.remove_prefix(length);
  }
  if (name.empty()) return "_";
  if (name.front() == '-' || name.front() == '+') name.front() = '_';  // not an option, nor a formula of a spreadsheet
  return name;
}

std::string plain_run_name(const std::string& input) {
  const fs::path path(input);
  if (path.filename() == "frames") return safe_name(path.parent_path().filename().string());
  std::error_code ignored;
  // The name of a folder has no extension.
  return safe_name(fs::is_directory(path, ignored) ? path.filename().string() : path.stem().string());
}

void RunNames::keep(const std::string& input, const std::string& name) {
  name_of_[input] = name;
  taken_.insert(lower(name));
}

void RunNames::name_by(std::string (*naming)(const std::string&), std::vector<std::string>& unnamed) {
  std::map<std::string, int> count;
  for (const std::string& input : unnamed) ++count[lower(naming(input))];
  std::vector<std::string> left;
  for (const std::string& input : unnamed) {
    const std::string name = naming(input);
    if (count[lower(name)] == 1 && !taken_.contains(lower(name)))
      keep(input, name);
    else
      left.push_back(input);
  }
  unnamed = std::move(left);
}

std::vector<std::string> RunNames::names_of(const std::vector<std::string>& inputs) {
  std::set<std::string> fresh;
  for (const std::string& input : inputs)
    if (!name_of_.contains(input)) fresh.insert(input);
  std::vector<std::string> unnamed(fresh.begin(), fresh.end());
  for (const auto naming : {plain_run_name, with_folder, with_digits}) name_by(naming, unnamed);
  std::vector<std::string> names;
  names.reserve(inputs.size());
  for (const std::string& input : inputs) names.push_back(name_of_[input]);
  return names;
}

}  // namespace moiregauge::internal
