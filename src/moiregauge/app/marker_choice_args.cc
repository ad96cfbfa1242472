// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/marker_choice_args.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "moiregauge/io/config/site_file.h"

namespace moiregauge::internal {
namespace {

std::optional<PixelRegion> region_in(const std::string& text) {
  std::array<double, 4> numbers{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (k > 0 && (at == end || *at++ != ',')) return std::nullopt;
    const auto [next, problem] = std::from_chars(at, end, numbers[k]);
    if (problem != std::errc() || !std::isfinite(numbers[k])) return std::nullopt;
    at = next;
  }
  const PixelRegion region{numbers[0], numbers[1], numbers[2], numbers[3]};
  if (at != end || !(region.width > 0.0) || !(region.height > 0.0)) return std::nullopt;
  return region;
}

tl::expected<std::vector<PixelRegion>, UsageError> regions_in(const std::vector<std::string>& texts,
                                                              const char* option) {
  std::vector<PixelRegion> regions;
  for (const std::string& text : texts) {
    const auto region = region_in(text);
    if (!region)
      return usage(
          fmt::format("the region cannot be read: {} {}: write x,y,width,height in px of the image, e.g. 400,0,800,600",
                      option, text));
    regions.push_back(*region);
  }
  return regions;
}

}  // namespace

tl::expected<MarkerChoice, UsageError> marker_choice_of(const MarkerChoiceArgs& args) {
  MarkerChoice choice{args.references, args.targets, args.ignored, {}};
  for (const std::string& text : args.names) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      return usage(fmt::format("the new name cannot be read: --name {}: write OLD=NEW, e.g. T1=midspan", text));
    NewName name{text.substr(0, equals), text.substr(equals + 1)};
    if (const auto problem = name_problem(name.to))
      return usage(fmt::format("the new name is not allowed: --name {} ({}): choose another", text, *problem));
    choice.names.push_back(std::move(name));
  }
  return choice;
}

tl::expected<SearchArea, UsageError> search_area_of(const MarkerChoiceArgs& args) {
  auto regions = regions_in(args.regions, "--region");
  if (!regions) return tl::unexpected(regions.error());
  auto excluded = regions_in(args.excluded_regions, "--exclude-region");
  if (!excluded) return tl::unexpected(excluded.error());
  return SearchArea{*std::move(regions), *std::move(excluded)};
}

}  // namespace moiregauge::internal
