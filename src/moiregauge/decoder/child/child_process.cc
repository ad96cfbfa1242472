// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/child/child_process.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "moiregauge/decoder/child/decode_child.h"

namespace moiregauge::internal {
namespace {

// Returns -1 if the text is no number.
std::int64_t whole_number(std::string_view text) {
  std::int64_t number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} ? number : -1;
}

// Runs before main(): glibc passes the program's arguments to constructors. It is in this file so that every program
// that links start() links it too. It never returns in the child, so none of the program's own code runs there.
__attribute__((constructor)) void become_the_child(int count, char** words) {
  if (count != 4) return;
  const std::string_view mode = words[1];
  if (mode != wire::kChildMode && mode != wire::kLiveMode) return;
  const std::int64_t max_pixels = whole_number(words[2]), first_frame = whole_number(words[3]);
  const bool sane = max_pixels > 0 && max_pixels <= wire::kMaxPixels && first_frame >= 0;
  if (!sane) ::_exit(2);
  ::_exit(mode == wire::kLiveMode ? decode_live_child(max_pixels) : decode_child(max_pixels, first_frame));
}

// Returns a copy of the descriptor above the child's fixed numbers, which spawn() assigns one after the other.
int moved_up(int file) { return ::fcntl(file, F_DUPFD_CLOEXEC, 16); }

struct ChildFiles {
  int input, memory, socket;
};

// `words`: the child's arguments after its name.
int spawn(pid_t& process, const std::string& program, const ChildFiles& files, std::array<std::string, 3> words) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, files.input, wire::kInputFile);
  posix_spawn_file_actions_adddup2(&actions, files.memory, wire::kMemoryFile);
  posix_spawn_file_actions_adddup2(&actions, files.socket, wire::kSocket);
  posix_spawn_file_actions_addclosefrom_np(&actions, wire::kFirstUnusedFile);
  std::string name = "moiregauge";
  char* arguments[] = {name.data(), words[0].data(), words[1].data(), words[2].data(), nullptr};
  // The parent handles requests to stop, from the keyboard or to all processes of a service or a cluster's task. The
  // child ends when the parent closes the socket. A child that ended first would look like a damaged video.
  sigset_t blocked;
  sigemptyset(&blocked);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&blocked, signal);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setsigmask(&attributes, &blocked);
  const int problem = ::posix_spawn(&process, program.c_str(), &actions, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return problem;
}

}  // namespace

std::string default_child_program() {
  static const char place = 0;  // in the file that contains this code
  Dl_info file{};
  std::error_code ignored;
  if (::dladdr(&place, &file) != 0 && file.dli_fname != nullptr) {
    const auto library = std::filesystem::weakly_canonical(file.dli_fname, ignored);
    const auto program = library.parent_path() / "moiregauge" / "moiregauge-decode";
    if (std::filesystem::is_regular_file(program, ignored)) return program.string();
  }
  return "/proc/self/exe";
}

tl::expected<ChildProcess, std::string> ChildProcess::start(const std::string& program, int input,
                                                            std::int64_t max_pixels, const char* mode,
                                                            long first_frame) {
  ChildProcess child;
  int ends[2] = {-1, -1};
  child.memory_file_ = ::memfd_create("moiregauge-frames", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (child.memory_file_ < 0 || ::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    return tl::unexpected(std::string(std::strerror(errno)));
  }
  child.socket_ = ends[0];
  const int files[] = {moved_up(input), moved_up(child.memory_file_), moved_up(ends[1])};
  const bool are_open = std::all_of(std::begin(files), std::end(files), [](int file) { return file >= 0; });
  // Numbers above the limit on open files are refused as EINVAL.
  const int problem = are_open ? spawn(child.process_, program, {files[0], files[1], files[2]},
                                       {mode, std::to_string(max_pixels), std::to_string(first_frame)})
                               : EMFILE;
  for (const int file : files) {
    if (file >= 0) ::close(file);
  }
  ::close(ends[1]);
  if (problem == 0) return child;
  child.process_ = -1;
  return tl::unexpected(fmt::format("{}: {}", program, std::strerror(problem)));
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      socket_(std::exchange(other.socket_, -1)),
      memory_file_(std::exchange(other.memory_file_, -1)),
      memory_(std::exchange(other.memory_, nullptr)),
      memory_bytes_(other.memory_bytes_) {}

ChildProcess::~ChildProcess() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (memory_ != nullptr) ::munmap(const_cast<std::byte*>(memory_), memory_bytes_);
  if (socket_ >= 0) ::close(socket_);
  if (memory_file_ >= 0) ::close(memory_file_);
}

std::string ChildProcess::last_words() {
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  if (WIFSIGNALED(status)) return fmt::format("the video decoder stopped (signal {})", WTERMSIG(status));
  return fmt::format("the video decoder stopped (exit code {})", WEXITSTATUS(status));
}

bool ChildProcess::has_record(std::chrono::milliseconds timeout) const {
  pollfd waiting{socket_, POLLIN, 0};
  return ::poll(&waiting, 1, static_cast<int>(timeout.count())) > 0;
}

tl::expected<wire::Record, std::string> ChildProcess::receive(std::chrono::milliseconds watchdog) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + watchdog;
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
    pollfd waiting{socket_, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(left > 0 ? left : 0));
    if (ready < 0 && errno == EINTR) continue;
    if (ready > 0) break;
    ::kill(process_, SIGKILL);
    return tl::unexpected(
        fmt::format("the video decoder stopped (silent for {} s)", std::chrono::duration<double>(watchdog).count()));
  }
  wire::Record record;
  ssize_t got = ::recv(socket_, &record, sizeof record, 0);
  // A child that exits with unread releases resets the connection. The reset is reported once, before the records it
  // sent, which still count.
  if (got < 0 && errno == ECONNRESET) got = ::recv(socket_, &record, sizeof record, 0);
  if (got == sizeof record) return record;
  ::kill(process_, SIGKILL);  // the child may only have closed the socket; after an earlier death SIGKILL has no effect
  return tl::unexpected(last_words());
}

void ChildProcess::release(int slot) const {
  const wire::Release release{slot};
  // A dead child cannot use the slot, and receive() reports its death.
  static_cast<void>(::send(socket_, &release, sizeof release, MSG_NOSIGNAL | MSG_DONTWAIT));
}

const std::byte* ChildProcess::map(std::size_t bytes) {
  struct stat about {};
  const int seals = ::fcntl(memory_file_, F_GET_SEALS);
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0) return nullptr;
  if (::fstat(memory_file_, &about) != 0 || static_cast<std::size_t>(about.st_size) < bytes) return nullptr;
  void* memory = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, memory_file_, 0);
  if (memory == MAP_FAILED) return nullptr;
  memory_ = static_cast<const std::byte*>(memory);
  memory_bytes_ = bytes;
  return memory_;
}

}  // namespace moiregauge::internal
