// SPDX-License-Identifier: Apache-2.0
// The command line as a whole: the main file needs no header of CLI11.
#pragma once

namespace moiregauge::internal::cli {

// Parses the command line and runs the command. Returns the exit code. A mistake in the command line is printed.
[[nodiscard]] int run_program(int argc, char** argv);

}  // namespace moiregauge::internal::cli
