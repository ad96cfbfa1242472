// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/picture_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/base/control_characters.h"
#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/pictures/damaged_pictures.h"
#include "moiregauge/io/pictures/picture_file.h"
#include "moiregauge/io/pictures/picture_list.h"
#include "moiregauge/io/pictures/pictures_ahead.h"
#include "moiregauge/io/pictures/tiff_reader.h"

namespace moiregauge::internal {
namespace {

// A numbered set of images: their number, a reader and names for messages.
struct PictureSet {
  long count = 0;
  std::function<PictureOrError(long)> read;
  std::function<std::string(long)> name;
  std::function<std::string(long)> problem;  // reason why there is nothing to read; empty: none
  std::string note;                          // about the whole set
  bool side_by_side = false;                 // several threads may read at once
};

bool is_of_same_shape(const LumaView& a, const LumaView& b) {
  return a.index() == b.index() && width_of(a) == width_of(b) && height_of(a) == height_of(b);
}

std::string shape_text(const LumaView& luma) {
  return fmt::format("{}x{} of {} bits", width_of(luma), height_of(luma), luma.index() == 0 ? "8" : "16");
}

// The first readable image, which determines the size of all.
struct FirstPicture {
  Picture picture;
  long number = 0;
};

class PictureSource final : public FrameSource {
 public:
  PictureSource(PictureSet set, FirstPicture first, InputInfo info, int readers)
      : set_(std::move(set)),
        info_(std::move(info)),
        picture_(std::move(first.picture)),
        first_(first.number),
        readers_(readers) {
    if (!set_.note.empty()) info_.warnings.push_back(set_.note);
    for (long i = 0; i < set_.count; ++i) {
      if (const std::string problem = set_.problem(i); !problem.empty()) damaged_.add(i, problem, set_.name(i));
    }
    warnings_before_ = info_.warnings.size();
    state_damage();
    if (first_ > 0) waiting_ = std::exchange(picture_, even_grey(view_of(picture_)));
  }

  [[nodiscard]] const InputInfo& info() const override { return info_; }

  [[nodiscard]] tl::expected<std::optional<Frame>, InputError> next() override {
    if (broken_off_) return tl::unexpected(*broken_off_);
    if (picture_.file && !picture_.file->is_whole()) return break_off_cut_short();
    if (number_ >= set_.count) return std::optional<Frame>();
    bool damaged = false;
    if (number_ == first_) {  // read at opening
      if (waiting_) picture_ = *std::exchange(waiting_, std::nullopt);
    } else {
      auto read = picture_at(number_);
      damaged = !read;
      if (read && !is_of_same_shape(view_of(*read), view_of(picture_))) return break_off(view_of(*read));
      if (read) {
        let_go();
        picture_ = std::move(*read);
      }
      if (!read) show_nothing(read.error());
    }
    const double time_s = std::isnan(info_.fps) ? info_.fps : static_cast<double>(number_) / info_.fps;
    return Frame{number_++, time_s, damaged, view_of(picture_), {picture_.quantiser, {}}};
  }

 private:
  PictureOrError picture_at(long number) {
    if (readers_ < 1 || number < first_) return set_.read(number);
    if (!ahead_) ahead_.emplace(number, set_.count, set_.read, readers_);  // only if a second image is wanted
    return ahead_->take();
  }

  tl::unexpected<InputError> break_off(const LumaView& changed) {
    broken_off_ = InputError{
        InputErrorKind::kDamaged,
        fmt::format(
            "the image size changes from {} to {} at frame {}: {}: measure the parts separately (earlier frames are "
            "valid)",
            shape_text(view_of(picture_)), shape_text(changed), number_, set_.name(number_))};
    return tl::unexpected(*broken_off_);
  }

  void let_go() const {
    if (!picture_.in_place) return;
    std::visit(
        [this](const auto& view) {
          picture_.file->let_go(std::as_bytes(std::span(view.data, view.row(view.height).data())));
        },
        *picture_.in_place);
  }

  tl::unexpected<InputError> break_off_cut_short() {
    broken_off_ = InputError{
        InputErrorKind::kDamaged,
        fmt::format("the file became shorter during the measurement: {} at frame {}: measure it when it is complete",
                    info_.path, number_)};
    return tl::unexpected(*broken_off_);
  }

  // Returns uniform grey, so that no content of the previous frame remains.
  static Picture even_grey(const LumaView& shape) {
    Picture grey;
    std::visit([&grey]<typename Grey>(
                   const ImageView<Grey>& view) { grey.grey = Image<Grey>(view.width, view.height, Grey{128}); },
               shape);
    return grey;
  }

  void show_nothing(const InputError& error) {
    if (set_.problem(number_).empty()) damaged_.add(number_, error.message, "");
    state_damage();
    picture_.grey = even_grey(view_of(picture_)).grey;
    picture_.in_place.reset();
  }

  // Replaces the warning about damaged frames.
  void state_damage() {
    info_.warnings.resize(warnings_before_);
    if (std::string text = damaged_.text(); !text.empty()) info_.warnings.push_back(std::move(text));
  }

