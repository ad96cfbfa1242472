// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace moiregauge::internal {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMaxLineBytes = 4096;
constexpr std::size_t kMaxLines = 1000;
constexpr int kExecFailed = 127;

void close_file(int& file) {
  if (file >= 0) ::close(file);
  file = -1;
}

// Moves a descriptor above the standard files. A caller that has closed these would get pipes with the numbers 0 to 2.
int above_standard_files(int file) {
  if (file < 0 || file > 2) return file;
  const int moved = ::fcntl(file, F_DUPFD_CLOEXEC, 3);
  const int why = errno;
  ::close(file);
  errno = why;
  return moved;
}

struct Pipe {
  int read_end = -1, write_end = -1;
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_file(read_end);
    close_file(write_end);
  }
  [[nodiscard]] bool open() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return false;
    read_end = above_standard_files(ends[0]);
    write_end = above_standard_files(ends[1]);
    return read_end >= 0 && write_end >= 0;
  }
};

struct ChildFileSet {
  Pipe messages, output, report;  // stderr, stdout, and the reason why exec failed
  int null_file = -1;
  ChildFileSet() = default;
  ChildFileSet(const ChildFileSet&) = delete;
  ChildFileSet& operator=(const ChildFileSet&) = delete;
  ~ChildFileSet() { close_file(null_file); }
  // Fails with errno.
  [[nodiscard]] bool open(bool with_output) {
    null_file = above_standard_files(::open("/dev/null", O_RDWR | O_CLOEXEC));
    return null_file >= 0 && messages.open() && report.open() && (!with_output || output.open());
  }
};

// All that the child needs between fork and exec. There it may only make system calls, because another thread of the
// caller may have held any lock, such as that of malloc.
struct ChildPlan {
  std::vector<char*> argv{}, environment{};
  const char* folder = nullptr;
  rlim_t max_memory = RLIM_INFINITY;
  int null_file = -1, stdout_file = -1, stderr_file = -1, report_file = -1;
  pid_t parent = -1;
};

std::vector<char*> pointers(const std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size());
  for (const std::string& text : texts) result.push_back(const_cast<char*>(text.c_str()));
  return result;
}

// exec keeps ignored signals ignored and blocked signals blocked. The program expects neither.
void reset_signals() {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  for (int signal = 1; signal < SIGRTMIN; ++signal) ::sigaction(signal, &action, nullptr);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

// Connects the files to 0, 1 and 2. All are above 2, so no dup2 closes one that is still needed.
bool connect_standard_files(const ChildPlan& plan) {
  return ::dup2(plan.null_file, 0) >= 0 && ::dup2(plan.stdout_file, 1) >= 0 && ::dup2(plan.stderr_file, 2) >= 0;
}

[[noreturn]] void become_program(const ChildPlan& plan) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != plan.parent) ::_exit(kExecFailed);  // the parent died before prctl
  reset_signals();
  const rlimit memory{plan.max_memory, plan.max_memory};
  const bool is_ready = (plan.folder == nullptr || ::chdir(plan.folder) == 0) &&
                        (plan.max_memory == RLIM_INFINITY || ::setrlimit(RLIMIT_DATA, &memory) == 0) &&
                        connect_standard_files(plan);
  if (is_ready) {
    // Marks all other files to be closed by exec. Then only a failed exec can write the report.
    ::syscall(SYS_close_range, 3U, ~0U, 4U /* CLOSE_RANGE_CLOEXEC */);
    ::execve(plan.argv[0], plan.argv.data(), plan.environment.data());
  }
  const int why = errno;
  static_cast<void>(!::write(plan.report_file, &why, sizeof why));
  ::_exit(kExecFailed);
}

