// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <csignal>

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>

namespace moiregauge::internal {
namespace {

// One row of the signal handler's table. Atomics, because a signal handler must not wait for a lock.
struct Mapping {
  std::atomic<bool> taken{false};
  std::atomic<std::uintptr_t> begin{0};
  std::atomic<std::uintptr_t> end{0};
  std::atomic<bool> torn{false};
};
// A signal handler can read nothing but globals.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
std::array<Mapping, 16> mappings;
struct sigaction before_ours {};
std::uintptr_t page_bytes = 4096;
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

void on_bus_error(int signal, siginfo_t* what, void* context) {
  const auto at = reinterpret_cast<std::uintptr_t>(what->si_addr);
  for (Mapping& mapping : mappings) {
    if (at < mapping.begin || at >= mapping.end) continue;
    void* page = static_cast<std::byte*>(what->si_addr) - at % page_bytes;
    mapping.torn = true;
    if (::mmap(page, page_bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == page) return;
  }
  if ((before_ours.sa_flags & SA_SIGINFO) != 0) return before_ours.sa_sigaction(signal, what, context);
  ::sigaction(signal, &before_ours, nullptr);  // the access repeats and ends as it would without this handler
}

void watch_bus_errors() {
  static std::once_flag once;
  std::call_once(once, [] {
    page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction ours {};
    ours.sa_sigaction = on_bus_error;
    ours.sa_flags = static_cast<int>(SA_SIGINFO);
    ::sigaction(SIGBUS, &ours, &before_ours);
  });
}

std::optional<std::size_t> free_place() {
  for (std::size_t i = 0; i < mappings.size(); ++i) {
    if (!mappings[i].taken.exchange(true)) return i;
  }
  return std::nullopt;
}

}  // namespace

std::shared_ptr<const MappedFile> MappedFile::open(const std::string& path) {
  const auto place = free_place();
  if (!place) return nullptr;
  std::shared_ptr<MappedFile> mapped(new MappedFile);
  mapped->place_ = *place;
  mapped->file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat about {};
  if (mapped->file_ < 0 || ::fstat(mapped->file_, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size <= 0)
    return nullptr;
  const auto size = static_cast<std::size_t>(about.st_size);
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, mapped->file_, 0);
  if (data == MAP_FAILED) return nullptr;
  mapped->data_ = static_cast<const std::byte*>(data);
  mapped->size_ = size;
  watch_bus_errors();
  Mapping& known = mappings[*place];
  known.torn = false;
  known.begin = reinterpret_cast<std::uintptr_t>(data);
  known.end = known.begin + (size + page_bytes - 1) / page_bytes * page_bytes;
  return mapped;
}

MappedFile::~MappedFile() {
  Mapping& known = mappings[place_];
  known.begin = known.end = 0;
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
  if (file_ >= 0) ::close(file_);
  known.taken = false;
}

bool MappedFile::is_whole() const {
  struct stat about {};
  return !mappings[place_].torn && ::fstat(file_, &about) == 0 && about.st_size >= 0 &&
         static_cast<std::size_t>(about.st_size) >= size_;
}

void MappedFile::let_go(std::span<const std::byte> part) const {
  const auto from = reinterpret_cast<std::uintptr_t>(part.data());
  const std::size_t before = from % page_bytes;  // bytes from the start of the page
  void* first = const_cast<std::byte*>(part.data() - before);
  static_cast<void>(::madvise(first, before + part.size(), MADV_DONTNEED));
}

}  // namespace moiregauge::internal
