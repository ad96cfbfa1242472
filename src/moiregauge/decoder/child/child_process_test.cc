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

// A decoder that sends a warning, ignores the slots that the parent releases, sends its end and exits.
TEST(ChildProcess, RecordsBeforeItsExitAreReceivedDespiteUnreadReleases) {
  const TestFolder folder;
  const std::string program = folder / "decoder";
  {
    std::ofstream script(program);
    script << "#!/usr/bin/python3\nimport socket, time\ns = socket.socket(fileno=5)\n"
           << fmt::format("warning, end = (int(k).to_bytes(4, 'little') + bytes({}) for k in ({}, {}))\n",
                          sizeof(wire::Record) - 4, static_cast<int>(wire::Kind::kWarning),
                          static_cast<int>(wire::Kind::kEnd))
           << "s.send(warning)\ntime.sleep(0.2)\ns.send(end)\n";
  }
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const int input = ::open(program.c_str(), O_RDONLY | O_CLOEXEC);
  auto child = ChildProcess::start(program, input, 1000);
  ::close(input);
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