ChildPlan plan_of(const ChildRequest& request, const ChildFileSet& files) {
  ChildPlan plan{.argv = pointers(request.argv), .environment = pointers(request.environment)};
  plan.argv.push_back(nullptr);
  // getenv finds the first of two entries with one name, so the additions come first.
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) plan.environment.push_back(*entry);
  plan.environment.push_back(nullptr);
  if (!request.folder.empty()) plan.folder = request.folder.c_str();
  if (request.max_memory_bytes > 0) plan.max_memory = static_cast<rlim_t>(request.max_memory_bytes);
  plan.null_file = files.null_file;
  plan.stdout_file = request.reads_stdout ? files.output.write_end : files.null_file;
  plan.stderr_file = files.messages.write_end;
  plan.report_file = files.report.write_end;
  plan.parent = ::getpid();
  return plan;
}

milliseconds until(std::chrono::steady_clock::time_point time) {
  const auto left = std::chrono::ceil<milliseconds>(time - std::chrono::steady_clock::now());
  return std::max(left, milliseconds(0));
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Appends what a non-blocking file holds. Returns false at its end.
template <typename Append>
bool drain(int file, const Append& append) {
  std::array<char, 16384> buffer;
  while (true) {
    const ssize_t got = ::read(file, buffer.data(), buffer.size());
    if (got > 0)
      append(buffer.data(), static_cast<std::size_t>(got));
    else if (got < 0 && errno == EINTR)
      continue;
    else
      return got < 0 && errno == EAGAIN;
  }
}

}  // namespace

tl::expected<RunningProgram, std::string> RunningProgram::start(const ChildRequest& request) {
  const auto failed = [&](int why) {
    return tl::unexpected(fmt::format("{} ({})", request.argv.empty() ? "" : request.argv.front(), std::strerror(why)));
  };
  if (request.argv.empty()) return failed(EINVAL);
  ChildFileSet files;
  if (!files.open(request.reads_stdout)) return failed(errno);
  const ChildPlan plan = plan_of(request, files);
  RunningProgram program;
  program.start_ = Clock::now();
  program.process_ = ::fork();
  if (program.process_ == 0) become_program(plan);
  if (program.process_ < 0) return failed(errno);
  ::setpgid(program.process_, program.process_);  // by parent and child: whichever is first
  close_file(files.report.write_end);
  int why = 0;
  ssize_t got = 0;
  while ((got = ::read(files.report.read_end, &why, sizeof why)) < 0 && errno == EINTR) {
  }
  if (got == sizeof why) return failed(why);
  program.process_file_ = static_cast<int>(::syscall(SYS_pidfd_open, program.process_, 0U));
  if (program.process_file_ < 0) return failed(errno);
  program.stderr_file_ = std::exchange(files.messages.read_end, -1);
  program.stdout_file_ = std::exchange(files.output.read_end, -1);
  for (const int file : {program.stderr_file_, program.stdout_file_})
    if (file >= 0) ::fcntl(file, F_SETFL, O_NONBLOCK);
  program.patience_ = request.patience;
  if (request.max_time.count() > 0) program.stop_at_ = program.start_ + request.max_time;
  return program;
}

RunningProgram::RunningProgram(RunningProgram&& other) noexcept { *this = std::move(other); }

RunningProgram& RunningProgram::operator=(RunningProgram&& other) noexcept {
  if (this == &other) return *this;
  release();
  process_ = std::exchange(other.process_, -1);
  process_file_ = std::exchange(other.process_file_, -1);
  stderr_file_ = std::exchange(other.stderr_file_, -1);
  stdout_file_ = std::exchange(other.stdout_file_, -1);
  start_ = other.start_;
  stop_at_ = other.stop_at_;
  kill_at_ = other.kill_at_;
  patience_ = other.patience_;
  timed_out_ = other.timed_out_;
  end_ = other.end_;
  unfinished_line_ = std::move(other.unfinished_line_);
  lines_ = std::move(other.lines_);
  output_ = std::move(other.output_);
  return *this;
}

RunningProgram::~RunningProgram() { release(); }

