// SPDX-License-Identifier: Apache-2.0
// trust_study [--coverage] [--order] [--reference] [--runs N] [--only WORD] [--verbose]: Markdown, a table for each
// section asked for (all of them if none is).
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "studies/trust_coverage.h"
#include "studies/trust_order.h"
#include "studies/trust_reference.h"

int main(int argc, char** argv) {
  using namespace moiregauge::study;
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
  if (coverage || all) print_coverage(runs > 0 ? runs : 400, only, verbose);
  if (order || all) print_orders(runs > 0 ? runs : 100000, only, verbose);
  if (reference || all) print_reference_faults(runs > 0 ? runs : 1000, only, verbose);
  return 0;
}
