// SPDX-License-Identifier: Apache-2.0
// The program: a table of commands. Each command reports its own failures. Anything else is an internal error (exit 1).
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>
#include <CLI/CLI.hpp>

#include "moiregauge/cli/commands.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/help/command_help.h"
#include "moiregauge/cli/help/usage.h"
#include "moiregauge/phase/fit/simd_target.h"

namespace {

using moiregauge::internal::Exit;

// For comparisons: the results have the same bits for every choice.
constexpr const char* kSimd = "MOIREGAUGE_SIMD";

int run(int argc, char** argv) {
  if (const char* simd = std::getenv(kSimd); simd != nullptr && !moiregauge::internal::use_simd_target(simd))
    return moiregauge::internal::cli::fail(Exit::kUsage,
                                           fmt::format("the processor is unknown: {}={}: choose one of {}", kSimd, simd,
                                                       fmt::join(moiregauge::internal::simd_targets(), ", ")));
  int exit_code = 0;
  const auto tree = moiregauge::internal::cli::command_tree(exit_code);
  CLI::App& app = *tree;
  if (argc < 2) {
    moiregauge::internal::cli::print_out(moiregauge::internal::cli::first_text(app));
    return static_cast<int>(Exit::kUsage);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForAllHelp&) {
    const auto asked = app.get_subcommands();
    moiregauge::internal::cli::show_page(asked.empty() ? "moiregauge" : asked.front()->get_name());
    return 0;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& error) {
    return moiregauge::internal::cli::fail(Exit::kUsage, moiregauge::internal::cli::usage_mistake(app, error));
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);           // a file size limit acts like a full disk: the write fails
  FLAGS_minloglevel = google::GLOG_FATAL;  // the solver logs every shortened step; only its result matters
  int exit_code = 0;
  try {
    exit_code = run(argc, argv);
  } catch (const std::system_error& error) {
    const bool lacks_threads = error.code() == std::errc::resource_unavailable_try_again;
    exit_code = moiregauge::internal::cli::fail(
        lacks_threads ? Exit::kOutputUnwritable : Exit::kInternalError,
        lacks_threads
            ? fmt::format("no thread could be started: {}: raise the limit on processes (ulimit -u)", error.what())
            : fmt::format("an internal error occurred: {}: report this with the input", error.what()));
  } catch (const std::exception& error) {
    exit_code = moiregauge::internal::cli::fail(
        Exit::kInternalError, fmt::format("an internal error occurred: {}: report this with the input", error.what()));
  }
  if (moiregauge::internal::cli::finish_output()) return exit_code;
  return moiregauge::internal::cli::fail(
      Exit::kOutputUnwritable,
      fmt::format("the output was lost: standard output ({}): free space, or write to another file",
                  std::strerror(errno)));
}
