// SPDX-License-Identifier: Apache-2.0
// Lists the clips, image folders and runs in a folder.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "moiregauge/server/folder/names.h"
#include "moiregauge/server/folder/run_movement.h"

namespace moiregauge::internal {

enum class EntryKind { kClip, kImages, kRun, kFolder, kTable, kCamera };
[[nodiscard]] const char* word_for(EntryKind kind);

struct Entry {
  std::string path;  // relative to the folder
  EntryKind kind = EntryKind::kClip;
  std::int64_t bytes = 0;        // 0: a folder
  double modified_s = 0.0;       // since 1970
  std::string state = "new";     // "new", "done", "refused", "interrupted"
  std::string run;               // run of a clip; empty: none
  std::string site;              // site file of a clip; empty: none
  std::string headline;          // largest movement of a run
  std::optional<int> exit_code;  // exit code of a run
};

// Result of a run in short.
struct RunFacts {
  std::string state;  // as Entry::state
  std::string headline;
  std::optional<int> exit_code;
  std::string input;  // as stated by the run
};

// Returns the facts of a run from the text of its run.json and the ranges of its targets. Fails (nothing): the text is
// no run.json.
[[nodiscard]] std::optional<RunFacts> run_facts(std::string_view run_json, const Movements& movements);

// Returns the path of a clip's site file: bridge.site.toml next to bridge.mp4.
[[nodiscard]] std::string site_path(const std::string& clip);

// Lists a folder. Results that have not changed since the last call are not read again.
class EntryList {
 public:
  explicit EntryList(std::string root) : root_(std::move(root)) {}
  // Returns the entries of the folder and its sub-folders to depth 3, at most 5000, in order of their paths. Hidden
  // files and links to outside are excluded.
  [[nodiscard]] std::vector<Entry> read();

 private:
  struct Known {
    std::int64_t modified_ns = 0;
    RunFacts facts;
  };
  void add_folder(const std::string& relative, int depth, std::vector<Entry>& out);
  void add_file(const std::string& path, std::string_view name, std::vector<Entry>& out);
  [[nodiscard]] bool add_run(const std::string& relative, std::vector<Entry>& out);
  [[nodiscard]] RunFacts facts_of(const std::string& run_json);

  const std::string root_;
  std::mutex mutex_;
  std::map<std::string, Known> known_;  // by path of run.json
};

}  // namespace moiregauge::internal
