// SPDX-License-Identifier: Apache-2.0
// Library for LD_PRELOAD that counts the calls that write under a path, and makes one of them fail.
//
//     FAIL_UNDER   beginning of the paths that count; the parent folder counts, too (for fsync)
//     FAIL_AT      number of the call that fails, from 1; 0 or empty: none
//     FAIL_WITH    its errno
//     FAIL_HOW     once
//                  on: it and all later calls fail, as on a full disk
//                  short: a write transfers half of its bytes, and the next call fails
//     FAIL_LOG     log file: number, name, file size, time (CLOCK_MONOTONIC, s) and path of each call; a successful
//                  sync adds "synced" with the size at its start
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>

namespace {

template <typename Function>
Function next_of(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

struct Plan {
  std::string under, parent;
  long at = 0;
  int why = EIO;
  bool goes_on = false, is_short = false;
  int log = -1;
};

const Plan& plan() {
  static const Plan made = [] {
    const auto word = [](const char* name) { return std::string(::getenv(name) == nullptr ? "" : ::getenv(name)); };
    Plan p;
    p.under = word("FAIL_UNDER");
    p.parent = p.under.substr(0, p.under.rfind('/'));
    p.at = std::atol(word("FAIL_AT").c_str());
    p.why = std::atoi(word("FAIL_WITH").c_str());
    p.goes_on = word("FAIL_HOW") == "on";
    p.is_short = word("FAIL_HOW") == "short";
    if (const std::string log = word("FAIL_LOG"); !log.empty())
      p.log = static_cast<int>(
          ::syscall(SYS_openat, AT_FDCWD, log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
    return p;
  }();
  return made;
}

std::atomic<long> calls = 0;

bool counts(const std::string& path) {
  if (plan().under.empty()) return false;
  return path.compare(0, plan().under.size(), plan().under) == 0 || path == plan().parent;
}

std::string path_of(int file) {
  char name[PATH_MAX];
  const ssize_t size = ::readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), name, sizeof name);
  return {name, size < 0 ? 0 : static_cast<std::size_t>(size)};
}

enum class Fate { kWorks, kFails, kHalf };

void note(long n, const char* what, long size, const std::string& path) {
  if (plan().log < 0) return;
  struct ::timespec now {};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  char line[PATH_MAX + 100];
  const int length =
      std::snprintf(line, sizeof line, "%ld %s %ld %.6f %s\n", n, what, size,
                    static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec), path.c_str());
  ::syscall(SYS_write, plan().log, line, length);
}

long size_of(int file) {
  struct ::stat about {};
  return file >= 0 && ::fstat(file, &about) == 0 ? static_cast<long>(about.st_size) : -1;
}

// Counts the call and returns its result. `file` is -1 if the call has no open file.
Fate fate_of(const char* what, const std::string& path, int file = -1) {
  if (!counts(path)) return Fate::kWorks;
  const long n = ++calls;
  note(n, what, size_of(file), path);
  if (plan().at == 0) return Fate::kWorks;
  if (plan().is_short) return n == plan().at ? Fate::kHalf : n == plan().at + 1 ? Fate::kFails : Fate::kWorks;
  return n == plan().at || (plan().goes_on && n > plan().at) ? Fate::kFails : Fate::kWorks;
}

int failed() {
  errno = plan().why;
  return -1;
}

bool is_for_writing(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC)) != 0; }

}  // namespace

extern "C" {

#define OPEN_LIKE(name)                                                                  \
  int name(const char* path, int flags, ...) {                                           \
    va_list more;                                                                        \
    va_start(more, flags);                                                               \
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0; \
    va_end(more);                                                                        \
    if (is_for_writing(flags) && fate_of("open", path) == Fate::kFails) return failed(); \
    static const auto real = next_of<int (*)(const char*, int, ...)>(#name);             \
    return real(path, flags, mode);                                                      \
  }
OPEN_LIKE(open)
OPEN_LIKE(open64)

int mkostemp(char* path, int flags) {
  if (fate_of("open", path) == Fate::kFails) return failed();
  static const auto real = next_of<int (*)(char*, int)>("mkostemp");
  return real(path, flags);
}

ssize_t write(int file, const void* bytes, size_t size) {
  static const auto real = next_of<ssize_t (*)(int, const void*, size_t)>("write");
  if (plan().under.empty() || file <= STDERR_FILENO) return real(file, bytes, size);
  const Fate fate = fate_of("write", path_of(file), file);
  if (fate == Fate::kFails) return failed();
  return real(file, bytes, fate == Fate::kHalf ? (size + 1) / 2 : size);
}

#define OF_A_FILE(name)                                                             \
  int name(int file) {                                                              \
    if (fate_of(#name, path_of(file), file) == Fate::kFails) return failed();       \
    static const auto real = next_of<int (*)(int)>(#name);                          \
    const long size = size_of(file);                                                \
    const int done = real(file);                                                    \
    const int why = errno;                                                          \
    if (done == 0 && counts(path_of(file))) note(0, "synced", size, path_of(file)); \
    errno = why;                                                                    \
    return done;                                                                    \
  }
OF_A_FILE(fsync)
OF_A_FILE(fdatasync)

#define TRUNCATES(name, Offset)                                                     \
  int name(int file, Offset size) {                                                 \
    if (fate_of("ftruncate", path_of(file), file) == Fate::kFails) return failed(); \
    static const auto real = next_of<int (*)(int, Offset)>(#name);                  \
    return real(file, size);                                                        \
  }
TRUNCATES(ftruncate, off_t)
TRUNCATES(ftruncate64, off64_t)

int mkdir(const char* path, mode_t mode) {
  if (fate_of("mkdir", path) == Fate::kFails) return failed();
  static const auto real = next_of<int (*)(const char*, mode_t)>("mkdir");
  return real(path, mode);
}

int rename(const char* from, const char* to) {
  if (fate_of("rename", to) == Fate::kFails) return failed();
  static const auto real = next_of<int (*)(const char*, const char*)>("rename");
  return real(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  if (fate_of("rename", to) == Fate::kFails) return failed();
  static const auto real = next_of<int (*)(int, const char*, int, const char*, unsigned)>("renameat2");
  return real(from_folder, from, to_folder, to, flags);
}

}  // extern "C"
