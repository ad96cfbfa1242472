// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/command_sheet.h"

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/measure/summary_text.h"
#include "moiregauge/cli/plan/sheet_args.h"
#include "moiregauge/io/config/site_file.h"
#include "moiregauge/io/run_dir/file_set.h"
#include "moiregauge/sheet/sheet_files.h"

namespace moiregauge::internal::cli {
namespace {

// Returns the date of a reproducible build (SOURCE_DATE_EPOCH, reproducible-builds.org). Without it the files have no
// date.
std::string date_of_files() {
  const char* text = std::getenv("SOURCE_DATE_EPOCH");
  if (text == nullptr) return {};
  std::time_t seconds = 0;
  const auto [end, error] = std::from_chars(text, text + std::strlen(text), seconds);
  std::tm parts{};
  if (error != std::errc{} || *end != '\0' || ::gmtime_r(&seconds, &parts) == nullptr) return {};
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", parts);
}

std::string site_text(const sheet::SheetSet& set) {
  return "# The markers of sheets.pdf at their planned positions. Replace them with the positions as mounted, and set "
         "the\n"
         "# z_mm of a target in front of the references or behind them. [known_to] states how well you measured.\n" +
         write_site(set.site);
}

std::size_t page_count(const sheet::SheetSet& set) {
  std::size_t pages = 0;
  for (const sheet::Sheet& sheet : set.sheets)
    pages += sheet.tiling ? static_cast<std::size_t>(sheet.tiling->columns * sheet.tiling->rows) : 1U;
  return pages;
}

// Returns "NW 3 x 2, T1 2 x 2": columns and rows of the markers that are printed in parts.
std::string parts_text(const sheet::SheetSet& set) {
  std::string text;
  for (const sheet::Sheet& sheet : set.sheets) {
    if (sheet.tiling)
      text +=
          fmt::format("{}{} {} x {}", text.empty() ? "" : ", ", sheet.name, sheet.tiling->columns, sheet.tiling->rows);
  }
  return text;
}

int run(const SheetArgs& args) {
  const auto order = parse_sheet_options(args);
  if (!order) return fail(Exit::kUsage, order.error().message);
  const auto set = sheet::sheets_of(order->site, order->page);
  if (!set) return fail(Exit::kUsage, fmt::format("the sheets cannot be laid out: sheet: {}", set.error()));
  const sheet::SheetFiles files = sheet::files_of(*set, order->ink, date_of_files());
  std::vector<NamedBytes> named{
      {"sheets.pdf", files.pdf}, {"mounting.pdf", files.plan}, {"site.toml", site_text(*set)}};
  for (const auto& [name, text] : files.svg) named.emplace_back(name + ".svg", text);
  for (const auto& [name, bytes] : named) {
    if (bytes.empty())
      return fail(Exit::kInternalError,
                  fmt::format("{} could not be drawn: out of memory: choose a smaller --paper", name));
  }
  const auto written = write_file_set(args.output, named, args.replace ? Existing::kReplace : Existing::kRefuse);
  if (!written) return fail_output(written.error());
  if (args.quiet) return 0;
  if (!order->note.empty()) print_note("note: " + order->note + "\n");
  if (const std::string parts = parts_text(*set); !parts.empty())
    print_note(fmt::format("note: markers larger than {} are printed in parts, to be cut and joined: {}\n",
                           order->page.paper.name, parts));
  const std::size_t pages = page_count(*set);
  print_out(fmt::format("{} marker{} on {} sheet{} of {}: {}/sheets.pdf\n", set->site.markers.size(),
                        set->site.markers.size() == 1 ? "" : "s", pages, pages == 1 ? "" : "s", order->page.paper.name,
                        args.output));
  print_out(fmt::format("positions: {0}/site.toml; mounting plan: {0}/mounting.pdf\n", args.output));
  print_out(fmt::format(
      "next: print at 100 %, check the rulers, mount and film, then run: moiregauge measure CLIP --site {}/site.toml\n",
      args.output));
  return 0;
}

}  // namespace

void add_sheet(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("sheet", "Make marker sheets to print (PDF, SVG), with their site.toml");
  auto args = std::make_shared<SheetArgs>();
  add_layout_options(*command, args->layout);
  command->add_option("--paper", args->paper, "A0 to A5, letter, legal, tabloid, or a size such as 300x400mm [A4]")
      ->type_name("SIZE");
  command->add_option("--orientation", args->orientation, "auto, portrait or landscape [auto]")->type_name("WORD");
  command->add_flag("--separate", args->separate, "put every marker on a sheet of its own");
  command->add_flag("--inverted", args->inverted, "print light lines on dark (circles remain dark)");
  command->add_option("--ink", args->ink_percent, "darkness of the ink, per cent of black [100]")->type_name("PERCENT");
  command
      ->add_option("--gamma", args->gamma,
                   "of a cosine grating: 1 for video cameras and phones, 2.2 for cameras with linear output [1]")
      ->type_name("G");
  command->add_option("-o,--out", args->output, "folder to write [sheets]")->type_name("DIR");
  command->add_flag("--replace", args->replace, "replace an earlier set in DIR");
  command->add_flag("--quiet", args->quiet, "print nothing but errors");
  command->callback([args, &exit_code] { exit_code = run(*args); });
}

}  // namespace moiregauge::internal::cli
