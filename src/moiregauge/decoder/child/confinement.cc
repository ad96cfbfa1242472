// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/child/confinement.h"

#include <fcntl.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>

#include "moiregauge/decoder/child/wire.h"

#ifndef __has_feature
#define __has_feature(x) 0  // clang's test for sanitizers
#endif

namespace moiregauge::internal {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || __has_feature(address_sanitizer) || \
    __has_feature(thread_sanitizer)
constexpr bool kSanitized = true;  // their shadow memory is terabytes of address space
#else
constexpr bool kSanitized = false;
#endif

void limit(__rlimit_resource what, std::uint64_t most) {
  const rlimit bounds{most, most};
  ::setrlimit(what, &bounds);
}

class Filter {
 public:
  Filter() : rules_(seccomp_init(SCMP_ACT_ERRNO(EPERM)), &seccomp_release) {}

  template <typename... Conditions>
  void allow(int call, Conditions... conditions) {
    add(SCMP_ACT_ALLOW, call, conditions...);
  }
  template <typename... Conditions>
  void add(std::uint32_t action, int call, Conditions... conditions) {
    if (problem_ == 0) problem_ = seccomp_rule_add(rules_.get(), action, call, sizeof...(conditions), conditions...);
  }
  // Returns 0, or a negative error number.
  [[nodiscard]] int load() {
    if (rules_ == nullptr) return -ENOMEM;
    if (problem_ == 0) problem_ = seccomp_attr_set(rules_.get(), SCMP_FLTATR_CTL_TSYNC, 1);  // for all threads
    return problem_ == 0 ? seccomp_load(rules_.get()) : problem_;
  }

 private:
  std::unique_ptr<void, decltype(&seccomp_release)> rules_;
  int problem_ = 0;
};

scmp_arg_cmp argument(unsigned index, std::uint64_t value) { return {index, SCMP_CMP_EQ, value, 0}; }
scmp_arg_cmp bits(unsigned index, std::uint64_t mask, std::uint64_t value) {
  return {index, SCMP_CMP_MASKED_EQ, mask, value};
}

// Allows access to the child's three descriptors.
void allow_its_files(Filter& filter) {
  filter.allow(SCMP_SYS(pread64), argument(0, wire::kInputFile));
  filter.allow(SCMP_SYS(lseek), argument(0, wire::kInputFile));
  filter.allow(SCMP_SYS(ftruncate), argument(0, wire::kMemoryFile));
  filter.allow(SCMP_SYS(fcntl), argument(0, wire::kMemoryFile), argument(1, F_ADD_SEALS));
  filter.allow(SCMP_SYS(sendto), argument(0, wire::kSocket));
  filter.allow(SCMP_SYS(recvfrom), argument(0, wire::kSocket));
}

// Allows communication over descriptors that were opened before the filter. No further one can be opened.
void allow_connection(Filter& filter) {
  const scmp_arg_cmp own{0, SCMP_CMP_GE, wire::kFirstUnusedFile, 0};
  for (const int call : {SCMP_SYS(read), SCMP_SYS(write), SCMP_SYS(recvfrom), SCMP_SYS(sendto), SCMP_SYS(recvmsg),
                         SCMP_SYS(sendmsg), SCMP_SYS(getsockopt), SCMP_SYS(shutdown), SCMP_SYS(close), SCMP_SYS(ioctl)})
    filter.allow(call, own);
  for (const int call : {SCMP_SYS(poll), SCMP_SYS(ppoll), SCMP_SYS(select), SCMP_SYS(pselect6)}) filter.allow(call);
}

// Sanitizers print reports and use a pipe to test whether an address is readable.
void allow_sanitizers(Filter& filter) {
  filter.allow(SCMP_SYS(write), scmp_arg_cmp{0, SCMP_CMP_NE, STDOUT_FILENO, 0});
  for (const int call : {SCMP_SYS(pipe), SCMP_SYS(pipe2), SCMP_SYS(read), SCMP_SYS(close), SCMP_SYS(readlink)})
    filter.allow(call);
}

// Allows memory that is never executable.
void allow_memory(Filter& filter) {
  filter.allow(SCMP_SYS(mmap), bits(2, PROT_EXEC, 0));
  filter.allow(SCMP_SYS(mprotect), bits(2, PROT_EXEC, 0));
  for (const int call : {SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(brk)}) filter.allow(call);
}

// Allows the decoder's threads and the calls that the C library makes for them.
void allow_threads(Filter& filter) {
  constexpr std::uint64_t kThread = 0x00010000;  // CLONE_THREAD
  filter.allow(SCMP_SYS(clone), bits(0, kThread, kThread));
  filter.add(SCMP_ACT_KILL_PROCESS, SCMP_SYS(clone), bits(0, kThread, 0));
  filter.add(SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3));  // its flags are not visible here; glibc then uses clone
  filter.allow(SCMP_SYS(prctl), argument(0, PR_SET_NAME));
  filter.allow(SCMP_SYS(tgkill), argument(0, static_cast<std::uint64_t>(::getpid())));  // for abort()
  for (const int call :
       {SCMP_SYS(futex), SCMP_SYS(set_robust_list), SCMP_SYS(rseq), SCMP_SYS(sigaltstack), SCMP_SYS(rt_sigaction),
        SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn), SCMP_SYS(restart_syscall), SCMP_SYS(sched_yield),
        SCMP_SYS(sched_getaffinity), SCMP_SYS(gettid), SCMP_SYS(getpid), SCMP_SYS(exit), SCMP_SYS(exit_group)}) {
    filter.allow(call);
  }
}

void allow_clocks_and_chance(Filter& filter) {
  for (const int call : {SCMP_SYS(clock_gettime), SCMP_SYS(clock_getres), SCMP_SYS(gettimeofday), SCMP_SYS(nanosleep),
                         SCMP_SYS(clock_nanosleep), SCMP_SYS(getrandom)}) {
    filter.allow(call);
  }
}

void forbid_what_only_intruders_do(Filter& filter) {
  for (const int call : {SCMP_SYS(execve), SCMP_SYS(execveat), SCMP_SYS(fork), SCMP_SYS(vfork), SCMP_SYS(socket),
                         SCMP_SYS(connect), SCMP_SYS(kill), SCMP_SYS(ptrace), SCMP_SYS(process_vm_writev)}) {
    filter.add(SCMP_ACT_KILL_PROCESS, call);
  }
}

}  // namespace

void limit_resources(std::int64_t max_pixels) {
  constexpr std::uint64_t kGibibyte = std::uint64_t{1} << 30;
  const auto pixels = static_cast<std::uint64_t>(max_pixels);
  constexpr int kPipe = kSanitized ? 2 : 0;  // descriptors: see allow_sanitizers
  limit(RLIMIT_NOFILE, wire::kFirstUnusedFile + kPipe);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, wire::memory_limit(max_pixels));  // the shared memory is a file to the kernel
  // H.264 keeps up to 17 images of 1.5 bytes per pixel, and some tables. The limit is about twice as much.
  if (!kSanitized) limit(RLIMIT_DATA, kGibibyte + 48 * pixels);
}

std::optional<std::string> filter_system_calls(InputAccess access) {
  Filter filter;
  if (access == InputAccess::kConnection) allow_connection(filter);
  allow_its_files(filter);
  allow_memory(filter);
  allow_threads(filter);
  allow_clocks_and_chance(filter);
  forbid_what_only_intruders_do(filter);
  if (kSanitized) allow_sanitizers(filter);
  const int problem = filter.load();
  if (problem == 0) return std::nullopt;
  return std::strerror(-problem);
}

}  // namespace moiregauge::internal
