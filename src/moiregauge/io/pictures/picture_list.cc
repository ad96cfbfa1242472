// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/pictures/picture_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/io/pictures/picture_numbers.h"

namespace moiregauge::internal {
namespace fs = std::filesystem;
namespace {

constexpr std::array kPictureEndings{".png", ".tif", ".tiff", ".jpg", ".jpeg"};
// Image formats that this program cannot read. In a numbered folder such a file is a missing frame.
constexpr std::array kForeignEndings{".bmp", ".gif", ".webp", ".heic", ".avif", ".jp2", ".exr", ".pgm",
                                     ".ppm", ".pnm", ".dng",  ".raw",  ".cr2",  ".cr3", ".nef", ".arw"};

std::string small_ending(const std::string& name) {
  std::string ending = fs::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

template <typename Endings>
bool ends_with_one_of(const Endings& endings, const std::string& name) {
  return name.front() != '.' && std::find(endings.begin(), endings.end(), small_ending(name)) != endings.end();
}

// Returns the image names of a folder in natural order. `path` is the bare name.
tl::expected<std::vector<ListedPicture>, InputError> pictures_in(const fs::path& folder) {
  std::error_code problem;
  std::vector<ListedPicture> found;
  for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end; entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    const bool is_ours = ends_with_one_of(kPictureEndings, name);
    if (!is_ours && !ends_with_one_of(kForeignEndings, name)) continue;
    found.push_back({name, is_ours ? kind_unless_plain(entry->path().string()) : "not PNG, TIFF or JPEG"});
  }
  if (problem)
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("the folder cannot be read: {}: {}", folder.string(), problem.message()));
  std::sort(found.begin(), found.end(),
            [](const ListedPicture& a, const ListedPicture& b) { return comes_before(a.path, b.path); });
  return found;
}

std::string padded(const std::string& before, long number, std::size_t width, const std::string& after) {
  return fmt::format("{}{:0{}}{}", before, number, width, after);
}

// Returns every number from the first to the last in steps of the stride. `name` creates the name of a missing one.
std::vector<ListedPicture> without_gaps(const std::map<long, ListedPicture>& found, long stride,
                                        const std::function<std::string(long)>& name) {
  std::vector<ListedPicture> all;
  for (long number = found.begin()->first; number <= found.rbegin()->first; number += stride) {
    const auto there = found.find(number);
    all.push_back(there != found.end() ? there->second : ListedPicture{name(number), "missing image"});
  }
  return all;
}

std::vector<long> numbers_of(const std::map<long, ListedPicture>& found) {
  std::vector<long> numbers;
  numbers.reserve(found.size());
  for (const auto& [number, picture] : found) numbers.push_back(number);
  return numbers;
}

// Returns the images by number. A plain file replaces any other entry of its number. Returns nothing if the names have
// no number, or if a number occurs twice.
std::optional<std::map<long, ListedPicture>> by_number(const std::vector<ListedPicture>& pictures,
                                                       const std::string& shape, NumberedName& example) {
  std::vector<std::string> names;
  for (const ListedPicture& picture : pictures) {
    if (picture.problem.empty()) names.push_back(picture.path);
  }
  const auto plain = numbered_names(names);
  if (!plain) return std::nullopt;
  example = plain->front();
  std::map<long, ListedPicture> found;
  for (std::size_t i = 0; i < names.size(); ++i) found[(*plain)[i].number] = {names[i], ""};
  for (const ListedPicture& picture : pictures) {
    if (picture.problem.empty() || shape_of_name(picture.path) != shape) continue;
    // Cut this name as its neighbours are cut: they determine which digits are the number.
    const std::size_t start = example.before.size();
    const bool is_alike = picture.path.size() > start && picture.path.starts_with(example.before);
    const std::size_t end = is_alike ? picture.path.find_first_not_of("0123456789", start) : start;
    long number = -1;
    if (is_alike && end != std::string::npos)
      std::from_chars(picture.path.data() + start, picture.path.data() + end, number);
    if (number >= 0) found.emplace(number, picture);
  }
  return found;
}

// Returns the name shape of most plain files.
std::string common_shape(const std::vector<ListedPicture>& pictures) {
  std::map<std::string, int> count;
  for (const ListedPicture& picture : pictures) {
    if (picture.problem.empty()) ++count[shape_of_name(picture.path)];
  }
  const auto most =
      std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == count.end() ? "" : most->first;
}

PictureList as_they_follow(const std::vector<ListedPicture>& pictures) {
  PictureList list;
  for (const ListedPicture& picture : pictures) {
    if (picture.problem.empty()) list.pictures.push_back(picture);
  }
  return list;
}

constexpr const char* kAsTheyFollow = "frame numbers follow the order of the images, not their file names";

PictureList listed(const std::vector<ListedPicture>& pictures) {
  const std::string shape = common_shape(pictures);
  std::vector<ListedPicture> alike;
  std::string stranger;
  for (const ListedPicture& picture : pictures) {
    if (shape_of_name(picture.path) == shape)
      alike.push_back(picture);
    else if (picture.problem.empty())
      stranger = picture.path;
  }
  NumberedName example;
  const auto found = by_number(alike, shape, example);
  PictureList plain = as_they_follow(pictures);
  if (!found || found->empty()) return plain;
  const std::vector<long> numbers = numbers_of(*found);
  const long stride = stride_of(numbers);
  if (!count_frames(numbers, stride)) {
    plain.note = fmt::format("note: {} ({} images are numbered from {} to {})", kAsTheyFollow, numbers.size(),
                             numbers.front(), numbers.back());
    return plain;
  }
  std::vector<ListedPicture> all = without_gaps(*found, stride, [&](long number) {
    return padded(example.before, number, example.digits.size(), example.after);
  });
  if (stranger.empty()) return {std::move(all), ""};
  const auto gap = std::find_if(all.begin(), all.end(), [](const ListedPicture& p) { return !p.problem.empty(); });
  if (gap != all.end())
    plain.note = fmt::format("{}: {} has another name, and {} cannot be used ({}). Move {} to another folder",
                             kAsTheyFollow, stranger, gap->path, gap->problem, stranger);
  return plain;
}

// A pattern with one "%d" or "%0Nd". Other printf formats are refused, and the pattern never reaches printf.
struct NamePattern {
  std::string before;
  std::string after;
  std::size_t width = 0;  // smallest number of digits, padded with zeros
};

std::optional<NamePattern> parsed_pattern(const std::string& name) {
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return std::nullopt;
  const std::size_t end = std::min(name.size(), name.find_first_not_of("0123456789", percent + 1));
  const std::string_view width = std::string_view(name).substr(percent + 1, end - percent - 1);
  if (end >= name.size() || name[end] != 'd' || width.size() > 3) return std::nullopt;
  if (!width.empty() && width.front() != '0') return std::nullopt;
  NamePattern parsed{name.substr(0, percent), name.substr(end + 1), 0};
  std::from_chars(width.data(), width.data() + width.size(), parsed.width);
  if (parsed.after.find('%') != std::string::npos || parsed.width > 18) return std::nullopt;
  return parsed;
}

std::optional<long> number_in(const NamePattern& pattern, std::string_view name) {
  if (!name.starts_with(pattern.before)) return std::nullopt;
  const std::size_t start = pattern.before.size();
  const std::size_t end = std::min(name.size(), name.find_first_not_of("0123456789", start));
  if (end == start || end - start > 18) return std::nullopt;
  long number = 0;
  std::from_chars(name.data() + start, name.data() + end, number);
  return padded(pattern.before, number, pattern.width, pattern.after) == name ? std::optional(number) : std::nullopt;
}

// Prepends the folder to bare names.
PictureList in_folder(PictureList list, const fs::path& folder) {
  for (ListedPicture& picture : list.pictures) picture.path = (folder / picture.path).string();
  return list;
}

}  // namespace

