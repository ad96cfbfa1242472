// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/http/connection.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kFilePiece = 256 << 10;  // bytes
constexpr std::size_t kShare = 1 << 20;        // bytes after which other connections have their turn

}  // namespace

Transfer send_output(Connection& c) {
  std::size_t total = 0;
  while (c.has_output()) {
    if (total >= kShare) return Transfer::kWait;
    if (c.sent == c.out.size()) {
      c.out.clear();
      c.sent = 0;
      // A file that has become shorter cannot be completed: the length is already stated.
      if (!c.file->read(c.file_offset, kFilePiece, c.out)) return Transfer::kEnd;
      c.file_offset += static_cast<std::int64_t>(c.out.size());
    }
    std::size_t written = 0;
    const Transfer outcome = c.channel->write(std::string_view(c.out).substr(c.sent), written);
    c.sent += written;
    total += written;
    if (outcome != Transfer::kProgress) return outcome;
  }
  c.out.clear();
  c.sent = 0;
  return Transfer::kProgress;
}

}  // namespace moiregauge::internal
