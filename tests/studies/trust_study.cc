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
        "**Coverage.** Runs of a reference frame and five more; in each, all that the instrument is told is drawn anew "
        "as wide as it is told: places, turns, heights, print scales, a given camera. How often the truth lies inside "
        "1.96 u; after the +-, by how much that scatters by chance (from run to run, for frames of one run share what "
        "was drawn).\n\n");
    print_coverage(runs > 0 ? runs : 200, only, verbose);
  }
  if (order || all) {
    fmt::print(
        "\n**Whole pitches.** Like prints all over a sheet jump by whole pitches, halves or anything, up to 4.4 "
        "pitches from frame to frame, before a camera that turns by up to 1 deg; lens unknown.\n\n");
    print_orders(runs > 0 ? runs : 100000, only, verbose);
  }
  if (reference || all) {
    fmt::print(
        "\n**A reference that slips** by 0.2 px (0.069 mm) in any direction, from any of 16 frames on, before a camera "
        "that "
        "stands nearly still, sways or is posed anew. Points with the noise of pictures, unless it says pictures. "
        "Noticed: "
        "a warning, or a row that is not `ok`.\n\n");
    print_reference_faults(runs > 0 ? runs : 1000, only, verbose);
  }
  return 0;
}
