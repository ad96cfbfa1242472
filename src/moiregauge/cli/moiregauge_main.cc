// SPDX-License-Identifier: Apache-2.0
// The program: a table of commands. Every command says what went wrong itself; what escapes it is our fault (exit 1).
#include <csignal>
#include <cstdlib>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include "moiregauge/cli/command_calibrate.h"
#include "moiregauge/cli/command_inspect.h"
#include "moiregauge/cli/command_measure.h"
#include "moiregauge/cli/command_reproduce.h"
#include "moiregauge/cli/command_simulate.h"
#include "moiregauge/cli/command_solve.h"
#include "moiregauge/cli/exit_line.h"
#include "moiregauge/phase/simd_target.h"
#include "moiregauge/version.h"

namespace {

using moiregauge::Exit;

// For comparisons: the bits are the same whatever is chosen.
constexpr const char* kSimd = "MOIREGAUGE_SIMD";

int run(int argc, char** argv) {
  if (const char* simd = std::getenv(kSimd); simd != nullptr && !moiregauge::use_simd_target(simd))
    return moiregauge::cli::fail(Exit::kUsage, fmt::format("{}={}: this machine has {}", kSimd, simd,
                                                           fmt::join(moiregauge::simd_targets(), ", ")));
  CLI::App app{"moiregauge: displacement in millimetres from a video of printed gratings, whatever the camera did"};
  app.set_version_flag("--version", moiregauge::kVersion);
  app.require_subcommand(1);
  int exit_code = 0;
  moiregauge::cli::add_measure(app, exit_code);
  moiregauge::cli::add_solve(app, exit_code);
  moiregauge::cli::add_inspect(app, exit_code);
  moiregauge::cli::add_calibrate(app, exit_code);
  moiregauge::cli::add_simulate(app, exit_code);
  moiregauge::cli::add_reproduce(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& error) {
    return moiregauge::cli::fail(Exit::kUsage, fmt::format("usage: {}: see moiregauge --help", error.what()));
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);           // a limit on the size of files is like a full disk: the write says so
  FLAGS_minloglevel = google::GLOG_FATAL;  // the bundle's solver writes of every step it shortens; we say how it ended
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    return moiregauge::cli::fail(Exit::kInternalError,
                                 fmt::format("internal error: {}: please report it with the input", error.what()));
  }
}
