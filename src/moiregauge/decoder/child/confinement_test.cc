// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/child/confinement.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

namespace moiregauge::internal {
namespace {

constexpr int kDone = 42;
constexpr int kRefused = 43;

// Runs a function in a child process with the filter. Returns its exit code, or minus the signal that ended it.
int fate_of(const std::function<bool()>& deed, bool filtered = true) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (filtered && filter_system_calls()) ::_exit(1);
    ::_exit(deed() ? kDone : kRefused);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

bool opens_a_file() { return ::open("/dev/null", O_RDONLY) >= 0; }
bool opens_a_socket() { return ::socket(AF_INET, SOCK_STREAM, 0) >= 0; }
bool executes() {
  char name[] = "/bin/true";
  char* words[] = {name, nullptr};
  return ::execv(name, words) == 0;
}
bool forks() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  return child > 0;
}
bool signals_its_parent() { return ::kill(::getppid(), 0) == 0; }
bool writes_to_the_terminal() { return ::write(STDOUT_FILENO, "", 0) == 0; }
bool makes_code() {
  return ::mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED;
}
bool turns_data_into_code() {
  void* page = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return ::mprotect(page, 4096, PROT_READ | PROT_EXEC) == 0;
}
bool has_memory_and_threads() {
  std::string text(1 << 24, 'x');
  std::thread([&] { text[0] = 'y'; }).join();
  return text[0] == 'y';
}

// Each action succeeds without the filter, so the filter is what stops it.
TEST(Confinement, TheKernelStopsActionsThatNoDecoderNeeds) {
  for (const auto deed : {opens_a_file, writes_to_the_terminal, makes_code, turns_data_into_code}) {
    EXPECT_EQ(fate_of(deed, false), kDone);
    EXPECT_EQ(fate_of(deed), kRefused);
  }
  for (const auto deed : {opens_a_socket, forks, signals_its_parent}) {
    EXPECT_EQ(fate_of(deed, false), kDone);
    EXPECT_EQ(fate_of(deed), -SIGSYS);
  }
  EXPECT_EQ(fate_of(executes, false), 0) << "it became another program";
  EXPECT_EQ(fate_of(executes), -SIGSYS);
}

// A live child has its connection before the filter. Then it can neither open another one nor a file.
TEST(Confinement, AConnectionOpenedBeforeIsTheOnlyOne) {
  const auto with_connection = [](const std::function<bool(int)>& deed) {
    return fate_of(
        [&] {
          int ends[2] = {-1, -1};
          if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) return false;
          const int mine = ::fcntl(ends[0], F_DUPFD, 16), peer = ::fcntl(ends[1], F_DUPFD, 16);
          if (::send(peer, "x", 1, 0) != 1 || filter_system_calls(InputAccess::kConnection)) return false;
          return deed(mine);
        },
        false);
  };
  char letter = 0;
  EXPECT_EQ(with_connection([&](int mine) { return ::recv(mine, &letter, 1, 0) == 1; }), kDone);
  EXPECT_EQ(with_connection([](int mine) { return ::send(mine, "y", 1, MSG_NOSIGNAL) == 1; }), kDone);
  EXPECT_EQ(with_connection([](int) { return opens_a_file(); }), kRefused);
  EXPECT_EQ(with_connection([](int) { return writes_to_the_terminal(); }), kRefused);
  EXPECT_EQ(with_connection([](int) { return opens_a_socket(); }), -SIGSYS);
  EXPECT_EQ(with_connection([](int) { return forks(); }), -SIGSYS);
}

TEST(Confinement, MemoryAndThreadsAreAllowed) { EXPECT_EQ(fate_of(has_memory_and_threads), kDone); }

TEST(Confinement, AbortStillWorks) {
  EXPECT_EQ(fate_of([]() -> bool { std::abort(); }), -SIGABRT);
}

TEST(Confinement, NoFurtherFileCanBeOpenedEvenWithoutTheFilter) {
  EXPECT_EQ(fate_of(
                [] {
                  limit_resources(1'000'000);
                  for (int file = ::open("/dev/null", O_RDONLY); file >= 0; file = ::open("/dev/null", O_RDONLY)) {
                  }
                  return errno == EMFILE;
                },
                false),
            kDone);
}

}  // namespace
}  // namespace moiregauge::internal
