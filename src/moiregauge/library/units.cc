// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/units.h"

#include "moiregauge/base/duration_text.h"
#include "moiregauge/base/length_text.h"
#include "moiregauge/library/convert.h"

namespace moiregauge {

Expected<Millimetres> read_length(const std::string& text) {
  const auto mm = internal::length_mm(text);
  if (!mm) return internal::public_error(internal::Exit::kUsage, "the length cannot be read: " + mm.error());
  return Millimetres(*mm);
}

Expected<Seconds> read_duration(const std::string& text) {
  const auto s = internal::duration_s(text);
  if (!s) return internal::public_error(internal::Exit::kUsage, "the duration cannot be read: " + s.error());
  return Seconds(*s);
}

}  // namespace moiregauge
