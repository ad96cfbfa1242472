// SPDX-License-Identifier: Apache-2.0
// The program: a table of commands. Each command reports its own failures. Anything else is an internal error (exit 1).
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

#include <fmt/format.h>
#include <glog/logging.h>

#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/program.h"

using moiregauge::internal::Exit;

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);           // a file size limit acts like a full disk: the write fails
  FLAGS_minloglevel = google::GLOG_FATAL;  // the solver logs every shortened step; only its result matters
  int exit_code = 0;
  try {
    exit_code = moiregauge::internal::cli::run_program(argc, argv);
  } catch (const std::system_error& error) {
    const bool lacks_threads = error.code() == std::errc::resource_unavailable_try_again;
    exit_code = moiregauge::internal::cli::fail(
        lacks_threads ? Exit::kOutputUnwritable : Exit::kInternalError,
        lacks_threads
            ? fmt::format("no thread could be started: {}: raise the limit on processes (ulimit -u)", error.what())
            : fmt::format("an internal error occurred: {}: report this with the input", error.what()));
  } catch (const std::bad_alloc&) {
    exit_code = moiregauge::internal::cli::fail(
        Exit::kOutputUnwritable,
        "there is not enough memory (std::bad_alloc): free memory, or raise its limit (ulimit -v)");
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
