// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/find_clips.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "moiregauge/base/plain_file.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 12> kVideoEndings{".mp4", ".m4v", ".mov", ".3gp",  ".mkv", ".webm",
                                                         ".avi", ".ts",  ".mts", ".m2ts", ".y4m", ".mpg"};
constexpr std::array<std::string_view, 3> kImageEndings{".png", ".jpg", ".jpeg"};
constexpr std::array<std::string_view, 2> kTiffEndings{".tif", ".tiff"};

template <std::size_t N>
bool has_ending(const fs::path& file, const std::array<std::string_view, N>& endings) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

// Returns the absolute path without `.`, `..` and a slash at its end. Links stay, so the name is that of the link.
fs::path full_path(const fs::path& path) {
  std::error_code ignored;
  const fs::path full = fs::absolute(path, ignored).lexically_normal();
  return full.has_filename() ? full : full.parent_path();
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// Returns true for a run directory and for the folder of a batch.
bool holds_results(const fs::path& folder) {
  return is_there(folder / "run.mgj") || is_there(folder / ".batch") || folder.extension() == ".unfinished";
}

std::string site_next_to(const fs::path& input) {
  std::error_code ignored;
  for (const fs::path& folder : {input, input.parent_path()}) {
    const fs::path site = folder / "site.toml";
    if (fs::is_regular_file(site, ignored)) return site.string();
  }
  return "";
}

class ClipFinder {
 public:
  explicit ClipFinder(const fs::path& output) : output_(full_path(output)) {}

  void add(const fs::path& input) {
    const fs::path path = full_path(input);
    std::error_code ignored;
    if (fs::is_directory(path, ignored))
      add_folder(path);
    else
      add_clip(path);
  }

  [[nodiscard]] std::vector<Clip> clips() const {
    std::vector<Clip> result;
    for (const auto& [input, site] : sites_) result.push_back({"", input, site});
    return result;
  }

 private:
  void add_clip(const fs::path& path) { sites_.emplace(path.string(), site_next_to(path)); }

  void add_folder(const fs::path& folder) {
    if (folder == output_ || holds_results(folder)) return;
    std::vector<fs::path> folders, images, tiffs;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      const fs::path& path = entry->path();
      std::error_code ignored;
      if (path.filename().string().starts_with('.')) continue;
      if (entry->is_directory(ignored)) {
        if (!entry->is_symlink(ignored)) folders.push_back(path);
      } else if (has_ending(path, kVideoEndings)) {
        add_clip(path);
      } else if (has_ending(path, kTiffEndings)) {
        tiffs.push_back(path);
      } else if (has_ending(path, kImageEndings)) {
        images.push_back(path);
      }
    }
    if (images.size() + tiffs.size() >= 2)
      add_clip(folder);
    else if (tiffs.size() == 1)
      add_clip(tiffs.front());
    for (const fs::path& each : folders) add_folder(each);
  }

  fs::path output_;
  std::map<std::string, std::string> sites_;  // by input
};

std::string trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

// Fails if the list is no plain file.
tl::expected<void, std::string> add_list(const std::string& list, ClipFinder& finder) {
  const auto failed = [&](const std::string& why) {
    return tl::unexpected(
        fmt::format("the list of clips cannot be read: {} ({}): give a text file with one path per line", list, why));
  };
  if (const auto opened = open_plain_file(list); !opened) return failed(opened.error());
  std::ifstream file(list);
  const fs::path folder = full_path(list).parent_path();
  for (std::string line; std::getline(file, line);) {
    if (line.find('\0') != std::string::npos) return failed("it is no text");
    const std::string path = trimmed(line);
    if (!path.empty() && !path.starts_with('#')) finder.add(folder / path);
  }
  return {};
}

}  // namespace

tl::expected<std::vector<Clip>, std::string> find_clips(const std::vector<std::string>& inputs,
                                                        const fs::path& output) {
  ClipFinder finder(output);
  for (const std::string& input : inputs) {
    if (!input.starts_with('@'))
      finder.add(input);
    else if (const auto added = add_list(input.substr(1), finder); !added)
      return tl::unexpected(added.error());
  }
  auto clips = finder.clips();
  if (clips.empty())
    return tl::unexpected(
        fmt::format("no clip was found: {}{}: give video files, or folders that contain videos or images",
                    inputs.empty() ? "" : inputs.front(), inputs.size() > 1 ? ", ..." : ""));
  return clips;
}

}  // namespace moiregauge::internal
