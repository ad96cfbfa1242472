// SPDX-License-Identifier: Apache-2.0
// Accesses the fields of a struct by index, so that no separate list of names can become outdated.
#pragma once

#include <cstddef>
#include <tuple>

namespace moiregauge::internal {

// Number of fields of a struct, stated once for every stored struct (run_layout.h). A wrong number does not compile,
// because a structured binding needs exactly one name per field.
template <typename Struct>
inline constexpr std::size_t kFields = 0;

// Returns references to all fields in the order of their declaration.
template <typename Struct>
[[nodiscard]] constexpr auto fields_of(Struct& s) {
  constexpr std::size_t kCount = kFields<std::remove_const_t<Struct>>;
  static_assert(kCount >= 1 && kCount <= 14, "say in run_layout.h how many fields this struct has");
  // clang-format off
  if constexpr (kCount == 1) { auto& [a] = s; return std::tie(a); }
  else if constexpr (kCount == 2) { auto& [a, b] = s; return std::tie(a, b); }
  else if constexpr (kCount == 3) { auto& [a, b, c] = s; return std::tie(a, b, c); }
  else if constexpr (kCount == 4) { auto& [a, b, c, d] = s; return std::tie(a, b, c, d); }
  else if constexpr (kCount == 5) { auto& [a, b, c, d, e] = s; return std::tie(a, b, c, d, e); }
  else if constexpr (kCount == 6) { auto& [a, b, c, d, e, f] = s; return std::tie(a, b, c, d, e, f); }
  else if constexpr (kCount == 7) { auto& [a, b, c, d, e, f, g] = s; return std::tie(a, b, c, d, e, f, g); }
  else if constexpr (kCount == 8) { auto& [a, b, c, d, e, f, g, h] = s; return std::tie(a, b, c, d, e, f, g, h); }
  else if constexpr (kCount == 9) { auto& [a, b, c, d, e, f, g, h, i] = s; return std::tie(a, b, c, d, e, f, g, h, i); }
  else if constexpr (kCount == 10) { auto& [a, b, c, d, e, f, g, h, i, j] = s; return std::tie(a, b, c, d, e, f, g, h, i, j); }
  else if constexpr (kCount == 11) { auto& [a, b, c, d, e, f, g, h, i, j, k] = s; return std::tie(a, b, c, d, e, f, g, h, i, j, k); }
  else if constexpr (kCount == 12) { auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s; return std::tie(a, b, c, d, e, f, g, h, i, j, k, l); }
  else if constexpr (kCount == 13) { auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = s; return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m); }
  else { auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = s; return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n); }
  // clang-format on
}

}  // namespace moiregauge::internal
