// SPDX-License-Identifier: Apache-2.0
// site.toml: the place's markers as a text file (docs/file-formats.md), read and written.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// One entry per mistake, each "file:line:column: what is wrong", in the order of the file.
using SiteErrors = std::vector<std::string>;

// Everything the file says, or everything that is wrong with it. A mistake of syntax ends the reading, so it comes
// alone; mistakes of meaning (unknown keys, wrong types, impossible values) come all at once.
//
// How many references a method needs is not asked here: the method says so.
[[nodiscard]] tl::expected<Site, SiteErrors> read_site(const std::string& path);

// The same from text in memory; `path` only names it in the messages.
[[nodiscard]] tl::expected<Site, SiteErrors> parse_site(const std::string& text, const std::string& path);

// A file that read_site gives back as it was, to the last bit of every length; an angle may lose its last bit, since not
// every number of radians is one of degrees.
[[nodiscard]] std::string write_site(const Site& site);

}  // namespace moiregauge::internal
