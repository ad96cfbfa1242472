// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/run_figures.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/drawing/figures/figure_run.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;
using Written = tl::expected<void, std::string>;

constexpr std::array kFigureFormats{"pdf", "svg", "png"};

Written put_all(const fs::path& folder, const figure::RunFigures& drawn, const std::vector<std::string>& formats) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return tl::unexpected(fmt::format("{}: {}", folder.string(), error.message()));
  for (const figure::NamedFigure& named : drawn.figures) {
    const figure::FigureFiles files = files_of(named.figure);
    for (const std::string& format : formats) {
      const std::string& bytes = format == "pdf" ? files.pdf : format == "svg" ? files.svg : files.png;
      const std::string path = (folder / fmt::format("{}.{}", named.name, format)).string();
      if (bytes.empty()) return tl::unexpected(path + ": out of memory");
      if (auto written = write_file_atomically(path, bytes); !written) return written;
    }
  }
  return {};
}

}  // namespace

tl::expected<std::vector<std::string>, UsageError> figure_formats(const std::string& word) {
  std::vector<std::string> formats;
  for (std::size_t at = 0; !word.empty() && at <= word.size();) {
    const auto end = std::min(word.find(',', at), word.size());
    formats.push_back(word.substr(at, end - at));
    if (std::find(kFigureFormats.begin(), kFigureFormats.end(), formats.back()) == kFigureFormats.end())
      return tl::unexpected(UsageError{
          fmt::format("the format is unknown: --figures {}: choose from pdf, svg, png, separated by commas", word)});
    at = end + 1;
  }
  return formats;
}

PutMore put_figures(std::vector<std::string> formats, const RunCallbacks& callbacks) {
  return [formats = std::move(formats), &callbacks](const fs::path& folder, const Measurement& m) -> Written {
    if (formats.empty() || !m.reference) return {};
    const auto drawn =
        figure::run_figures({*m.reference, m.observations, m.samples, stated_scene(m), m.picture.grey.view()});
    for (const std::string& why : drawn.excluded) callbacks.note("note: there is no figure of the " + why);
    return put_all(folder / "figures", drawn, formats);
  };
}

}  // namespace moiregauge::internal
