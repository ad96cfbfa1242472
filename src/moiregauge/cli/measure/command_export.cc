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
#include "moiregauge/io/tables/table_mat.h"
#include "moiregauge/io/tables/table_xlsx.h"
#include "moiregauge/io/tables/uff58.h"

namespace moiregauge::internal::cli {
namespace {

namespace fs = std::filesystem;

struct ExportWords {
  std::string run, format = "wide", output, time, frames, axis, separator, gaps = "refuse";
  std::vector<std::string> markers;
  bool only_ok = false, decimal_comma = false, replace = false, quiet = false;
};

using Text = tl::expected<std::string, std::string>;

struct Layout {
  TableStyle style;
  Gaps gaps = Gaps::kRefuse;
};

// Returns the bytes of a file, or an error if a library gave none.
Text bytes_or_error(std::string bytes, const char* format) {
  if (bytes.empty())
    return tl::unexpected(fmt::format(
        "there is not enough memory or space in the folder for temporary files: --format {}: choose fewer rows with "
        "--frames",
        format));
  return bytes;
}

// Options that a format understands.
struct Format {
  const char* name;
  const char* ending;
  bool has_axis;  // --axis
  bool is_text;   // --separator, --decimal-comma
  Text (*write)(const RunTable&, const Layout&);
};
constexpr std::array kExports{
    Format{"wide", "-wide.csv", true, true,
           [](const RunTable& table, const Layout& to) -> Text { return wide_csv(table, to.style); }},
    Format{"csv", "-wide.csv", true, true,
           [](const RunTable& table, const Layout& to) -> Text { return wide_csv(table, to.style); }},
    Format{"long", "-long.csv", false, true,
           [](const RunTable& table, const Layout& to) -> Text { return long_csv(table, to.style); }},
    Format{"xlsx", ".xlsx", true, false,
           [](const RunTable& table, const Layout& to) { return bytes_or_error(table_xlsx(table, to.style), "xlsx"); }},
    Format{"mat", ".mat", true, false,
           [](const RunTable& table, const Layout& to) { return bytes_or_error(table_mat(table, to.style), "mat"); }},
    Format{"hdf5", ".h5", false, false,
           [](const RunTable& table, const Layout&) { return bytes_or_error(displacement_h5(table), "hdf5"); }},
    Format{"uff58", ".uff", false, false,
           [](const RunTable& table, const Layout& to) { return uff58(table, to.gaps); }},
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

// Reads the options of a text table.
tl::expected<void, UsageError> take_marks(const ExportWords& words, TableStyle& style) {
  if (words.decimal_comma) style.decimal = ',', style.separator = ';';
  if (words.separator.empty()) return {};
  const std::string mark = words.separator == "tab" ? "\t" : words.separator;
  if (mark != "," && mark != ";" && mark != "\t")
    return usage(fmt::format("the separator is unknown: --separator {}: choose one of ',', ';', tab", words.separator));
  style.separator = mark.front();
  if (style.separator != style.decimal) return {};
  return usage("a comma cannot be separator and decimal mark: --decimal-comma: choose --separator ';' or tab");
}

// Reads the options on the form of the table, and refuses those that the format does not know.
tl::expected<Layout, UsageError> layout_of(const ExportWords& words, const Format& format) {
  Layout layout;
  if (words.gaps != "refuse" && words.gaps != "split")
    return usage(fmt::format("the word is unknown: --gaps {}: choose one of refuse, split", words.gaps));
  if (words.gaps != "refuse" && words.format != "uff58")
    return usage(fmt::format("the format {} keeps gaps: --gaps {}: remove it, or give --format uff58", words.format,
                             words.gaps));
  layout.gaps = words.gaps == "split" ? Gaps::kSplit : Gaps::kRefuse;
  if (!words.axis.empty() && words.axis != "x" && words.axis != "y")
    return usage(fmt::format("the axis is unknown: --axis {}: choose one of x, y", words.axis));
  if (!words.axis.empty() && !format.has_axis)
    return usage(fmt::format("the format {} has both axes: --axis {}: give --format csv, xlsx or mat", words.format,
                             words.axis));
  if ((words.decimal_comma || !words.separator.empty()) && !format.is_text)
    return usage(
        fmt::format("the format {} has no separators: --decimal-comma, --separator: give --format csv", words.format));
  layout.style.has_x = words.axis != "y";
  layout.style.has_y = words.axis != "x";
  if (const auto taken = take_marks(words, layout.style); !taken) return tl::unexpected(taken.error());
  return layout;
}

int run(const ExportWords& words) {
  const Format* format = format_named(words.format);
  if (format == nullptr)
    return fail(Exit::kUsage, fmt::format("the format is unknown: --format {}: choose one of wide, csv, long, xlsx, "
                                          "mat, hdf5, uff58",
                                          words.format));
  const auto layout = layout_of(words, *format);
  if (!layout) return fail(Exit::kUsage, layout.error().message);
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
  const auto bytes = format->write(*chosen, *layout);
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
  command->add_option("--format", words->format, "wide or csv (a row per frame), long, xlsx, mat, hdf5 or uff58 [wide]")
      ->type_name("wide|csv|long|xlsx|mat|hdf5|uff58");
  command->add_option("--markers", words->markers, "only these targets: A,B [all]")->type_name("NAMES")->delimiter(',');
  command->add_option("--frames", words->frames, "only these frames, half open: A:B, or seconds, e.g. 1.5s:3s [all]")
      ->type_name("A:B:STEP");
  command->add_option("--time", words->time, "only these seconds, half open: A:B [all]")->type_name("A:B");
  command->add_option("--axis", words->axis, "only this axis, for csv, xlsx and mat [both]")->type_name("x|y");
  command->add_flag("--decimal-comma", words->decimal_comma, "write 1,5 for 1.5, separated by ;");
  command->add_option("--separator", words->separator, "separator of a CSV: , ; or tab [,]")->type_name("CHAR");
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
