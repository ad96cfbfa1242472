// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/file_hash.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "moiregauge/base/plain_file.h"
#include "moiregauge/base/sha256.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;

void add_block(Sha256& sum, const std::string& path, long from_end) {
  const auto file = open_plain_file(path);
  if (!file || (from_end > 0 && std::fseek(file->get(), -from_end, SEEK_END) != 0)) return;
  std::vector<std::byte> block(kBlock);
  sum.add({block.data(), std::fread(block.data(), 1, block.size(), file->get())});
}

}  // namespace

std::string sha256_of_files(const std::vector<std::string>& paths, const std::function<bool()>& may_continue) {
  Sha256 sum;
  std::vector<std::byte> block(kBlock);
  for (const std::string& path : paths) {
    const auto file = open_plain_file(path);
    if (!file) continue;
    while (const std::size_t read = std::fread(block.data(), 1, block.size(), file->get())) {
      sum.add({block.data(), read});
      if (!may_continue()) return {};
    }
  }
  return sum.hex();
}

std::string quick_fingerprint(const std::vector<std::string>& paths) {
  std::uintmax_t bytes = 0, of_last = 0;
  for (const std::string& path : paths) {
    std::error_code error;
    of_last = std::filesystem::file_size(path, error);
    if (error) of_last = 0;
    bytes += of_last;
  }
  Sha256 sum;
  if (!paths.empty()) {
    add_block(sum, paths.front(), 0);
    add_block(sum, paths.back(), static_cast<long>(std::min<std::uintmax_t>(of_last, kBlock)));
  }
  return fmt::format("{} files, {} bytes, {}", paths.size(), bytes, sum.hex());
}

}  // namespace moiregauge::internal
