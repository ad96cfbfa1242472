// SPDX-License-Identifier: Apache-2.0
// Measures the fault corpus and prints a Markdown table.
//
//     fault_study [--group scene|processing] [--modes WORD[+WORD]...] [--runs N] [--seed S] [--threads N] [--strengths] [--verbose]
//
// One row per mode (whose name starts with a WORD), or per strength. Progress is printed to stderr.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "faults/fault_run.h"

namespace moiregauge::internal::faults {
namespace {

constexpr int kMinRuns = 7;  // least runs of each strength; chosen
// Least sequences of each mode. With nine rows each, 1 % of the rows is four rows, more than a single sequence's bad
// luck.
constexpr int kMinSequences = 42;

struct Words {
  std::string modes;
  std::string group;  // "scene" or "processing"; empty: both
  int runs = 0;       // for each strength; 0: the default
  int seed = 0;
  int threads = 2;
  bool strengths = false;
  bool verbose = false;
};

// One sequence to measure. Threads take them by number.
struct Task {
  const Mode* mode;
  std::size_t strength;
  int seed;
};

// Returns true if the name starts with one of the beginnings, e.g. "fold+glare".
bool is_wanted(const std::string& name, const std::string& beginnings) {
  std::size_t from = 0;
  while (true) {
    const std::size_t to = beginnings.find('+', from);
    if (name.starts_with(beginnings.substr(from, to - from))) return true;
    if (to == std::string::npos) return false;
    from = to + 1;
  }
}

std::vector<Task> tasks_of(const Words& words) {
  std::vector<Task> tasks;
  for (const Mode& mode : modes()) {
    if (!is_wanted(mode.name, words.modes)) continue;
    if (!words.group.empty() && mode.processed != (words.group == "processing")) continue;
    const int strengths = static_cast<int>(mode.strengths.size());
    const int runs = words.runs > 0 ? words.runs : std::max(kMinRuns, (kMinSequences + strengths - 1) / strengths);
    for (std::size_t strength = 0; strength < mode.strengths.size(); ++strength) {
      for (int run = 0; run < runs; ++run) tasks.push_back({&mode, strength, words.seed + run});
    }
  }
  return tasks;
}

void print_verdict(const Task& task, const Verdict& v) {
  std::string statuses;
  for (const auto& [word, count] : v.statuses) statuses += fmt::format(" {} {}", count, word);
  fmt::print(stderr, "  {}, {}, seed {}: {} ok,{} lies {}, worst {:.1f} u {:.2f} um, u {:.2f} um {}\n", task.mode->name,
             task.mode->strengths[task.strength].words, task.seed, v.ok, statuses, v.lies, v.worst_u, v.worst_um,
             v.median_u_um, v.refusal);
  for (const std::string& warning : v.warnings) fmt::print(stderr, "      {}\n", warning);
}

std::vector<Verdict> verdicts_on(const std::vector<Task>& tasks, const Words& words, const std::string& folder) {
  std::vector<Verdict> verdicts(tasks.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::size_t done = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < tasks.size(); i = next++) {
      const Task& task = tasks[i];
      verdicts[i] = verdict_on(sequence_of(*task.mode, task.strength, task.seed), folder);
      const std::scoped_lock lock(mutex);
      if (words.verbose) print_verdict(task, verdicts[i]);
      if (++done % 20 == 0) fmt::print(stderr, "{} of {} sequences\n", done, tasks.size());
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < words.threads; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  return verdicts;
}

struct Tally {
  int sequences = 0, rows = 0, ok = 0, lies = 0, lying_sequences = 0, refused = 0;
  double worst_u = 0.0, worst_um = 0.0;
  std::vector<double> u_um;
  std::map<std::string, int> statuses;

  void add(const Verdict& v) {
    ++sequences;
    rows += v.rows;
    ok += v.ok;
    lies += v.lies;
    lying_sequences += v.lies > 0;
    for (const auto& [word, count] : v.statuses) statuses[word] += count;
    worst_u = std::max(worst_u, v.worst_u);
    worst_um = std::max(worst_um, v.worst_um);
    if (v.ok > 0) u_um.push_back(v.median_u_um);
  }
  [[nodiscard]] double percent(int part) const { return rows == 0 ? 0.0 : 100.0 * part / rows; }
  [[nodiscard]] double median_u() const {
    std::vector<double> sorted = u_um;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? 0.0 : sorted[sorted.size() / 2];
  }
};

std::string others(const Tally& tally) {
  std::string text;
  for (const auto& [word, count] : tally.statuses)
    text += fmt::format("{}{:.1f} {}", text.empty() ? "" : ", ", tally.percent(count), word);
  return text.empty() ? "-" : text;
}

void print_row(const std::string& name, const Tally& t) {
  fmt::print("| {} | {} | {} | {:.1f} | {} | {} ({:.2f}) | {} | {:.1f} | {:.2f} | {:.2f} |\n", name, t.sequences,
             t.rows, t.percent(t.ok), others(t), t.lies, t.percent(t.lies), t.lying_sequences, t.worst_u, t.worst_um,
             t.median_u());
}

void print_table(const std::vector<Task>& tasks, const std::vector<Verdict>& verdicts, const Words& words) {
  fmt::print(
      "| mode | sequences | rows | % ok | % others | silent lies (%) | sequences with any | worst ok error, u | um | "
      "median u of dy, um |\n|---|---|---|---|---|---|---|---|---|---|\n");
  Tally faulty, clean, stated_by_site;
  for (std::size_t i = 0; i < tasks.size();) {
    const Mode& mode = *tasks[i].mode;
    Tally all;
    std::map<std::size_t, Tally> by_strength;
    for (; i < tasks.size() && tasks[i].mode == &mode; ++i) {
      Tally& sum = mode.clean ? clean : mode.stated_by_site ? stated_by_site : faulty;
      for (Tally* tally : {&all, &by_strength[tasks[i].strength], &sum}) tally->add(verdicts[i]);
    }
    print_row(fmt::format("**{}**: {}", mode.name, mode.what), all);
    if (!words.strengths) continue;
    for (const auto& [strength, tally] : by_strength) print_row("- " + mode.strengths[strength].words, tally);
  }
  print_row("all faults except wrong statements in site.toml", faulty);
  fmt::print("\n{} sequences. ", tasks.size());
  if (faulty.rows > 0)
    fmt::print("Silent lies: {} of {} rows with a fault, {:.2f} %. ", faulty.lies, faulty.rows,
               faulty.percent(faulty.lies));
  if (clean.rows > 0) {
    fmt::print("False alarms: {} of {} clean rows, {:.2f} %; silent lies among them: {}. ", clean.rows - clean.ok,
               clean.rows, clean.percent(clean.rows - clean.ok), clean.lies);
  }
  fmt::print("\n");
}

Words words_of(int argc, char** argv) {
  Words words;
  const std::map<std::string, int*> numbers{
      {"--runs", &words.runs}, {"--seed", &words.seed}, {"--threads", &words.threads}};
  const std::map<std::string, bool*> flags{{"--strengths", &words.strengths}, {"--verbose", &words.verbose}};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (const auto flag = flags.find(word); flag != flags.end()) {
      *flag->second = true;
    } else if (const auto number = numbers.find(word); number != numbers.end() && i + 1 < argc) {
      *number->second = std::atoi(argv[++i]);
    } else if (word == "--modes" && i + 1 < argc) {
      words.modes = argv[++i];
    } else if (word == "--group" && i + 1 < argc) {
      words.group = argv[++i];
    } else {
      fmt::print(stderr,
                 "error: bad option: {}: --group scene|processing, --modes WORD[+WORD]..., --runs N, --seed S, "
                 "--threads N, --strengths or --verbose\n",
                 word);
      std::exit(2);
    }
  }
  return words;
}

int study(const Words& words) {
  const std::vector<Task> tasks = tasks_of(words);
  if (tasks.empty()) {
    fmt::print(stderr, "error: no such mode: {}: known are", words.modes);
    for (const Mode& mode : modes()) fmt::print(stderr, " '{}'", mode.name);
    fmt::print(stderr, "\n");
    return 2;
  }
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("moiregauge-faults-{}", ::getpid());
  std::filesystem::create_directories(folder);
  const std::vector<Verdict> verdicts = verdicts_on(tasks, words, folder.string());
  std::filesystem::remove_all(folder);
  print_table(tasks, verdicts, words);
  return 0;
}

}  // namespace
}  // namespace moiregauge::internal::faults

int main(int argc, char** argv) {
  return moiregauge::internal::faults::study(moiregauge::internal::faults::words_of(argc, argv));
}
