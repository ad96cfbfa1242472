// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/program.h"

#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "moiregauge/app/simulation/prove_installation.h"
#include "moiregauge/cli/commands.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/help/command_help.h"
#include "moiregauge/cli/help/usage.h"
#include "moiregauge/phase/fit/simd_target.h"
#include "moiregauge/version.h"

namespace moiregauge::internal::cli {
namespace {

// For comparisons: the results have the same bits for every choice.
constexpr const char* kSimd = "MOIREGAUGE_SIMD";

int report_self_test() {
  const auto figures = run_self_test();
  if (!figures) return fail(Exit::kInternalError, fmt::format("the self-test failed: {}", figures.error()));
  print_out(fmt::format(
      "self-test passed: moiregauge {} measured {} frames of a video, {} samples ok, largest error {:.4f} mm "
      "({:.1f} u)\n",
      kVersion, figures->frames, figures->samples, figures->largest_error_mm, figures->largest_ratio));
  return 0;
}

}  // namespace

int run_program(int argc, char** argv) {
  if (const char* simd = std::getenv(kSimd); simd != nullptr && !use_simd_target(simd))
    return fail(Exit::kUsage, fmt::format("the processor is unknown: {}={}: choose one of {}", kSimd, simd,
                                          fmt::join(simd_targets(), ", ")));
  int exit_code = 0;
  const auto tree = command_tree(exit_code);
  CLI::App& app = *tree;
  if (argc < 2) {
    print_out(first_text(app));
    return static_cast<int>(Exit::kUsage);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForAllHelp&) {
    const auto asked = app.get_subcommands();
    show_page(asked.empty() ? "moiregauge" : asked.front()->get_name());
    return 0;
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CallForSelfTest&) {
    return report_self_test();
  } catch (const CLI::ParseError& error) {
    return fail(Exit::kUsage, usage_mistake(app, error));
  }
  return exit_code;
}

}  // namespace moiregauge::internal::cli
