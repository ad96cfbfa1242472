// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/run_dir/run_place.h"

#include <fcntl.h>
#include <cstdio>

#include <cerrno>
#include <cstring>
#include <fstream>

#include <nlohmann/json.hpp>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/io/journal/run_file.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

fs::path real_place(const std::string& path) {
  std::error_code error;
  fs::path place = fs::weakly_canonical(path, error);
  if (error) place = fs::path(path).lexically_normal();
  return place.has_filename() ? place : place.parent_path();
}

bool move(const fs::path& from, const fs::path& to) { return std::rename(from.c_str(), to.c_str()) == 0; }

// Exchanges `folder` and DIR. On failure returns false, sets errno and changes nothing.
bool exchange(const fs::path& folder, const RunPlace& place) {
  if (::renameat2(AT_FDCWD, folder.c_str(), AT_FDCWD, place.results.c_str(), RENAME_EXCHANGE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
  if (!move(place.results, place.replaced)) return false;
  if (move(folder, place.results)) return move(place.replaced, folder);
  const int why = errno;
  (void)move(place.replaced, place.results);
  errno = why;
  return false;
}

}  // namespace

RunPlace place_of_run(const std::string& dir) {
  const fs::path results = real_place(dir);
  std::string shown = dir;
  while (shown.size() > 1 && shown.back() == '/') shown.pop_back();
  const auto with_suffix = [&](const char* suffix) { return fs::path(results.string() + suffix); };
  return {shown, results, with_suffix(".unfinished"), with_suffix(".solved"), with_suffix(".replaced")};
}

void recover(const RunPlace& place) {
  std::error_code error;
  if (!fs::exists(place.replaced / "run.json", error)) return;
  if (!fs::exists(place.results, error))
    fs::rename(place.replaced, place.results, error);
  else
    fs::remove_all(place.replaced, error);
}

tl::expected<void, std::string> publish(const fs::path& folder, const RunPlace& place) {
  const auto failed = [] { return tl::unexpected(std::string(std::strerror(errno))); };
  std::error_code error;
  if (!sync_folder(folder.string())) return failed();
  const bool is_taken = fs::exists(place.results, error);
  if (!(is_taken ? exchange(folder, place) : move(folder, place.results))) return failed();
  const bool is_synced = sync_folder(place.results.parent_path().string());
  const int why = errno;
  if (is_taken) {
    fs::remove(folder / kRunFileName, error);  // first, so that a kill leaves no run that could be resumed
    fs::remove_all(folder, error);
  }
  errno = why;
  if (!is_synced) return failed();
  return {};
}

void keep_journal_only(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name != kRunFileName && name != kLiveRowsName) fs::remove_all(entry.path(), error);
  }
}

bool holds_interrupted_run(const fs::path& folder) {
  std::ifstream file(folder / "run.json");
  const auto json = nlohmann::json::parse(file, nullptr, false);
  return json.is_object() && json.contains("exit_code") && json["exit_code"] == static_cast<int>(Exit::kInterrupted);
}

}  // namespace moiregauge::internal
