// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/config/camera_yaml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/io/config/toml_table.h"

namespace moiregauge::internal {
namespace {

std::string lower(std::string_view text) {
  std::string low(text);
  for (char& c : low) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return low;
}

std::size_t indent_of(std::string_view line) {
  const std::size_t indent = line.find_first_not_of(' ');
  return indent == std::string_view::npos ? line.size() : indent;
}

// The text after a key, and the position of the key.
struct Block {
  std::string text;
  std::size_t line = 1;
  std::size_t column = 1;
};

// Returns the text after each "key:" up to the next key that is not deeper. Ignores case, because OpenCV and ROS differ
// in capitals.
std::vector<Block> blocks_of(const std::string& text, std::string_view key) {
  std::vector<Block> blocks;
  bool open = false;  // the last block continues
  std::size_t key_indent = 0;
  std::size_t number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view line(text.data() + start, end - start);
    start = end + 1;
    ++number;
    line = line.substr(0, line.find('#'));
    const std::size_t indent = indent_of(line);
    if (indent == line.size() || line.starts_with("%") || line.starts_with("---")) continue;
    const std::size_t colon = line.find(':');
    const bool is_key = colon != std::string_view::npos && line[indent] != '-';
    if (is_key && indent <= key_indent) open = false;
    if (open) {
      blocks.back().text += fmt::format("\n{}", line);
    } else if (is_key && colon > indent && lower(line.substr(indent, colon - indent)) == key) {
      open = true;
      key_indent = indent;
      blocks.push_back({std::string(line.substr(colon + 1)), number, indent + 1});
    }
  }
  return blocks;
}

// Returns all numbers of a list, nested or not. Fails with the first word that is no finite number.
tl::expected<std::vector<double>, std::string> numbers_in(std::string_view list) {
  constexpr std::string_view kBetween = " ,[]\n\r\t";
  std::vector<double> numbers;
  while (!list.empty()) {
    const bool dash = list[0] == '-' && (list.size() == 1 || list[1] == ' ' || list[1] == '\n');
    if (dash || list[0] == '+' || kBetween.find(list[0]) != std::string_view::npos) {
      list.remove_prefix(1);
      continue;
    }
    double number = 0.0;
    const std::string_view word = list.substr(0, list.find_first_of(kBetween));
    const auto [after, problem] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (problem != std::errc() || after != word.data() + word.size() || !std::isfinite(number))
      return tl::unexpected(std::string(word.substr(0, 32)));
    numbers.push_back(number);
    list.remove_prefix(word.size());
  }
  return numbers;
}

// Reads the keys of a calibration and collects the mistakes.
class Calibration {
 public:
  Calibration(const std::string& text, TomlMistakes& wrong) : text_(text), wrong_(wrong) {}

  // Returns the first block of this key.
  [[nodiscard]] std::optional<Block> block(std::string_view key) const {
    auto blocks = blocks_of(text_, key);
    return blocks.empty() ? std::nullopt : std::optional(std::move(blocks.front()));
  }

  void refuse_twice(std::string_view key) {
    const auto blocks = blocks_of(text_, key);
    if (blocks.size() > 1)
      mistake(blocks[1], fmt::format("{} is given twice (first in line {}), remove one", key, blocks[0].line));
  }

  // Returns the numbers of a matrix. Returns nothing and adds a mistake if it is no list of numbers.
  std::optional<std::vector<double>> matrix(const Block& block, std::string_view key) {
    const auto data = blocks_of(block.text, "data");  // absent if the list follows the key directly
    auto numbers = numbers_in(data.empty() ? block.text : data.front().text);
    if (numbers) return *std::move(numbers);
    mistake(block, fmt::format("{} contains \"{}\", which is not a finite number", key, numbers.error()));
    return std::nullopt;
  }

  // Returns a size in px. 0: not stated, as in Camera.
  int size(std::string_view key) {
    const auto stated = block(key);
    if (!stated) return 0;
    const auto numbers = numbers_in(stated->text);
    const bool whole = numbers && numbers->size() == 1 && numbers->front() >= 1.0 && numbers->front() < 1e6 &&
                       numbers->front() == std::floor(numbers->front());
    if (!whole) mistake(*stated, fmt::format("{} must be a whole number of pixels", key));
    return whole ? static_cast<int>(numbers->front()) : 0;
  }

