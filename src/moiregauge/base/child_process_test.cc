// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/base/child_process.h"

#include <errno.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

using namespace std::chrono_literals;

constexpr auto kLong = 60s;  // no test waits this long unless the code is wrong

ChildRequest shell(const std::string& script) { return {.argv = {"/bin/sh", "-c", script}}; }

RunningProgram started(const ChildRequest& request) {
  auto program = RunningProgram::start(request);
  if (!program) {
    ADD_FAILURE() << program.error();
    std::abort();
  }
  return *std::move(program);
}

ChildEnd end_of(RunningProgram& program) {
  const auto end = program.wait(kLong);
  EXPECT_TRUE(end) << "it must have ended";
  return end.value_or(ChildEnd{});
}

bool exists(pid_t process) { return ::kill(process, 0) == 0; }

// A killed orphan exists until the system's first process has reaped it.
bool ends_soon(pid_t process) {
  for (int i = 0; i < 300 && exists(process); ++i) {
    if (text_of("/proc/" + std::to_string(process) + "/stat").find(") Z ") != std::string::npos) return true;
    std::this_thread::sleep_for(10ms);
  }
  return !exists(process);
}

TEST(ChildProcess, ExitCodesAndSignalsAreKeptApart) {
  auto three = started(shell("exit 3"));
  EXPECT_EQ(end_of(three).exit_code, 3);
  EXPECT_EQ(end_of(three).signal, 0);
  auto killed = started(shell("kill -SEGV $$"));
  EXPECT_EQ(end_of(killed).exit_code, -1);
  EXPECT_EQ(end_of(killed).signal, SIGSEGV);
}

TEST(ChildProcess, NoShellReadsTheArguments) {
  ChildRequest request{.argv = {"/usr/bin/printf", "%s|", "$HOME; exit 1", "a b", "'\"`x`", ""}, .reads_stdout = true};
  auto program = started(request);
  EXPECT_EQ(end_of(program).exit_code, 0);
  EXPECT_EQ(program.take_stdout(), "$HOME; exit 1|a b|'\"`x`||");
}

TEST(ChildProcess, MessagesArriveAsLinesWhileItRuns) {
  auto program = started(shell("echo first >&2; sleep 60"));
  std::vector<std::string> lines;
  for (int i = 0; i < 3000 && lines.empty(); ++i) {
    EXPECT_FALSE(program.wait(10ms));
    lines = program.take_stderr_lines();
  }
  EXPECT_EQ(lines, std::vector<std::string>{"first"});
}

TEST(ChildProcess, AFloodOfMessagesNeitherBlocksItNorFillsTheMemory) {
  // 4 MB of lines: far over the 64 kB of a pipe. Then a line without end.
  auto program = started(shell("yes 0123456 | head -n 500000 >&2; head -c 100000 /dev/zero | tr '\\0' x >&2"));
  EXPECT_EQ(end_of(program).exit_code, 0);
  const auto lines = program.take_stderr_lines();
  ASSERT_EQ(lines.size(), 1000U);
  EXPECT_EQ(lines.front(), "0123456");
  EXPECT_EQ(lines.back(), std::string(4096, 'x'));
}

TEST(ChildProcess, AProgramThatDoesNotExistIsAReason) {
  const auto program = RunningProgram::start({.argv = {"/nowhere/program"}});
  ASSERT_FALSE(program);
  EXPECT_EQ(program.error(), "/nowhere/program (No such file or directory)");
  ChildRequest request = shell("true");
  request.folder = "/nowhere";
  EXPECT_FALSE(RunningProgram::start(request));
  EXPECT_FALSE(RunningProgram::start({}));
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
}

TEST(ChildProcess, ItRunsInItsFolderWithItsEnvironment) {
  const TestFolder folder;
  ChildRequest request = shell("pwd -P; echo $MOIREGAUGE_TEST; ls /proc/self/fd | wc -l");
  request.folder = folder.path();
  request.environment = {"MOIREGAUGE_TEST=seven"};
  request.reads_stdout = true;
  auto program = started(request);
  EXPECT_EQ(end_of(program).exit_code, 0);
  // ls has its three standard files and the folder that it lists.
  EXPECT_EQ(program.take_stdout(), std::filesystem::canonical(folder.path()).string() + "\nseven\n4\n");
}

