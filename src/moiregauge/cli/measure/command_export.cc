// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/measure/command_export.h"

#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "moiregauge/app/frame_range_text.h"
#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/io/tables/displacement_h5.h"
#include "moiregauge/io/tables/table_csv.h"
#include "moiregauge/io/tables/uff58.h"

namespace moiregauge::internal::cli {
namespace {

namespace fs = std::filesystem;

struct ExportWords {
  std::string run, format = "wide", output, time, frames, gaps = "refuse";
  std::vector<std::string> markers;
  bool only_ok = false, replace = false, quiet = false;
};

using Text = tl::expected<std::string, std::string>;

Text hdf5_of(const RunTable& table, Gaps) {
  std::string bytes = displacement_h5(table);
  if (bytes.empty())
    return tl::unexpected(std::string("there is not enough memory: --format hdf5: choose fewer rows with --frames"));
  return bytes;
}

struct Format {
  const char* name;
  const char* ending;
  Text (*write)(const RunTable&, Gaps);
};
constexpr std::array kExports{
    Format{"wide", "-wide.csv", [](const RunTable& table, Gaps) -> Text { return wide_csv(table); }},
    Format{"long", "-long.csv", [](const RunTable& table, Gaps) -> Text { return long_csv(table); }},
    Format{"hdf5", ".h5", hdf5_of},
    Format{"uff58", ".uff", uff58},
};

const Format* format_named(const std::string& name) {
  for (const Format& format : kExports) {
    if (name == format.name) return &format;
  }
  return nullptr;
}

// Reads --frames, or the seconds of --time.
tl::expected<FrameRange, UsageError> range_of(const ExportWords& words) {
  if (!words.time.empty() && !words.frames.empty())
    return usage("--time and --frames exclude each other: export: give one of them");
  if (!words.frames.empty()) return frame_range_in(words.frames, kFramesOption);
  if (!words.time.empty()) return seconds_in_range(words.time, kTimeOption);
  return FrameRange{};
}

constexpr const char* kStandardOutput = "-";

// Only a plain file may be replaced, and no file of a run.
std::optional<std::string> output_problem(const ExportWords& words, const std::string& output) {
  std::error_code error;
  const fs::file_status there = fs::symlink_status(output, error);
  if (!fs::exists(there)) return std::nullopt;
  if (!fs::is_regular_file(there))
    return fmt::format("the output is {}, not a plain file: {}: choose another with -o, or - for stdout",
                       fs::is_symlink(there) ? "a link" : kind_unless_plain(output), output);
  const fs::path folder = fs::path(output).has_parent_path() ? fs::path(output).parent_path() : fs::path(".");
  if (fs::equivalent(folder, words.run, error))
    return fmt::format("the output is part of the run: {}: choose a file outside the run with -o", output);
  if (words.replace) return std::nullopt;
  return fmt::format("the output file exists: {}: choose another with -o, or give --replace", output);
}

int run(const ExportWords& words) {
  const Format* format = format_named(words.format);
  if (format == nullptr)
    return fail(Exit::kUsage,
                fmt::format("the format is unknown: --format {}: choose one of wide, long, hdf5, uff58", words.format));
  if (words.gaps != "refuse" && words.gaps != "split")
    return fail(Exit::kUsage, fmt::format("the word is unknown: --gaps {}: choose one of refuse, split", words.gaps));
  if (words.gaps != "refuse" && words.format != "uff58")
    return fail(Exit::kUsage, fmt::format("the format {} keeps gaps: --gaps {}: remove it, or give --format uff58",
                                          words.format, words.gaps));
  const auto range = range_of(words);
  if (!range) return fail(Exit::kUsage, range.error().message);
  const std::string output = words.output.empty() ? default_output(words.run, format->ending) : words.output;
  const bool to_stdout = output == kStandardOutput;
  if (!to_stdout) {
    if (const auto problem = output_problem(words, output)) return fail(Exit::kUsage, *problem);
  }
  auto table = read_run_table(words.run);
  if (!table) return fail(Exit::kInputUnreadable, table.error());
  if (!table->complete && !words.quiet)
    print_note(fmt::format(
        "warning: the exported samples are incomplete: {} was interrupted, or its input is damaged\n", words.run));
  const auto chosen = selected(*std::move(table), {words.markers, *range, words.only_ok});
  if (!chosen) return fail(Exit::kUsage, chosen.error());
  const auto bytes = format->write(*chosen, words.gaps == "split" ? Gaps::kSplit : Gaps::kRefuse);
  if (!bytes) return fail(Exit::kUsage, bytes.error());
  if (to_stdout) {
    put_bytes(*bytes);
    return 0;
  }
  if (const auto written = write_file_atomically(output, *bytes); !written)
    return fail(
        Exit::kOutputUnwritable,
        fmt::format("the file could not be written: {}: free space or choose another with -o", written.error()));
  if (!words.quiet)
    print_out(fmt::format("{}: {} rows of {} target{}\n", output, chosen->samples.size(), chosen->markers.size(),
                          chosen->markers.size() == 1 ? "" : "s"));
  return 0;
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("export", "Write the samples of a finished run for other programs");
  auto words = std::make_shared<ExportWords>();
  command->add_option("DIR", words->run, "folder that `measure` wrote")->type_name("DIR")->required();
  command->add_option("--format", words->format, "wide, long (CSV), hdf5 or uff58 [wide]")
      ->type_name("wide|long|hdf5|uff58");
  command->add_option("--markers", words->markers, "only these targets: A,B [all]")->type_name("NAMES")->delimiter(',');
  command->add_option("--frames", words->frames, "only these frames, half open: A:B, or seconds, e.g. 1.5s:3s [all]")
      ->type_name("A:B:STEP");
  command->add_option("--time", words->time, "only these seconds, half open: A:B [all]")->type_name("A:B");
  command->add_flag("--only-ok", words->only_ok, "write NaN for rows that are not `ok`");
  command
      ->add_option("--gaps", words->gaps,
                   "uff58, which cannot hold gaps: refuse, or split into stretches without gaps [refuse]")
      ->type_name("refuse|split");
  command
      ->add_option("-o,--out", words->output,
                   "file to write, - for stdout [<run>-wide.csv, <run>.h5, ... in the current folder]")
      ->type_name("FILE");
  command->add_flag("--replace", words->replace, "replace an existing file");
  command->add_flag("--quiet", words->quiet, "print nothing but errors");
  command->callback([words, &exit_code] { exit_code = run(*words); });
}

}  // namespace moiregauge::internal::cli
