// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/io/journal/journal_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal {
namespace {

class JournalFileTest : public testing::Test {
 protected:
  JournalFileTest() : file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0600)) {}
  ~JournalFileTest() override { ::close(file_); }
  TestFolder folder_;
  std::string path_ = folder_ / "journal";
  int file_;
};

TEST_F(JournalFileTest, HoldsRecordsInOrder) {
  JournalFile journal(file_, 0, 0);
  ASSERT_TRUE(journal.append("head "));
  journal.start();
  std::string wanted = "head ";
  for (int n = 0; n < 1000; ++n) {
    journal.add([n] { return std::to_string(n) + " "; }, true);
    wanted += std::to_string(n) + " ";
  }
  ASSERT_TRUE(journal.finish());
  EXPECT_EQ(journal.frames_safe(), 1000);
  ASSERT_TRUE(journal.append("end"));
  EXPECT_EQ(text_of(path_), wanted + "end");
}

TEST_F(JournalFileTest, IsWrittenDuringTheRun) {
  JournalFile journal(file_, 0, 0);
  journal.start();
  journal.add([] { return std::string("frame"); }, true);
  for (int k = 0; k < 500 && text_of(path_).empty(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(text_of(path_), "frame");  // without a call of finish()
}

TEST_F(JournalFileTest, HoldsAllRecordsWithoutFinish) {
  {
    JournalFile journal(file_, 0, 0);
    journal.start();
    journal.add([] { return std::string("frame"); }, true);
  }
  EXPECT_EQ(text_of(path_), "frame");
}

// A file size limit acts like a full disk: the partial record is cut off, and earlier records stay.
TEST_F(JournalFileTest, OnAFullDiskCompleteRecordsStay) {
  std::signal(SIGXFSZ, SIG_IGN);
  ::rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const ::rlimit small{25, before.rlim_max};
  {
    JournalFile journal(file_, 0, 0);
    ASSERT_TRUE(journal.append("12345"));
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    journal.start();
    for (int n = 0; n < 5; ++n) journal.add([] { return std::string("1234567"); }, true);
    const auto done = journal.finish();
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error(), "File too large");
    EXPECT_FALSE(journal.good());
    EXPECT_EQ(journal.frames_safe(), 2);
    EXPECT_FALSE(journal.append("end"));
  }
  EXPECT_EQ(text_of(path_), "1234512345671234567");
}

}  // namespace
}  // namespace moiregauge::internal
