// SPDX-License-Identifier: Apache-2.0
// Prints a Markdown table per selected section, by default all of them.
//
//     trust_study [--coverage] [--order] [--reference] [--runs N] [--only WORD] [--verbose]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "studies/trust_coverage.h"
#include "studies/trust_order.h"
#include "studies/trust_reference.h"

int main(int argc, char** argv) {
  using namespace moiregauge::internal::study;
  bool coverage = false, order = false, reference = false, verbose = false;
  int runs = -1;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--coverage")
      coverage = true;
    else if (word == "--order")
      order = true;
    else if (word == "--reference")
      reference = true;
    else if (word == "--verbose")
      verbose = true;
    else if (word == "--runs" && i + 1 < argc)
      runs = std::atoi(argv[++i]);
    else if (word == "--only" && i + 1 < argc)
      only = argv[++i];
    else {
      std::fprintf(stderr,
                   "error: bad option: %s: --coverage, --order, --reference, --runs N, --only WORD, --verbose\n",
                   word.c_str());
      return 2;
    }
  }
  const bool all = !coverage && !order && !reference;
  if (coverage || all) {
    fmt::print(
        "Made by `tools/trust-study`. The small rig, markers only, raw footage.\n\n"
        "**Coverage.** Each run has a reference frame and five more. Everything stated to the instrument is "
        "drawn again for each run, with its stated uncertainty: positions, rotations, heights, print scales, "
        "a given camera. The columns give the share of errors inside 1.96 u. The number after +- is the "
        "scatter of this share by chance, from run to run, because the frames of one run share their draw. "
        "In `off-plane` the target is 30 mm rms before or behind the plane. Beyond 12 mm its apparent size may also "
        "come from a wrong pitch, and u covers both.\n\n");
    print_coverage(runs > 0 ? runs : 200, only, verbose);
  }
  if (order || all) {
    fmt::print(
        "\n**Whole pitches.** Identical prints distributed over a sheet jump by whole pitches, half pitches or "
        "any distance, up to 4.4 pitches from frame to frame. The camera rotates by up to 1 deg; the lens is "
        "unknown.\n\n");
    print_orders(runs > 0 ? runs : 100000, only, verbose);
  }
  if (reference || all) {
    fmt::print(
        "\n**A reference that slips** by 0.2 px (0.069 mm) in any direction, from any of 16 frames on. The "
        "camera is almost still, sways or has a random pose. Points have the noise of images, unless the row "
        "names images. Noticed: a warning, or a row that is not `ok`.\n\n");
    print_reference_faults(runs > 0 ? runs : 1000, only, verbose);
  }
  return 0;
}
