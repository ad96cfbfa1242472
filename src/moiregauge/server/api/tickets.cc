// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/api/tickets.h"

#include <sys/random.h>

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "moiregauge/server/api/access.h"

namespace moiregauge::internal {
namespace {

constexpr std::size_t kMaxTickets = 100;
constexpr std::chrono::minutes kTicketTime(10);
constexpr int kTicketBytes = 16;

}  // namespace

std::string random_digits(int bytes) {
  std::vector<unsigned char> random(static_cast<std::size_t>(bytes));
  while (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) continue;
  return fmt::format("{:02x}", fmt::join(random, ""));
}

std::string Tickets::add(std::string path) {
  const std::lock_guard lock(mutex_);
  if (tickets_.size() >= kMaxTickets) tickets_.pop_front();
  tickets_.push_back({random_digits(kTicketBytes), std::move(path), std::chrono::steady_clock::now() + kTicketTime});
  return tickets_.back().digits;
}

std::optional<std::string> Tickets::path_of(std::string_view ticket) const {
  const std::lock_guard lock(mutex_);
  for (const Ticket& known : tickets_) {
    if (is_same_secret(known.digits, ticket) && std::chrono::steady_clock::now() < known.end) return known.path;
  }
  return std::nullopt;
}

}  // namespace moiregauge::internal
