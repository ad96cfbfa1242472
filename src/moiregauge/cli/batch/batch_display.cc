// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/batch/batch_display.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {
namespace {

constexpr double kQuiet_s = 2.0, kRefresh_s = 0.2;
constexpr std::size_t kBatchBar = 24;
constexpr std::size_t kMaxBusy = 5;  // clips that are named

std::string time_text(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

std::size_t count_of_lamp(const BatchTotals& totals, Lamp lamp) {
  const auto found = totals.count.find(lamp);
  return found == totals.count.end() ? 0 : found->second;
}

const char* meaning(int exit) {
  switch (exit) {
    case 1:
      return "internal error";
    case 2:
      return "usage or configuration";
    case 3:
      return "input unreadable or unsupported";
    case 4:
      return "refused";
    case 5:
      return "incomplete";
    case 6:
      return "output cannot be written";
    case 130:
      return "stopped by the time limit";
    default:
      return "the process was killed";
  }
}

}  // namespace

std::string batch_line(const BatchProgress& progress, double elapsed_s) {
  const std::size_t done = progress.skipped + progress.ended;
  const std::size_t filled = progress.clips > 0 ? kBatchBar * done / progress.clips : 0;
  std::string line = fmt::format("batch [{}{}] {}/{} clips", std::string(filled, '#'),
                                 std::string(kBatchBar - filled, '.'), done, progress.clips);
  if (progress.failed > 0) line += fmt::format(", {} failed", progress.failed);
  line += fmt::format(", {} running", progress.running);
  if (progress.busy > 0) line += fmt::format(", {} measured by other processes", progress.busy);
  if (progress.ended > 0)
    line += fmt::format(", {} left", time_text(elapsed_s * static_cast<double>(progress.clips - done) /
                                               static_cast<double>(progress.ended)));
  return line;
}

BatchLine::BatchLine(bool quiet) : is_wanted_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

BatchLine::~BatchLine() { clear(); }

void BatchLine::clear() {
  if (is_shown_) fmt::print(stderr, "\r\x1b[K");
  is_shown_ = false;
}

void BatchLine::show(const BatchProgress& progress) {
  show_text(batch_line(progress, std::chrono::duration<double>(Clock::now() - start_).count()));
}

void BatchLine::show_text(const std::string& text) {
  if (!is_wanted_) return;
  const auto now = Clock::now();
  if (std::chrono::duration<double>(now - start_).count() < kQuiet_s ||
      std::chrono::duration<double>(now - last_).count() < kRefresh_s)
    return;
  last_ = now;
  is_shown_ = true;
  fmt::print(stderr, "\r\x1b[K{}", text);
  std::fflush(stderr);
}

std::string totals_text(const BatchTotals& totals, std::size_t skipped, const std::string& folder) {
  std::string outcomes;
  for (const Lamp lamp : {Lamp::kMeasured, Lamp::kIncomplete, Lamp::kRefused, Lamp::kFailed, Lamp::kWaiting}) {
    const std::size_t count = count_of_lamp(totals, lamp);
    if (count > 0) outcomes += fmt::format("{}{} {}", outcomes.empty() ? "" : ", ", count, word_for(lamp));
  }
  std::string text = fmt::format("found: {} clip{} in {}{}\nresult: {}\n", totals.clips, totals.clips == 1 ? "" : "s",
                                 folder, skipped > 0 ? fmt::format(" ({} finished before)", skipped) : "", outcomes);
  for (const auto& [exit, count] : totals.exit_codes)
    text += fmt::format("        exit {}: {} clip{} ({})\n", exit, count, count == 1 ? "" : "s", meaning(exit));
  for (const auto& [name, message] : totals.failures) text += fmt::format("        {}: {}\n", name, message);
  return text + fmt::format("next: open {}/index.html in a browser; {}/batch.csv has one row per clip and target\n",
                            folder, folder);
}

std::string busy_text(const std::vector<std::string>& names, const std::string& folder) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxBusy); ++i)
    text += fmt::format(
        "warning: {0} is not measured so far: another process is measuring into {1}/{0}.unfinished. Repeat the command "
        "when it has ended.\n",
        names[i], folder);
  if (names.size() > kMaxBusy)
    text +=
        fmt::format("warning: {} more clips are not measured so far for the same reason\n", names.size() - kMaxBusy);
  return text;
}

Exit exit_of_batch(const BatchTotals& totals) {
  const std::size_t measured = count_of_lamp(totals, Lamp::kMeasured);
  if (measured == totals.clips) return Exit::kMeasured;
  const bool is_hopeless =
      measured + count_of_lamp(totals, Lamp::kIncomplete) + count_of_lamp(totals, Lamp::kWaiting) == 0;
  return is_hopeless ? Exit::kRefused : Exit::kIncomplete;
}

}  // namespace moiregauge::internal::cli
