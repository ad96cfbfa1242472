// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/command_calibrate.h"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "moiregauge/app/calibrate/calibrate_photos.h"
#include "moiregauge/app/calibrate/calibration_check.h"
#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/length_text.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/plan/calibrate_text.h"

namespace moiregauge::internal::cli {
namespace {

struct CalibrateWords {
  std::vector<std::string> photos;
  std::string pitch;
  std::string output = "camera.toml";
  bool k3 = false;
  bool quiet = false;
};

int run(const CalibrateWords& words) {
  const auto pitch = length_mm(words.pitch);
  if (!pitch)
    return fail(Exit::kUsage, fmt::format("the pitch cannot be read: --pitch {}: {}", words.pitch, pitch.error()));
  const auto solved = [&] {
    Progress progress("reading photographs", words.quiet);
    return calibrate_photos(words.photos, *pitch, {.k3 = words.k3},
                            [&](long done, long expected) { progress.show(done, expected); });
  }();
  if (!solved) return fail(solved.error().exit, solved.error().message);
  const CalibrateReport& report = *solved;
  if (const auto refusal = calibrate_refusal(report, words.photos.front())) return fail(Exit::kRefused, *refusal);
  if (const auto written = write_file_atomically(words.output, camera_text(report)); !written)
    return fail(Exit::kOutputUnwritable,
                fmt::format("the camera file could not be written: {}: free space or choose another file with -o",
                            written.error()));
  if (words.quiet) return 0;
  for (const std::string& warning : calibrate_warnings(report)) print_note(fmt::format("warning: {}\n", warning));
  print_out(fmt::format("{}next: moiregauge measure ... --camera {}\n", calibrate_text(report), words.output));
  return 0;
}

}  // namespace

void add_calibrate(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("calibrate", "Solve a camera and its lens from photographs of a printed board");
  auto words = std::make_shared<CalibrateWords>();
  command->add_option("PHOTOS", words->photos, "photographs of one flat printed board, or folders of them")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--pitch", words->pitch, "pitch of the board with its unit, e.g. 10mm (checkerboard: two squares)")
      ->type_name("LENGTH")
      ->required();
  command->add_option("-o,--out", words->output, "camera file to write [camera.toml]")->type_name("FILE");
  command->add_flag("--k3", words->k3, "also solve k3, for very wide lenses");
  command->add_flag("--quiet", words->quiet, "print nothing but errors");
  command->callback([words, &exit_code] { exit_code = run(*words); });
}

}  // namespace moiregauge::internal::cli
