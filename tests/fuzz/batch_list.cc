// SPDX-License-Identifier: Apache-2.0
// Input: any text as a list of clips, by hand (`batch @FILE`) and as `batch` writes it (.batch/clips.jsonl, and the
// manifest of a Slurm job). A slash in a list by hand becomes `_`, so that a trial never reads folders of the computer.
// Requires: clips of a list are below its folder, sorted and distinct. A name of a manifest is that of a folder in OUT.
// A list is the same after it is written and read again, and an error is one line.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "moiregauge/batch/find_clips.h"
#include "moiregauge/batch/manifest.h"
#include "tests/fuzz/fuzz_folder.h"
#include "tests/fuzz/input_file.h"

namespace {

using namespace moiregauge::internal;

void check_list(std::string text) {
  static const fuzz::FuzzFolder folder;
  std::replace(text.begin(), text.end(), '/', '_');
  const std::string list = folder.put("lists/list", text);
  const auto clips = find_clips({"@" + list}, folder.path() / "out");
  if (!clips) {
    fuzz::demand(!clips.error().empty() && clips.error().find('\n') == std::string::npos);
    return;
  }
  for (const Clip& clip : *clips) {
    fuzz::demand(clip.name.empty() && clip.input.starts_with(folder.path().string()));
    fuzz::demand(clip.input.find_first_of(std::string("\0\n", 2)) == std::string::npos);
  }
  fuzz::demand(std::adjacent_find(clips->begin(), clips->end(),
                                  [](const Clip& a, const Clip& b) { return a.input >= b.input; }) == clips->end());
}

bool is_same(const Clip& a, const Clip& b) { return a.name == b.name && a.input == b.input && a.site == b.site; }

void check_manifest(const std::string& text) {
  static const fuzz::FuzzFolder folder;
  const auto read = read_manifest(folder.put("manifest", text));
  if (!read) {
    fuzz::demand(!read.error().empty() && read.error().find('\n') == std::string::npos);
    return;
  }
  for (const Clip& clip : read->clips) {
    fuzz::demand(!clip.name.empty() && clip.name.find_first_of(std::string("./\0", 3)) == std::string::npos);
    fuzz::demand(clip.input.find('\0') == std::string::npos && clip.site.find('\0') == std::string::npos);
  }
  const ClipOptions& options = read->options;
  fuzz::demand(options.threads >= 1 && options.time_limit_s >= 0.0 && options.memory_limit_bytes >= 0);
  const auto path = folder.path() / "written";
  fuzz::demand(write_manifest(path, *read).has_value());
  const auto again = read_manifest(path);
  fuzz::demand(again.has_value() && again->options.measure == options.measure);
  fuzz::demand(again->options.time_limit_s == options.time_limit_s);
  fuzz::demand(std::equal(again->clips.begin(), again->clips.end(), read->clips.begin(), read->clips.end(), is_same));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::text_of({data, size});
  check_list(text);
  check_manifest(text);
  return 0;
}
