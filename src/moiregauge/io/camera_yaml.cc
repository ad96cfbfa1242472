// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/camera_yaml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace moiregauge {
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

// What stands behind "key:" up to the next key that is not deeper; OpenCV and ROS differ in capitals.
std::optional<std::string> block_of(const std::string& text, std::string_view key) {
  std::optional<std::string> block;
  std::size_t key_indent = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view line(text.data() + start, end - start);
    start = end + 1;
    line = line.substr(0, line.find('#'));
    const std::size_t indent = indent_of(line);
    if (indent == line.size() || line.starts_with("%") || line.starts_with("---")) continue;
    const bool is_key = line.find(':') != std::string_view::npos && line[indent] != '-';
    if (block && is_key && indent <= key_indent) return block;
    if (block) {
      *block += fmt::format("\n{}", line);
    } else if (is_key && lower(line.substr(indent, line.find(':') - indent)) == key) {
      key_indent = indent;
      block = std::string(line.substr(line.find(':') + 1));
    }
  }
  return block;
}

// All numbers of a list, nested or not; nothing when something else stands in it.
std::optional<std::vector<double>> numbers_in(std::string_view list) {
  std::vector<double> numbers;
  const char* at = list.data();
  const char* const end = list.data() + list.size();
  while (at != end) {
    const bool dash = *at == '-' && (at + 1 == end || at[1] == ' ' || at[1] == '\n');
    if (dash || std::strchr(" ,[]\n\r\t+", *at) != nullptr) {
      ++at;
      continue;
    }
    double number = 0.0;
    const auto [after, problem] = std::from_chars(at, end, number);
    if (problem != std::errc() || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
    at = after;
  }
  return numbers;
}

std::optional<std::vector<double>> matrix(const std::string& text, std::string_view key) {
  const auto block = block_of(text, key);
  if (!block) return std::nullopt;
  const auto data = block_of(*block, "data");  // absent when the list follows the key at once
  return numbers_in(data ? *data : *block);
}

// 0: not stated, as in Camera.
int size_in(const std::string& text, std::string_view key) {
  const auto block = block_of(text, key);
  const auto numbers = block ? numbers_in(*block) : std::nullopt;
  if (!numbers || numbers->size() != 1 || !(numbers->front() > 0.0 && numbers->front() < 1e6)) return 0;
  return static_cast<int>(numbers->front());
}

std::string model_in(const std::string& text) {
  std::string model = lower(block_of(text, "distortion_model").value_or("plumb_bob"));
  std::erase_if(model, [](char c) { return std::strchr(" \"'\r\n", c) != nullptr; });
  return model;
}

// Why these coefficients are not our lens, or nothing.
std::optional<std::string> problem_with(const std::vector<double>& matrix, const std::vector<double>& lens) {
  if (matrix.size() != 9) return fmt::format("camera_matrix holds {} numbers instead of 9", matrix.size());
  if (!(matrix[0] > 0.0 && matrix[4] > 0.0)) return "the focal lengths of camera_matrix must be greater than 0";
  if (matrix[1] != 0.0) return "camera_matrix has skew, which this lens model does not";
  if (matrix[3] != 0.0 || matrix[6] != 0.0 || matrix[7] != 0.0 || matrix[8] != 1.0) {
    return "camera_matrix is not [fx 0 cx; 0 fy cy; 0 0 1]";
  }
  if (!lens.empty() && lens.size() < 4) return "distortion_coefficients holds fewer than 4 numbers";
  for (std::size_t i = 5; i < lens.size(); ++i) {
    if (lens[i] != 0.0) return "more than five distortion coefficients: calibrate again with k1 k2 p1 p2 k3 only";
  }
  return std::nullopt;
}

}  // namespace

tl::expected<Camera, std::string> parse_camera_yaml(const std::string& text, const std::string& path) {
  const auto found = matrix(text, "camera_matrix");
  if (!found) return tl::unexpected(fmt::format("{}: no readable camera_matrix", path));
  const bool states_lens = block_of(text, "distortion_coefficients").has_value();
  const auto lens = states_lens ? matrix(text, "distortion_coefficients") : std::vector<double>{};
  if (!lens) return tl::unexpected(fmt::format("{}: no readable distortion_coefficients", path));
  const std::string model = model_in(text);
  if (model == "equidistant" || model == "fisheye" ||
      block_of(text, "fisheye_model").value_or(" 0").find('1') != std::string::npos) {
    return tl::unexpected(fmt::format("{}: a fisheye lens; only the five-term model k1 k2 p1 p2 k3 is known", path));
  }
  if (const auto problem = problem_with(*found, *lens)) return tl::unexpected(fmt::format("{}: {}", path, *problem));
  const auto term = [&](std::size_t i) { return i < lens->size() ? (*lens)[i] : 0.0; };
  return Camera{size_in(text, "image_width"),
                size_in(text, "image_height"),
                (*found)[0],
                (*found)[4],
                (*found)[2],
                (*found)[5],
                term(0),
                term(1),
                term(2),
                term(3),
                term(4)};
}

}  // namespace moiregauge
