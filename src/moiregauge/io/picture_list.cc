// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/picture_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>

#include <fmt/format.h>

namespace moiregauge {
namespace fs = std::filesystem;
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view digits_at(std::string_view text, std::size_t start) {
  std::size_t end = start;
  while (end < text.size() && is_digit(text[end])) ++end;
  return text.substr(start, end - start);
}

std::string_view without_zeros(std::string_view digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string_view::npos ? digits.substr(digits.size()) : digits.substr(first);
}

bool is_picture_name(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  constexpr std::array kEndings{".png", ".tif", ".tiff", ".jpg", ".jpeg"};
  return path.filename().string().front() != '.' &&
         std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

tl::expected<std::vector<std::string>, InputError> names_in(const fs::path& folder) {
  std::error_code problem;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end; entry.increment(problem)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) names.push_back(entry->path().filename().string());
  }
  if (problem)
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("cannot read folder: {}: {}", folder.string(), problem.message()));
  return names;
}

// What stands around the one number of a pattern.
struct NumberedName {
  std::string before;
  std::string after;
  std::size_t width = 0;  // least digits; 0 in front only if the pattern says so
};

// "%d" or "%0Nd", once, and nothing else of printf: the pattern never reaches printf.
std::optional<NumberedName> parsed_pattern(const std::string& name) {
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return std::nullopt;
  const std::string_view width = digits_at(name, percent + 1);
  const std::size_t end = percent + 1 + width.size();
  if (end >= name.size() || name[end] != 'd' || width.size() > 3) return std::nullopt;
  if (!width.empty() && width.front() != '0') return std::nullopt;
  NumberedName parsed{name.substr(0, percent), name.substr(end + 1), 0};
  std::from_chars(width.data(), width.data() + width.size(), parsed.width);
  if (parsed.after.find('%') != std::string::npos || parsed.width > 18) return std::nullopt;
  return parsed;
}

std::string numbered(const NumberedName& pattern, long number) {
  return fmt::format("{}{:0{}}{}", pattern.before, number, pattern.width, pattern.after);
}

std::optional<long> number_in(const NumberedName& pattern, std::string_view name) {
  if (!name.starts_with(pattern.before)) return std::nullopt;
  const std::string_view digits = digits_at(name, pattern.before.size());
  long number = 0;
  if (digits.empty() || digits.size() > 18) return std::nullopt;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return numbered(pattern, number) == name ? std::optional(number) : std::nullopt;
}

}  // namespace

bool comes_before(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view run_a = digits_at(a, i);
      const std::string_view run_b = digits_at(b, j);
      const std::string_view value_a = without_zeros(run_a);
      const std::string_view value_b = without_zeros(run_b);
      if (value_a.size() != value_b.size()) return value_a.size() < value_b.size();
      if (value_a != value_b) return value_a < value_b;
      i += run_a.size();
      j += run_b.size();
    } else if (a[i] != b[j]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
    } else {
      ++i;
      ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // frame01 and frame1: some fixed order
}

tl::expected<std::vector<std::string>, InputError> pictures_in_folder(const std::string& folder) {
  for (const fs::path& place : {fs::path(folder), fs::path(folder) / "frames"}) {
    std::error_code ignored;
    if (place != fs::path(folder) && !fs::is_directory(place, ignored)) break;
    auto names = names_in(place);
    if (!names) return tl::unexpected(names.error());
    std::erase_if(*names, [](const std::string& name) { return !is_picture_name(name); });
    std::sort(names->begin(), names->end(), comes_before);
    for (std::string& name : *names) name = (place / name).string();
    if (!names->empty()) return names;
  }
  return std::vector<std::string>{};
}

tl::expected<std::vector<std::string>, InputError> pictures_of_pattern(const std::string& pattern) {
  const fs::path path(pattern);
  const auto parsed = parsed_pattern(path.filename().string());
  if (!parsed) {
    return input_failure(
        InputErrorKind::kUnreadable,
        fmt::format("not a pattern: {}: give one %d or %0Nd in the file name, as in img_%04d.png", pattern));
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const auto names = names_in(folder);
  if (!names) return tl::unexpected(names.error());
  std::set<long> numbers;
  for (const std::string& name : *names) {
    if (const auto number = number_in(*parsed, name)) numbers.insert(*number);
  }
  if (numbers.empty())
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("no picture: {}: no file of this pattern exists", pattern));
  const long count = *numbers.rbegin() - *numbers.begin() + 1;
  if (count > 2 * static_cast<long>(numbers.size()) + 10) {
    return input_failure(InputErrorKind::kUnreadable,
                         fmt::format("too many numbers missing: {}: {} files between {} and {}", pattern,
                                     numbers.size(), *numbers.begin(), *numbers.rbegin()));
  }
  std::vector<std::string> files;
  for (long number = *numbers.begin(); number <= *numbers.rbegin(); ++number) {
    files.push_back((folder / numbered(*parsed, number)).string());
  }
  return files;
}

}  // namespace moiregauge
