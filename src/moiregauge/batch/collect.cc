// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/batch/collect.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/batch/batch_csv.h"
#include "moiregauge/batch/catalogue.h"
#include "moiregauge/batch/index_page.h"
#include "moiregauge/batch/manifest.h"
#include "moiregauge/results/summary.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFailures = 5;  // that the program names. batch.csv has all

// A text file that is written in pieces and published as a whole.
class PiecewiseFile {
 public:
  explicit PiecewiseFile(const fs::path& path)
      : path_(path),
        unfinished_(path.string() + fmt::format(".{}", ::getpid())),
        file_(unfinished_, std::ios::binary) {}
  PiecewiseFile(const PiecewiseFile&) = delete;
  PiecewiseFile& operator=(const PiecewiseFile&) = delete;
  ~PiecewiseFile() {
    std::error_code ignored;
    fs::remove(unfinished_, ignored);
  }
  void add(std::string_view text) { file_ << text; }
  // Fails with path and reason.
  [[nodiscard]] tl::expected<void, std::string> publish() {
    file_.close();
    if (!file_ || !sync_file(unfinished_) || std::rename(unfinished_.c_str(), path_.c_str()) != 0 ||
        !sync_folder(path_.parent_path().string()))
      return tl::unexpected(fmt::format("{} ({})", path_.string(), std::strerror(errno)));
    return {};
  }

 private:
  fs::path path_;
  std::string unfinished_;
  std::ofstream file_;
};

CollectedClip collected(const BatchFolder& folder, const Clip& clip) {
  CollectedClip result{clip, read_state(folder, clip.name), std::nullopt};
  if (!result.is_finished()) return result;
  // A clip that failed otherwise has no results, or those of an earlier state of the input.
  const int exit = result.state->exit_code;
  const bool has_results = exit == static_cast<int>(Exit::kMeasured) || exit == static_cast<int>(Exit::kIncomplete) ||
                           exit == static_cast<int>(Exit::kRefused) ||
                           (exit == static_cast<int>(Exit::kInterrupted) && result.state->is_timed_out);
  if (has_results) result.run = read_run_summary(folder.run(clip.name));
  return result;
}

void count(const CollectedClip& clip, BatchTotals& totals) {
  ++totals.clips;
  const Lamp lamp = lamp_of(clip);
  ++totals.count[lamp];
  if (!clip.is_finished()) return;
  totals.wall_s += clip.state->wall_s;
  totals.cpu_s += clip.state->cpu_s;
  if (clip.state->exit_code != 0) ++totals.exit_codes[clip.state->exit_code];
  if ((lamp == Lamp::kRefused || lamp == Lamp::kFailed) && totals.failures.size() < kMaxFailures)
    totals.failures.emplace_back(clip.clip.name, clip.state->message);
}

tl::unexpected<std::string> unwritable_results(const std::string& where) {
  return tl::unexpected(fmt::format("the results cannot be written: {}: free space, then use --collect", where));
}

}  // namespace

tl::expected<BatchTotals, std::string> collect_batch(const BatchFolder& folder,
                                                     const std::function<bool(std::size_t)>& may_continue) {
  auto catalogue = CatalogueWriter::create(folder.catalogue());
  if (!catalogue) return unwritable_results(catalogue.error());
  PiecewiseFile table(folder.table()), page(folder.page());
  const PageParts parts = page_parts();
  table.add(batch_csv_header());
  page.add(parts.before);
  BatchTotals totals;
  bool is_stopped = false;
  std::string problem;
  const auto read = for_each_clip(folder.clips(), [&](const Clip& clip) {
    is_stopped = is_stopped || !may_continue(totals.clips);
    if (is_stopped || !problem.empty()) return;
    const CollectedClip found = collected(folder, clip);
    if (const auto added = catalogue->add(found); !added) problem = added.error();
    table.add(batch_csv_rows(found));
    page.add(totals.clips > 0 ? ",\n" : "\n");
    page.add(page_entry(found));
    count(found, totals);
  });
  if (!read) return tl::unexpected(read.error());
  if (is_stopped) return totals;
  page.add(parts.after);
  if (!problem.empty()) return unwritable_results(problem);
  if (const auto published = catalogue->publish(); !published) return unwritable_results(published.error());
  for (PiecewiseFile* file : {&table, &page})
    if (const auto published = file->publish(); !published) return unwritable_results(published.error());
  return totals;
}

}  // namespace moiregauge::internal
