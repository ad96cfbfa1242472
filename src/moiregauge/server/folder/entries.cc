// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/folder/entries.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "moiregauge/base/rounded_text.h"
#include "moiregauge/server/folder/confined_folder.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using EntryJson = nlohmann::json;

constexpr int kMaxDepth = 3;
constexpr std::size_t kMaxEntries = 5000;
constexpr std::size_t kMaxNames = 20000;       // names in one folder
constexpr std::int64_t kMaxRunJson = 8 << 20;  // bytes
constexpr std::string_view kUnfinished = ".unfinished";

struct FileFacts {
  bool exists = false, is_folder = false, is_plain = false;
  std::int64_t bytes = 0, modified_ns = 0;
};

FileFacts file_facts(const std::string& path, bool follows_links) {
  struct stat facts {};
  if ((follows_links ? ::stat(path.c_str(), &facts) : ::lstat(path.c_str(), &facts)) != 0) return {};
  return {true, S_ISDIR(facts.st_mode), S_ISREG(facts.st_mode), facts.st_size,
          std::int64_t{1'000'000'000} * facts.st_mtim.tv_sec + facts.st_mtim.tv_nsec};
}

double number_at(const EntryJson& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
}

std::string text_at(const EntryJson& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Returns the movement of the target that moved most, along its larger axis.
std::string headline_of(const EntryJson& json, const Movements& movements) {
  std::string text;
  double largest = 0.0;
  const auto targets = json.find("targets");
  if (targets == json.end() || !targets->is_array()) return text;
  for (const EntryJson& target : *targets) {
    const auto found = target.is_object() ? movements.find(text_at(target, "name")) : movements.end();
    if (found == movements.end()) continue;
    const MarkerMovement& range = found->second;
    for (const auto& [axis, movement] : {std::pair{"dx", range.dx_mm()}, std::pair{"dy", range.dy_mm()}}) {
      const double expanded = 2.0 * number_at(target, fmt::format("u_{}_mm", axis).c_str());
      if (!(movement > largest) || !std::isfinite(expanded)) continue;
      largest = movement;
      text = fmt::format("{}: {} {:.{}f} mm peak to peak, U = {:.{}f} mm (k = 2)", found->first, axis, movement,
                         decimals_for(expanded), expanded, decimals_for(expanded));
    }
  }
  return text;
}

// Returns the names in a folder, sorted. Hidden names and names that the page cannot address are excluded.
std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator i(folder, error), end; !error && i != end && names.size() < kMaxNames;
       i.increment(error)) {
    std::string name = i->path().filename().string();
    if (is_plain_name(name)) names.push_back(std::move(name));
  }
  std::ranges::sort(names);
  return names;
}

Entry new_entry(const std::string& path, EntryKind kind, const FileFacts& facts) {
  Entry entry;
  entry.path = path;
  entry.kind = kind;
  entry.bytes = facts.bytes;
  entry.modified_s = 1e-9 * static_cast<double>(facts.modified_ns);
  return entry;
}

// Returns the size of the images in a folder, bytes.
std::int64_t bytes_of_images(const std::string& folder, const std::vector<std::string>& names) {
  std::int64_t bytes = 0;
  for (const std::string& name : names) {
    if (!has_image_extension(name)) continue;
    const FileFacts facts = file_facts(fmt::format("{}/{}", folder, name), false);
    if (facts.is_plain) bytes += facts.bytes;
  }
  return bytes;
}

// A clip and its run belong together by the default name of the output folder.
void join_runs(std::vector<Entry>& entries) {
  std::map<std::string, const Entry*> runs;
  for (const Entry& entry : entries) {
    if (entry.kind == EntryKind::kRun) runs.emplace(entry.path, &entry);
  }
  for (Entry& entry : entries) {
    if (entry.kind != EntryKind::kClip && entry.kind != EntryKind::kImages) continue;
    const auto found = runs.find(without_picture_extension(entry.path) + "-moiregauge");
    if (found == runs.end()) continue;
    entry.run = found->first;
    entry.state = found->second->state;
    entry.headline = found->second->headline;
    entry.exit_code = found->second->exit_code;
  }
}

}  // namespace

const char* word_for(EntryKind kind) {
  constexpr std::array kWords = {"clip", "images", "run", "folder", "table", "camera"};
  return kWords[static_cast<std::size_t>(kind)];
}

