// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/app/calibrate/calibrate_photos.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/board/seen_board.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_list.h"

namespace moiregauge::internal {
namespace {

namespace fs = std::filesystem;

// Replaces folders by the images in them.
tl::expected<std::vector<std::string>, InputError> files_of(const std::vector<std::string>& photos) {
  std::vector<std::string> files;
  for (const std::string& photo : photos) {
    std::error_code ignored;
    if (!fs::is_directory(photo, ignored)) {
      files.push_back(photo);
      continue;
    }
    const auto inside = pictures_in_folder(photo);
    if (!inside) return tl::unexpected(inside.error());
    files.insert(files.end(), inside->begin(), inside->end());
  }
  if (files.empty())
    return tl::unexpected(InputError{InputErrorKind::kUnreadable,
                                     fmt::format("there are no photographs: {}: give photographs, or a folder of them",
                                                 photos.empty() ? "calibrate" : photos.front())});
  return files;
}

struct Photo {
  int width = 0, height = 0;
  std::optional<SeenBoard> board;
};

tl::expected<std::vector<Photo>, InputError> look_at(const std::vector<std::string>& files,
                                                     const std::function<void(long, long)>& on_progress) {
  std::vector<Photo> photos;
  for (const std::string& file : files) {
    const auto picture = read_picture(file);
    if (!picture) return tl::unexpected(picture.error());
    const LumaView luma = view_of(*picture);
    photos.push_back({width_of(luma), height_of(luma), find_board({luma, picture->bits})});
    if (on_progress) on_progress(static_cast<long>(photos.size()), static_cast<long>(files.size()));
  }
  return photos;
}

// Returns the pattern of most photographs. Another pattern is another board.
BoardPattern common_pattern(const std::vector<Photo>& photos) {
  std::map<BoardPattern, int> count;
  for (const Photo& photo : photos) {
    if (photo.board) ++count[photo.board->pattern];
  }
  const auto most =
      std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == count.end() ? BoardPattern::kDots : most->first;
}

tl::unexpected<RunFailure> failed(Exit exit, std::string message) {
  return tl::unexpected(RunFailure{exit, std::move(message)});
}

}  // namespace

tl::expected<CalibrateReport, RunFailure> calibrate_photos(const std::vector<std::string>& given, double pitch_mm,
                                                           const BoardOptions& options,
                                                           const std::function<void(long, long)>& on_progress) {
  const auto files = files_of(given);
  if (!files) return failed(Exit::kInputUnreadable, files.error().message);
  const auto photos = look_at(*files, on_progress);
  if (!photos) return failed(Exit::kInputUnreadable, photos.error().message);
  const BoardPattern pattern = common_pattern(*photos);
  CalibrateReport report;
  report.pattern = name_of(pattern);
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < photos->size(); ++i) {
    const Photo& photo = (*photos)[i];
    report.names.push_back(fs::path((*files)[i]).filename().string());
    const bool is_of_it = photo.board && photo.board->pattern == pattern;
    views.push_back(is_of_it ? board_view(*photo.board, pitch_mm, photo.width, photo.height)
                             : BoardView{photo.width, photo.height, {}});
  }
  auto solved = calibrate_board(views, options);
  if (!solved)
    return failed(Exit::kRefused, fmt::format("{}: {} ({} in all): photograph one flat board of dots, squares or a "
                                              "checkerboard, sharp and whole",
                                              solved.error(), given.front(), views.size()));
  report.solved = *std::move(solved);
  for (std::size_t i = 0; i < photos->size(); ++i) {
    const Photo& photo = (*photos)[i];
    if (photo.board && photo.board->pattern != pattern)
      report.solved.views[i].excluded =
          fmt::format("its pattern is {}, the others show {}", name_of(photo.board->pattern), report.pattern);
  }
  return report;
}

}  // namespace moiregauge::internal
