// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/plan/command_calibrate.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "moiregauge/base/atomic_file.h"
#include "moiregauge/base/length_text.h"
#include "moiregauge/board/seen_board.h"
#include "moiregauge/cli/common/exit_line.h"
#include "moiregauge/cli/common/progress.h"
#include "moiregauge/cli/common/terminal_text.h"
#include "moiregauge/cli/plan/calibrate_text.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_list.h"

namespace moiregauge::internal::cli {
namespace {

namespace fs = std::filesystem;

struct CalibrateWords {
  std::vector<std::string> photos;
  std::string pitch;
  std::string output = "camera.toml";
  bool k3 = false;
  bool quiet = false;
};

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

tl::expected<std::vector<Photo>, InputError> look_at(const std::vector<std::string>& files, bool quiet) {
  Progress progress("reading photographs", quiet);
  std::vector<Photo> photos;
  for (const std::string& file : files) {
    const auto picture = read_picture(file);
    if (!picture) return tl::unexpected(picture.error());
    const LumaView luma = view_of(*picture);
    photos.push_back({width_of(luma), height_of(luma), find_board({luma, picture->bits})});
    progress.show(static_cast<long>(photos.size()), static_cast<long>(files.size()));
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

int run(const CalibrateWords& words) {
  const auto pitch = length_mm(words.pitch);
  if (!pitch)
    return fail(Exit::kUsage, fmt::format("the pitch cannot be read: --pitch {}: {}", words.pitch, pitch.error()));
  const auto files = files_of(words.photos);
  if (!files) return fail(Exit::kInputUnreadable, files.error().message);
  const auto photos = look_at(*files, words.quiet);
  if (!photos) return fail(Exit::kInputUnreadable, photos.error().message);
  const BoardPattern pattern = common_pattern(*photos);
  CalibrateReport report;
  report.pattern = name_of(pattern);
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < photos->size(); ++i) {
    const Photo& photo = (*photos)[i];
    report.names.push_back(fs::path((*files)[i]).filename().string());
    const bool is_of_it = photo.board && photo.board->pattern == pattern;
    views.push_back(is_of_it ? board_view(*photo.board, *pitch, photo.width, photo.height)
                             : BoardView{photo.width, photo.height, {}});
  }
  auto solved = calibrate_board(views, {.k3 = words.k3});
  if (!solved)
    return fail(Exit::kRefused, fmt::format("{}: {} ({} in all): photograph one flat board of dots, squares or a "
                                            "checkerboard, sharp and whole",
                                            solved.error(), words.photos.front(), views.size()));
  report.solved = *std::move(solved);
  for (std::size_t i = 0; i < photos->size(); ++i) {
    const Photo& photo = (*photos)[i];
    if (photo.board && photo.board->pattern != pattern)
      report.solved.views[i].left_out =
          fmt::format("its pattern is {}, the others show {}", name_of(photo.board->pattern), report.pattern);
  }
  if (const auto refusal = calibrate_refusal(report, words.photos.front())) return fail(Exit::kRefused, *refusal);
  if (const auto written = write_file_atomically(words.output, camera_text(report)); !written)
    return fail(Exit::kOutputUnwritable,
                fmt::format("the camera file could not be written: {}: free space or choose another file with -o",
                            written.error()));
  if (words.quiet) return 0;
  for (const std::string& warning : calibrate_warnings(report)) print_note(fmt::format("warning: {}\n", warning));
  print_out(fmt::format("{}next: moiregauge measure ... --camera {}\n", calibrate_text(report), words.output));
  return 0;
}

}  // namespace

void add_calibrate(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("calibrate", "Solve a camera and its lens from photographs of a printed board");
  auto words = std::make_shared<CalibrateWords>();
  command->add_option("PHOTOS", words->photos, "photographs of one flat printed board, or folders of them")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--pitch", words->pitch, "pitch of the board with its unit, e.g. 10mm (checkerboard: two squares)")
      ->type_name("LENGTH")
      ->required();
  command->add_option("-o,--out", words->output, "camera file to write [camera.toml]")->type_name("FILE");
  command->add_flag("--k3", words->k3, "also solve k3, for very wide lenses");
  command->add_flag("--quiet", words->quiet, "print nothing but errors");
  command->callback([words, &exit_code] { exit_code = run(*words); });
}

}  // namespace moiregauge::internal::cli
