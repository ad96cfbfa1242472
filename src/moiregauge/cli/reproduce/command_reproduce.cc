// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/reproduce/command_reproduce.h"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/output_folder.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/reproduce/reproduce_figures.h"
#include "moiregauge/cli/reproduce/reproduce_table.h"

namespace moiregauge::internal::cli {
namespace {

namespace fs = std::filesystem;
using Written = tl::expected<void, std::string>;

struct ReproduceWords {
  std::string output = "reproduced";
  int threads = 0;
  bool quick = false;
  bool quiet = false;
};

// Checks the folder before minutes of measuring. Replaces the old table first: a folder with a finished table is
// complete.
Written make_ready(const fs::path& output) {
  std::error_code error;
  fs::create_directories(output, error);
  if (error) return tl::unexpected(fmt::format("{}: {}", output.string(), error.message()));
  return write_file_atomically((output / "table.md").string(), "Not finished.\n");
}

Written write_figures(const std::vector<FigureJob>& jobs, const ReproduceWords& words) {
  Progress progress("drawing", words.quiet);
  long done = 0;
  for (const FigureJob& job : jobs) {
    const figure::FigureFiles files = job.make();
    const auto write = [&](const char* kind, std::string_view bytes) -> Written {
      const std::string path = (fs::path(words.output) / fmt::format("{}.{}", job.name, kind)).string();
      if (bytes.empty()) return tl::unexpected(path + ": out of memory");
      return write_file_atomically(path, bytes);
    };
    auto written = write("png", files.png).and_then([&] { return write("svg", files.svg); }).and_then([&] {
      return write("pdf", files.pdf);
    });
    if (!written) return written;
    progress.show(++done, static_cast<long>(jobs.size()));
  }
  return {};
}

int fail_to_write(const std::string& why) {
  return fail(Exit::kOutputUnwritable,
              fmt::format("the results could not be written: {}: free space or choose another folder with -o", why));
}

tl::expected<std::vector<CellRun>, std::string> measured(const ReproducePlan& plan, bool quiet) {
  Progress progress("measuring", quiet);
  const long cells = static_cast<long>(plan.cases.size() * plan.lenses.size());
  return run_plan(plan, [&](long done) { progress.show(done, cells); });
}

int run(const ReproduceWords& words) {
  const fs::path output = words.output;
  if (!is_free(output, "table.md")) {
    return fail(Exit::kUsage,
                fmt::format("the output folder holds other files: {}: choose another with -o", output.string()));
  }
  if (const auto ready = make_ready(output); !ready) return fail_to_write(ready.error());
  ReproducePlan plan = words.quick ? quick_plan() : paper_plan();
  plan.threads = words.threads;
  const auto cells = measured(plan, words.quiet);
  if (!cells)
    return fail(Exit::kInternalError, fmt::format("an internal error occurred: {}: report this", cells.error()));
  const std::string table = reproduce_table(plan, *cells, words.quick);
  const auto written = write_figures(figure_jobs(plan, *cells), words).and_then([&] {
    return write_file_atomically((output / "table.md").string(), table);
  });
  if (!written) return fail_to_write(written.error());
  print_out(table);
  if (!words.quiet) print_note(fmt::format("table and figures are in {}\n", output.string()));
  return 0;
}

}  // namespace

void add_reproduce(CLI::App& app, int& exit_code) {
  const auto words = std::make_shared<ReproduceWords>();
  CLI::App* command =
      app.add_subcommand("reproduce", "Repeat the paper's section 3 on simulated recordings: table and figures");
  command->add_option("-o,--out", words->output, "folder to write [reproduced]")->type_name("DIR");
  command->add_flag("--quick", words->quick, "use the small rig and a few frames (seconds instead of minutes)");
  command->add_option("--threads", words->threads, "number of threads, never changes a number [all]")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N")
      ->check(CLI::Validator(CLI::NonNegativeNumber).description(""));
  command->add_flag("--quiet", words->quiet, "print nothing but the table and errors");
  command->callback([words, &exit_code] { exit_code = run(*words); });
}

}  // namespace moiregauge::internal::cli