void RunningProgram::release() {
  if (process_ > 0 && !end_) {
    ::kill(-process_, SIGKILL);
    ::kill(process_, SIGKILL);  // if the group does not exist yet
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  for (int* file : {&process_file_, &stderr_file_, &stdout_file_}) close_file(*file);
}

void RunningProgram::send_signal(int signal) const {
  if (process_ > 0 && !end_) ::kill(-process_, signal);
}

void RunningProgram::stop(milliseconds patience) {
  if (kill_at_ && *kill_at_ <= Clock::now() + patience) return;
  if (!kill_at_) send_signal(SIGTERM);
  kill_at_ = Clock::now() + patience;
  stop_at_.reset();
}

void RunningProgram::enforce_limits() {
  const auto now = Clock::now();
  if (stop_at_ && now >= *stop_at_) {
    timed_out_ = true;
    stop(patience_);
  }
  if (kill_at_ && now >= *kill_at_) {
    send_signal(SIGKILL);
    kill_at_ = now + milliseconds(100);  // a process in uninterruptible sleep needs time to die
  }
}

milliseconds RunningProgram::shortened(milliseconds timeout) const {
  for (const auto& limit : {stop_at_, kill_at_})
    if (limit) timeout = std::min(timeout, until(*limit));
  return timeout;
}

std::optional<ChildEnd> RunningProgram::wait(milliseconds timeout) {
  const auto deadline = Clock::now() + timeout;
  RunningProgram* const self[] = {this};
  while (!end_ && process_ > 0) {
    wait_for_any(self, until(deadline));
    collect_output();
    if (reap()) break;
    enforce_limits();
    if (Clock::now() >= deadline) return std::nullopt;
  }
  return end_;
}

bool RunningProgram::reap() {
  siginfo_t about{};
  if (::waitid(P_PID, static_cast<id_t>(process_), &about, WEXITED | WNOHANG | WNOWAIT) != 0 || about.si_pid == 0)
    return false;
  // No grandchild outlives the program. Until it is reaped, no other group can have its number.
  send_signal(SIGKILL);
  int status = 0;
  rusage usage{};
  while (::wait4(process_, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  collect_output();
  if (!unfinished_line_.empty()) add_messages("\n", 1);
  end_ = ChildEnd{.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                  .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
                  .timed_out = timed_out_,
                  .wall_s = std::chrono::duration<double>(Clock::now() - start_).count(),
                  .cpu_s = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
                  .max_resident_bytes = std::int64_t{1024} * usage.ru_maxrss};
  for (int* file : {&process_file_, &stderr_file_, &stdout_file_}) close_file(*file);
  return true;
}

void RunningProgram::collect_output() {
  if (stderr_file_ >= 0 && !drain(stderr_file_, [&](const char* bytes, std::size_t n) { add_messages(bytes, n); }))
    close_file(stderr_file_);
  if (stdout_file_ >= 0 && !drain(stdout_file_, [&](const char* bytes, std::size_t n) { output_.append(bytes, n); }))
    close_file(stdout_file_);
}

void RunningProgram::add_messages(const char* bytes, std::size_t count) {
  for (const char* next = bytes; next != bytes + count; ++next) {
    if (*next == '\n') {
      lines_.push_back(std::exchange(unfinished_line_, {}));
      if (lines_.size() > kMaxLines) lines_.pop_front();
    } else if (unfinished_line_.size() < kMaxLineBytes) {
      unfinished_line_ += *next;
    }
  }
}

std::vector<std::string> RunningProgram::take_stderr_lines() {
  collect_output();
  std::vector<std::string> result(std::make_move_iterator(lines_.begin()), std::make_move_iterator(lines_.end()));
  lines_.clear();
  return result;
}

std::string RunningProgram::take_stdout() {
  collect_output();
  return std::exchange(output_, {});
}

void wait_for_any(std::span<RunningProgram* const> programs, milliseconds timeout) {
  std::vector<pollfd> files;
  for (const RunningProgram* program : programs) {
    if (program->end_) return;
    timeout = program->shortened(timeout);
    for (const int file : {program->process_file_, program->stderr_file_, program->stdout_file_})
      if (file >= 0) files.push_back({file, POLLIN, 0});
  }
  ::poll(files.data(), files.size(),
         static_cast<int>(timeout.count()));  // a signal ends it early, as its caller expects
}

std::string own_program() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).string();
}

}  // namespace moiregauge::internal