tl::expected<PictureList, InputError> list_pictures(const std::string& folder) {
  for (const fs::path& place : {fs::path(folder), fs::path(folder) / "frames"}) {
    std::error_code ignored;
    if (place != fs::path(folder) && !fs::is_directory(place, ignored)) break;
    const auto pictures = pictures_in(place);
    if (!pictures) return tl::unexpected(pictures.error());
    PictureList list = listed(*pictures);
    if (!list.pictures.empty()) return in_folder(std::move(list), place);
  }
  return PictureList{};
}

tl::expected<PictureList, InputError> list_pictures_of_pattern(const std::string& pattern) {
  const fs::path path(pattern);
  const auto parsed = parsed_pattern(path.filename().string());
  if (!parsed) {
    return input_failure(
        InputErrorKind::kUnreadable,
        fmt::format("the name is not a pattern: {}: give one %d or %0Nd in the file name, as in img_%04d.png",
                    pattern));
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::map<long, ListedPicture> found;
  std::error_code problem;
  for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end; entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    if (const auto number = number_in(*parsed, name))
      found[*number] = {name, kind_unless_plain(entry->path().string())};
  }
  if (problem)
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("the folder cannot be read: {}: {}", folder.string(), problem.message()));
  if (found.empty())
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("there are no images: {}: check the pattern, no file matches it", pattern));
  const std::vector<long> numbers = numbers_of(found);
  const long stride = stride_of(numbers);
  if (!count_frames(numbers, stride)) {
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("too many numbers are missing: {} ({} files between {} and {}): give their folder "
                                     "instead of a pattern",
                                     pattern, found.size(), numbers.front(), numbers.back()));
  }
  const auto name = [&](long number) { return padded(parsed->before, number, parsed->width, parsed->after); };
  return in_folder({without_gaps(found, stride, name), ""}, folder);
}

std::vector<std::string> existing_files(const PictureList& list) {
  std::vector<std::string> files;
  for (const ListedPicture& picture : list.pictures) {
    if (picture.problem.empty()) files.push_back(picture.path);
  }
  return files;
}

tl::expected<std::vector<std::string>, InputError> pictures_in_folder(const std::string& folder) {
  return list_pictures(folder).map(existing_files);
}

}  // namespace moiregauge::internal
