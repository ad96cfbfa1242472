// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/terminal_text.h"

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <string>

#include "moiregauge/base/control_characters.h"

namespace moiregauge::internal::cli {
namespace {

// The errno of the first write that failed. It belongs to stdout, of which there is one.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
int first_output_error = 0;

bool put_text(std::FILE* stream, std::string_view text) {
  const std::string shown = with_controls_escaped(text);
  errno = 0;
  return std::fwrite(shown.data(), 1, shown.size(), stream) == shown.size();
}

void keep_output_error() {
  if (first_output_error == 0) first_output_error = errno != 0 ? errno : EIO;
}

}  // namespace

void print_out(std::string_view text) {
  if (!put_text(stdout, text)) keep_output_error();
}

void put_bytes(std::string_view bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size()) keep_output_error();
}

void print_note(std::string_view text) { static_cast<void>(put_text(stderr, text)); }

bool finish_output() {
  errno = 0;
  std::cout.flush();  // CLI11 writes its help there
  if (!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) keep_output_error();
  errno = first_output_error;
  return first_output_error == 0;
}

}  // namespace moiregauge::internal::cli
