// SPDX-License-Identifier: Apache-2.0
// Reads and writes site.toml, the text file with the markers of a site (docs/file-formats.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/results/derived/channel.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// One mistake per entry, in the order of the file: "file:line:column: what is wrong".
using SiteErrors = std::vector<std::string>;

// Markers, and the channels that `derive` computes from them.
struct SiteFile {
  Site site;
  std::vector<ChannelText> channels;  // valid for the targets of the site
};

// Reads a site with its channels. Fails with one mistake of syntax, or with all mistakes of meaning (unknown keys, wrong types,
// impossible values).
//
// Does not check the number of references: methods differ in it.
[[nodiscard]] tl::expected<SiteFile, SiteErrors> read_site_file(const std::string& path);

// Reads a site from text. `path` is used in messages only.
[[nodiscard]] tl::expected<SiteFile, SiteErrors> parse_site_file(const std::string& text, const std::string& path);

// Read a site without its channels.
[[nodiscard]] tl::expected<Site, SiteErrors> read_site(const std::string& path);
[[nodiscard]] tl::expected<Site, SiteErrors> parse_site(const std::string& text, const std::string& path);

// Returns what is wrong with the name of a marker, or nothing.
[[nodiscard]] std::optional<std::string> name_problem(const std::string& name);

// Returns a file that read_site reads back to the last bit of every length. Angles may lose their last bit, because not
// every number of radians has an exact number of degrees.
[[nodiscard]] std::string write_site(const Site& site, const std::vector<ChannelText>& channels = {});

}  // namespace moiregauge::internal