  void mistake(const Block& place, const std::string& what) { wrong_.add(place.line, place.column, what); }

 private:
  const std::string& text_;
  TomlMistakes& wrong_;
};

// Adds a mistake that names the lens model, if it is a fisheye.
void refuse_fisheye(Calibration& file) {
  for (const char* key : {"distortion_model", "fisheye_model"}) {
    const auto block = file.block(key);
    if (!block) continue;
    const std::string word = lower(block->text);
    const bool fisheye = word.find("equidistant") != std::string::npos || word.find("fisheye") != std::string::npos ||
                         (key[0] == 'f' && word.find('1') != std::string::npos);
    if (fisheye) file.mistake(*block, "a fisheye lens is not supported, only the model with k1 k2 p1 p2 k3");
  }
}

// Returns the reason why this is no camera matrix, or nothing.
std::optional<std::string> problem_with_matrix(const std::vector<double>& matrix) {
  if (matrix.size() != 9) return fmt::format("camera_matrix holds {} numbers instead of 9", matrix.size());
  if (!(matrix[0] > 0.0 && matrix[4] > 0.0)) return "the focal lengths of camera_matrix must be greater than 0";
  if (matrix[1] != 0.0) return "camera_matrix has skew, which is not supported";
  if (matrix[3] != 0.0 || matrix[6] != 0.0 || matrix[7] != 0.0 || matrix[8] != 1.0) {
    return "camera_matrix is not [fx 0 cx; 0 fy cy; 0 0 1]";
  }
  return std::nullopt;
}

// Returns the reason why these coefficients cannot be used, or nothing.
std::optional<std::string> problem_with_lens(const std::vector<double>& lens) {
  if (!lens.empty() && lens.size() < 4) return "distortion_coefficients holds fewer than 4 numbers";
  for (std::size_t i = 5; i < lens.size(); ++i) {
    if (lens[i] != 0.0)
      return "distortion_coefficients holds more than five numbers, calibrate again with k1 k2 p1 p2 k3 only";
  }
  return std::nullopt;
}

// Reads the image size, px. Width and height require each other.
void read_size(Calibration& file, Camera& camera) {
  camera.width = file.size("image_width");
  camera.height = file.size("image_height");
  const auto width = file.block("image_width"), height = file.block("image_height");
  if (width && !height) file.mistake(*width, "image_height is missing");
  if (height && !width) file.mistake(*height, "image_width is missing");
}

void read_matrix(Calibration& file, Camera& camera) {
  const auto block = file.block("camera_matrix");
  if (!block) return file.mistake({}, "camera_matrix is missing");
  const auto matrix = file.matrix(*block, "camera_matrix");
  if (!matrix) return;
  if (const auto problem = problem_with_matrix(*matrix)) return file.mistake(*block, *problem);
  camera.fx = (*matrix)[0];
  camera.fy = (*matrix)[4];
  camera.cx = (*matrix)[2];
  camera.cy = (*matrix)[5];
}

void read_lens(Calibration& file, Camera& camera) {
  const auto block = file.block("distortion_coefficients");
  if (!block) return;
  auto lens = file.matrix(*block, "distortion_coefficients");
  if (!lens) return;
  if (const auto problem = problem_with_lens(*lens)) return file.mistake(*block, *problem);
  lens->resize(5);
  camera.k1 = (*lens)[0];
  camera.k2 = (*lens)[1];
  camera.p1 = (*lens)[2];
  camera.p2 = (*lens)[3];
  camera.k3 = (*lens)[4];
}

}  // namespace

tl::expected<Camera, std::string> parse_camera_yaml(const std::string& text, const std::string& path) {
  TomlMistakes mistakes(path);
  Calibration file(text, mistakes);
  for (const char* key :
       {"image_width", "image_height", "camera_matrix", "distortion_coefficients", "distortion_model", "fisheye_model"})
    file.refuse_twice(key);
  Camera camera;
  read_size(file, camera);
  read_matrix(file, camera);
  read_lens(file, camera);
  refuse_fisheye(file);
  if (mistakes.empty()) return camera;
  return tl::unexpected(fmt::format("{}", fmt::join(mistakes.lines(), "\n")));
}

}  // namespace moiregauge::internal