  PictureSet set_;
  InputInfo info_;
  Picture picture_;
  std::optional<Picture> waiting_;  // the first image, while damaged frames before it are delivered
  long first_ = 0;                  // number of the first image
  int readers_ = 0;                 // reading threads; 0: read in this thread
  long number_ = 0;
  DamagedPictures damaged_;
  std::size_t warnings_before_ = 0;
  std::optional<InputError> broken_off_;
  std::optional<PicturesAhead> ahead_;
};

PictureSet set_of_files(PictureList list, std::int64_t max_pixels) {
  const auto count = static_cast<long>(list.pictures.size());
  std::string note = std::move(list.note);
  const auto all = std::make_shared<const std::vector<ListedPicture>>(std::move(list.pictures));
  const auto at = [all](long i) -> const ListedPicture& { return (*all)[static_cast<std::size_t>(i)]; };
  const auto read = [at, max_pixels](long i) -> PictureOrError {
    const ListedPicture& picture = at(i);
    if (picture.problem.empty()) return read_picture(picture.path, max_pixels);
    return input_failure(InputErrorKind::kUnreadable, fmt::format("{}: {}", picture.problem, picture.path));
  };
  return {count,           read, [at](long i) { return at(i).path; }, [at](long i) { return at(i).problem; },
          std::move(note), true};
}

// Returns the pages of a TIFF file as images.
tl::expected<PictureSet, InputError> set_of_pages(const std::string& path, std::int64_t max_pixels) {
  const auto stack = TiffStack::open(path, max_pixels);
  if (!stack) return tl::unexpected(stack.error());
  return PictureSet{(*stack)->pages(),
                    [stack = *stack](long i) { return stack->read(i); },
                    [path](long i) { return fmt::format("{} page {}", path, i); },
                    [](long) { return std::string(); },
                    "",
                    false};
}

tl::expected<PictureSet, InputError> set_of(PictureList list, std::int64_t max_pixels) {
  if (list.pictures.size() == 1 && picture_kind(list.pictures.front().path) == PictureKind::kTiff)
    return set_of_pages(list.pictures.front().path, max_pixels);
  return set_of_files(std::move(list), max_pixels);
}

// Returns the first readable image. Fails with the problem of the very first one.
tl::expected<FirstPicture, InputError> first_of(const PictureSet& set) {
  std::optional<InputError> problem;
  for (long i = 0; i < set.count; ++i) {
    auto picture = set.read(i);
    if (picture) return FirstPicture{std::move(*picture), i};
    if (!problem) problem = std::move(picture.error());
  }
  return tl::unexpected(problem.value_or(InputError{}));
}

InputInfo info_of(const std::string& path, const PictureSet& set, const Picture& first, const InputOptions& options) {
  InputInfo info;
  info.path = path;
  info.frames = set.count;
  info.width = width_of(view_of(first));
  info.height = height_of(view_of(first));
  info.bits = first.bits;
  info.fps = options.fps.value_or(std::numeric_limits<double>::quiet_NaN());
  info.codec = first.codec;
  info.tone = first.tone;
  info.rotation_deg = first.rotation_deg;
  info.time_source = options.fps ? "fps-option" : "none";
  info.start_utc = first.start_utc;
  return info;
}

int readers_of(const PictureSet& set, int threads) {
  if (threads == 1 || set.count < 3) return 0;
  if (!set.side_by_side) return 1;
  return threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

tl::expected<PictureList, InputError> pictures_of_input(const std::string& path, const InputOptions& options) {
  if (options.sequence) return list_pictures_of_pattern(path);
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status)) {
    const bool pattern = path.find('%') != std::string::npos;
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("the file or folder does not exist: {}: {}", as_one_line(path),
                                     pattern ? "add --sequence if it is a pattern" : "check the name"));
  }
  if (!std::filesystem::is_directory(status)) {
    if (const std::string kind = kind_unless_plain(path); !kind.empty())
      return input_failure(InputErrorKind::kUnreadable,
                           fmt::format("the input is {}: {}: store its content in a plain file first", kind, path));
    return PictureList{{{path, ""}}, ""};
  }
  auto list = list_pictures(path);
  if (list && list->pictures.empty()) {
    return input_failure(
        InputErrorKind::kUnreadable,
        fmt::format("there are no images: {}: give a folder with PNG, TIFF or JPEG files, or with frames/", path));
  }
  return list;
}

}  // namespace

tl::expected<std::vector<std::string>, InputError> files_of_input(const std::string& path,
                                                                  const InputOptions& options) {
  return pictures_of_input(path, options).map(existing_files);
}

tl::expected<std::unique_ptr<FrameSource>, InputError> open_pictures(const std::string& path,
                                                                     const InputOptions& options) {
  auto list = pictures_of_input(path, options);
  if (!list) return tl::unexpected(list.error());
  auto set = set_of(*std::move(list), options.max_pixels);
  if (!set) return tl::unexpected(set.error());
  auto first = first_of(*set);
  if (!first) return tl::unexpected(first.error());
  InputInfo info = info_of(path, *set, first->picture, options);
  const int readers = readers_of(*set, options.threads);
  return std::make_unique<PictureSource>(std::move(*set), std::move(*first), std::move(info), readers);
}

}  // namespace moiregauge::internal
