// SPDX-License-Identifier: Apache-2.0
// The program in which the shared library decodes video. The library's constructor runs before main() and does not
// return.
#include <cstdio>

#include "moiregauge/result.h"

int main() {
  // Any symbol, so that the linker keeps the library.
  if (moiregauge::to_string(moiregauge::Status::kOk) == nullptr) return 1;
  std::fputs("error: this program has no commands: moiregauge-decode: run moiregauge instead\n", stderr);
  return 2;
}
