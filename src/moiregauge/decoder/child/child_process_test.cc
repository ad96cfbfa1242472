// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/decoder/child/child_process.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

using namespace std::chrono_literals;

// Starts a script in place of the decoder. It has the records `warning` and `end`, and sends them to the socket `s`.
tl::expected<ChildProcess, std::string> started(const TestFolder& folder, const std::string& lines) {
  const std::string program = folder / "decoder";
  {
    std::ofstream script(program);
    script << "#!/usr/bin/python3\nimport os, signal, socket, time\ns = socket.socket(fileno=5)\n"
           << fmt::format("warning, end = (int(k).to_bytes(4, 'little') + bytes({}) for k in ({}, {}))\n",
                          sizeof(wire::Record) - 4, static_cast<int>(wire::Kind::kWarning),
                          static_cast<int>(wire::Kind::kEnd))
           << lines;
  }
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const int input = ::open(program.c_str(), O_RDONLY | O_CLOEXEC);
  auto child = ChildProcess::start(program, input, 1000);
  ::close(input);
  return child;
}

// A service or a cluster that stops sends the signal to all processes. The parent decides what happens.
TEST(ChildProcess, ARequestToStopDoesNotEndTheDecoder) {
  const TestFolder folder;
  auto child = started(folder,
                       "for k in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):\n  os.kill(os.getpid(), k)\n"
                       "time.sleep(0.1)\ns.send(end)\n");
  ASSERT_TRUE(child) << child.error();
  const auto last = child->receive(5s);
  ASSERT_TRUE(last) << last.error();
  EXPECT_EQ(last->kind, wire::Kind::kEnd);
}

// A decoder that sends a warning, ignores the slots that the parent releases, sends its end and exits.
TEST(ChildProcess, RecordsBeforeItsExitAreReceivedDespiteUnreadReleases) {
  const TestFolder folder;
  auto child = started(folder, "s.send(warning)\ntime.sleep(0.2)\ns.send(end)\n");
  ASSERT_TRUE(child) << child.error();
  const auto first = child->receive(5s);
  ASSERT_TRUE(first) << first.error();
  EXPECT_EQ(first->kind, wire::Kind::kWarning);
  child->release(0);
  std::this_thread::sleep_for(600ms);  // now it has closed the socket
  const auto last = child->receive(5s);
  ASSERT_TRUE(last) << last.error();
  EXPECT_EQ(last->kind, wire::Kind::kEnd);
  EXPECT_FALSE(child->receive(5s)) << "and nothing after it";
}

}  // namespace
}  // namespace moiregauge::internal
