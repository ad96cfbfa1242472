// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/size_text.h"

#include <array>
#include <charconv>
#include <string_view>
#include <utility>

namespace moiregauge::internal {

std::optional<std::uint64_t> byte_count(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, double>, 3> kSizeUnits{{{"MB", 1e6}, {"GB", 1e9}, {"TB", 1e12}}};
  double size = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  for (const auto& [unit, factor] : kSizeUnits)
    if (error == std::errc() && std::string_view(end) == unit && size > 0.0 && size < 1e6)
      return static_cast<std::uint64_t>(size * factor);
  return std::nullopt;
}

}  // namespace moiregauge::internal