TEST(ChildProcess, ATimeLimitEndsTheWholeGroup) {
  ChildRequest request = shell("trap '' TERM; sleep 61 & echo $! >&2; wait; sleep 61");
  request.max_time = 200ms;
  request.patience = 200ms;
  auto program = started(request);
  const ChildEnd end = end_of(program);
  EXPECT_TRUE(end.timed_out);
  EXPECT_EQ(end.signal, SIGKILL) << "it ignores SIGTERM";
  EXPECT_GE(end.wall_s, 0.4);
  const auto lines = program.take_stderr_lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(ends_soon(std::stoi(lines[0]))) << "its child ignores SIGTERM too";
}

TEST(ChildProcess, AProgramThatObeysATimeLimitEndsByItself) {
  ChildRequest request = shell("trap 'exit 9' TERM; while :; do sleep 0.05; done");
  request.max_time = 200ms;
  auto program = started(request);
  const ChildEnd end = end_of(program);
  EXPECT_TRUE(end.timed_out);
  EXPECT_EQ(end.exit_code, 9);
}

TEST(ChildProcess, AnInterruptReachesTheGroup) {
  auto program = started(shell("trap 'exit 7' INT; echo ready >&2; while :; do sleep 0.05; done"));
  while (program.take_stderr_lines().empty()) EXPECT_FALSE(program.wait(10ms));
  program.send_signal(SIGINT);
  EXPECT_EQ(end_of(program).exit_code, 7);
  EXPECT_FALSE(end_of(program).timed_out);
}

#ifndef __SANITIZE_ADDRESS__  // the limit would hold for the sanitizer's shadow memory
TEST(ChildProcess, MemoryAboveTheLimitIsRefused) {
  // dd allocates its block as a whole.
  ChildRequest request{.argv = {"/bin/dd", "if=/dev/zero", "of=/dev/null", "bs=200M", "count=1"}};
  auto unlimited = started(request);
  EXPECT_EQ(end_of(unlimited).exit_code, 0);
  EXPECT_GE(end_of(unlimited).max_resident_bytes, 200'000'000);
  request.max_memory_bytes = 100'000'000;
  auto limited = started(request);
  EXPECT_EQ(end_of(limited).exit_code, 1);
}
#endif

TEST(ChildProcess, NothingOutlivesTheProgram) {
  auto program = started(shell("sleep 61 >/dev/null 2>&1 & echo $! >&2"));
  EXPECT_EQ(end_of(program).exit_code, 0);
  EXPECT_TRUE(ends_soon(std::stoi(program.take_stderr_lines().at(0))));
}

TEST(ChildProcess, ItDiesWithItsParent) {
  const TestFolder folder;
  const std::string file = folder / "id";
  const pid_t parent = ::fork();
  if (parent == 0) {
    const auto program = RunningProgram::start({.argv = {"/bin/sleep", "61"}});
    put_text(file, std::to_string(program ? program->id() : 0));
    ::kill(::getpid(), SIGKILL);  // runs no destructor
  }
  ::waitpid(parent, nullptr, 0);
  const pid_t child = std::stoi(text_of(file));
  ASSERT_GT(child, 0);
  EXPECT_TRUE(ends_soon(child));
}

TEST(ChildProcess, ADestroyedProgramIsDead) {
  pid_t id = 0;
  {
    auto program = started(shell("sleep 61"));
    id = program.id();
    EXPECT_TRUE(exists(id));
  }
  EXPECT_FALSE(exists(id));
}

TEST(ChildProcess, TheFirstOfSeveralToEndIsNoticed) {
  auto slow = started(shell("sleep 61"));
  auto quick = started(shell("exit 4"));
  RunningProgram* const both[] = {&slow, &quick};
  std::optional<ChildEnd> end;
  for (int i = 0; i < 100 && !end; ++i) {
    wait_for_any(both, kLong);
    end = quick.wait(0ms);
  }
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 4);
  EXPECT_FALSE(slow.wait(0ms));
}

TEST(ChildProcess, OwnProgramIsThisTest) {
  EXPECT_EQ(std::filesystem::path(own_program()).filename(), program_invocation_short_name);
}

}  // namespace
}  // namespace moiregauge::internal
