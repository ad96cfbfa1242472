// SPDX-License-Identifier: Apache-2.0
// Errors as values. No function of the library throws for bad input.
#pragma once

#include <string>

#include <tl/expected.hpp>

// Marks what the shared library exports.
#define MOIREGAUGE_API __attribute__((visibility("default")))

namespace moiregauge {

// Kinds of failure. The numbers are the exit codes of the program.
enum class ErrorKind {
  kInternal = 1,
  kUsage = 2,    // options that exclude each other, or a site or camera file with mistakes
  kInput = 3,    // unreadable or unsupported input
  kRefused = 4,  // nothing that can be trusted was found
  kOutput = 6    // the results could not be written
};

struct Error {
  ErrorKind kind = ErrorKind::kInternal;
  std::string message;  // "what happened: where: what to do"
};

template <typename Value>
using Expected = tl::expected<Value, Error>;

}  // namespace moiregauge