std::optional<RunFacts> run_facts(std::string_view run_json, const Movements& movements) {
  const EntryJson json = EntryJson::parse(run_json, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  RunFacts facts;
  const double code = number_at(json, "exit_code");
  if (code >= 0.0 && code < 256.0) facts.exit_code = static_cast<int>(code);
  facts.state = facts.exit_code == 4 ? "refused" : facts.exit_code == 130 ? "interrupted" : "done";
  facts.headline = headline_of(json, movements);
  if (const auto input = json.find("input"); input != json.end() && input->is_object())
    facts.input = text_at(*input, "path");
  return facts;
}

RunFacts EntryList::facts_of(const std::string& run_json) {
  const FileFacts file = file_facts(run_json, true);
  Known& known = known_[run_json];
  if (known.modified_ns == file.modified_ns) return known.facts;
  known = {file.modified_ns, {"done", "", std::nullopt, ""}};
  if (!file.is_plain || file.bytes > kMaxRunJson) return known.facts;
  std::ifstream in(run_json, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const Movements movements = movements_of((fs::path(run_json).parent_path() / "displacement.csv").string());
  if (auto facts = run_facts(text, movements)) known.facts = *std::move(facts);
  return known.facts;
}

bool EntryList::add_run(const std::string& relative, std::vector<Entry>& out) {
  const std::string folder = root_ + "/" + relative;
  const FileFacts results = file_facts(folder + "/run.json", false);
  const FileFacts journal = file_facts(folder + "/run.mgj", false);
  if (!results.is_plain && !journal.is_plain) return false;
  Entry entry = new_entry(relative, EntryKind::kRun, results.modified_ns > journal.modified_ns ? results : journal);
  entry.bytes = 0;
  entry.state = "interrupted";
  const bool is_unfinished = relative.ends_with(kUnfinished);
  if (results.is_plain && !is_unfinished) {
    RunFacts facts = facts_of(folder + "/run.json");
    entry.state = std::move(facts.state);
    entry.headline = std::move(facts.headline);
    entry.exit_code = facts.exit_code;
  }
  if (is_unfinished) entry.path.resize(relative.size() - kUnfinished.size());
  const auto known = std::ranges::find(out, entry.path, &Entry::path);
  if (known == out.end())
    out.push_back(std::move(entry));
  else
    known->state = "interrupted";  // it is measured again
  return true;
}

void EntryList::add_file(const std::string& path, std::string_view name, std::vector<Entry>& out) {
  const FileFacts facts = file_facts(fmt::format("{}/{}", root_, path), false);
  if (!facts.is_plain) return;
  constexpr std::array<std::string_view, 3> kTables = {"csv", "txt", "tsv"};
  constexpr std::array<std::string_view, 3> kCameras = {"toml", "yaml", "yml"};
  if (has_video_extension(name))
    out.push_back(new_entry(path, EntryKind::kClip, facts));
  else if (has_image_extension(name))
    out.push_back(new_entry(path, EntryKind::kImages, facts));
  else if (has_extension(name, kTables))
    out.push_back(new_entry(path, EntryKind::kTable, facts));
  else if (has_extension(name, kCameras) && name.find("camera") != std::string_view::npos)
    out.push_back(new_entry(path, EntryKind::kCamera, facts));
}

void EntryList::add_folder(const std::string& relative, int depth, std::vector<Entry>& out) {
  const std::string folder = relative.empty() ? root_ : root_ + "/" + relative;
  for (const std::string& name : names_in(folder)) {
    if (out.size() >= kMaxEntries) return;
    const std::string path = relative.empty() ? name : fmt::format("{}/{}", relative, name);
    const FileFacts facts = file_facts(root_ + "/" + path, false);
    if (!facts.is_folder) {
      add_file(path, name, out);
    } else if (!add_run(path, out)) {
      const std::vector<std::string> inside = names_in(root_ + "/" + path);
      const bool has_images = std::ranges::any_of(inside, has_image_extension);
      Entry entry = new_entry(path, has_images ? EntryKind::kImages : EntryKind::kFolder, facts);
      entry.bytes = bytes_of_images(root_ + "/" + path, inside);
      out.push_back(std::move(entry));
      if (!has_images && depth < kMaxDepth) add_folder(path, depth + 1, out);
    }
  }
}

std::string site_path(const std::string& clip) { return without_picture_extension(clip) + ".site.toml"; }

std::vector<Entry> EntryList::read() {
  const std::lock_guard lock(mutex_);
  std::vector<Entry> out;
  add_folder("", 1, out);
  join_runs(out);
  for (Entry& entry : out) {
    if (entry.kind != EntryKind::kClip && entry.kind != EntryKind::kImages) continue;
    std::string site = site_path(entry.path);
    if (file_facts(root_ + "/" + site, false).is_plain) entry.site = std::move(site);
  }
  return out;
}

}  // namespace moiregauge::internal
