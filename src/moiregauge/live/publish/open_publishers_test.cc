// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/open_publishers.h"

#include <unistd.h>

#include <thread>

#include "moiregauge/base/folder_for_tests.h"
#include "moiregauge/live/publish/alarm_publisher.h"
#include "moiregauge/live/publish/broker_for_tests.h"
#include "moiregauge/live/publish/rows_for_tests.h"

namespace moiregauge::internal {
namespace {

std::string error_of(const PublishArgs& args) {
  const auto opened = open_publishers(args);
  return opened ? "" : opened.error();
}

// Sends a request to a port of the loopback interface. Returns the whole answer.
std::string request(int port, const std::string& text) {
  const int file = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  std::string answer;
  if (::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::send(file, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size())) {
    char bytes[4096];
    for (ssize_t got = ::recv(file, bytes, sizeof bytes, 0); got > 0; got = ::recv(file, bytes, sizeof bytes, 0))
      answer.append(bytes, static_cast<std::size_t>(got));
  }
  ::close(file);
  return answer;
}

void run_for(Publishers& opened, double seconds) {
  for (const auto& publisher : opened.all) publisher->start(test::two_targets());
  for (long frame = 0; static_cast<double>(frame) < 50.0 * seconds; ++frame) {
    for (const auto& publisher : opened.all) publisher->put(test::frame_with_rows(frame, 50.0));
  }
}

TEST(OpenPublishers, MistakesNameTheOptionAndTheRemedy) {
  PublishArgs args;
  args.publish = {"ftp://host/x"};
  EXPECT_EQ(error_of(args),
            "the outlet 'ftp' is unknown: --publish ftp://host/x: give mqtt://, mqtts://, influx:FILE, influx+http:// "
            "or influx+https://");
  args.publish = {"mqtt://host"};
  EXPECT_NE(error_of(args).find("the address has no topic"), std::string::npos);
  args.publish = {"mqtt://user:secret@host/x"};
  EXPECT_EQ(error_of(args).find("secret"), std::string::npos) << "a password must not appear in a message";
  args.publish = {"influx:"};
  EXPECT_NE(error_of(args), "");
  args = {};
  args.alarms = {"T1.dy > 2"};
  EXPECT_EQ(error_of(args),
            "the number has no known unit: --alarm 'T1.dy > 2', column 10: write mm, cm, m, um or in after it");
  args = {};
  for (const char* listen : {"0.0.0.0:9464", "example.org:9464", "127.0.0.1", "127.0.0.1:", "127.0.0.1:70000", ":x"}) {
    args.listen = listen;
    EXPECT_NE(error_of(args), "") << listen;
  }
  args = {};
  args.record_s = 10.0;
  EXPECT_NE(error_of(args).find("give an --alarm"), std::string::npos);
}

TEST(OpenPublishers, PrometheusReadsTheNewestValuesFromThisComputerOnly) {
  const int port = test::free_port();
  PublishArgs args;
  args.listen = std::to_string(port);
  args.alarms = {"T1.dy > 2 mm"};
  auto opened = open_publishers(args);
  ASSERT_TRUE(opened) << opened.error();
  run_for(*opened, 0.26);  // the last frame is at 0.24 s: 3 sin(2 pi 0.24) = 2.994 mm
  const std::string page = request(port, "GET /metrics HTTP/1.0\r\nHost: localhost:1\r\n\r\n");
  EXPECT_NE(page.find("200 OK"), std::string::npos) << page;
  EXPECT_NE(page.find("moiregauge_displacement_mm{marker=\"T1\",axis=\"y\"} 2.99"), std::string::npos) << page;
  EXPECT_NE(page.find("moiregauge_displacement_mm{marker=\"T2\",axis=\"y\"} NaN"), std::string::npos);
  EXPECT_NE(page.find("moiregauge_alarm{rule=\"T1.dy > 2 mm\"} 1"), std::string::npos);
  EXPECT_NE(request(port, "GET /metrics HTTP/1.0\r\nHost: attacker.example\r\n\r\n").find("403"), std::string::npos);
  EXPECT_NE(request(port, "GET /other HTTP/1.0\r\nHost: localhost\r\n\r\n").find("404"), std::string::npos);
  for (const auto& publisher : opened->all) publisher->finish(1.0);
  EXPECT_EQ(request(port, "GET /metrics HTTP/1.0\r\nHost: localhost\r\n\r\n"), "") << "the server has ended";
}

TEST(OpenPublishers, APortInUseIsRefused) {
  PublishArgs args;
  args.listen = std::to_string(test::free_port());
  const auto first = open_publishers(args);
  ASSERT_TRUE(first);
  EXPECT_NE(error_of(args).find("choose another port"), std::string::npos);
}

TEST(OpenPublishers, LineProtocolAndAlarmsAreWrittenToFiles) {
  const TestFolder folder;
  PublishArgs args;
  args.publish = {"influx:" + (folder / "rows.lp")};
  args.alarms = {"T1.dy > 2 mm until 1 mm", "T9.dy > 1 mm"};
  args.folder = folder.path();
  auto opened = open_publishers(args);
  ASSERT_TRUE(opened) << opened.error();
  run_for(*opened, 2.0);
  const auto state = opened->all[0]->state();
  EXPECT_EQ(state.second, "T1.dy > 2 mm until 1 mm, no target 'T9'")
      << "a vibration of 1 Hz never stays below 1 mm for 1 s";
  for (const auto& publisher : opened->all) publisher->finish(5.0);
  const std::string lines = text_of(folder / "rows.lp");
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2 * 100 + 1);
  // The first row above 2 mm is at asin(2 / 3) / (2 pi) = 0.116 s, which is frame 6 at 0.12 s.
  EXPECT_EQ(text_of(folder / "alarms.csv"),
            std::string(kAlarmLogHeader) + "1700000000120000000,6,0.120000,raised,T1.dy > 2 mm until 1 mm,2.053641\n");
}

TEST(OpenPublishers, AFullDiskLeavesWholeLinesAndCountsTheRest) {
  PublishArgs args;
  args.publish = {"influx:/dev/full"};
  auto opened = open_publishers(args);
  ASSERT_TRUE(opened);
  run_for(*opened, 3.0);
  opened->all[0]->finish(0.5);
  EXPECT_EQ(opened->all[0]->lost_rows(), 2 * 150);
  EXPECT_NE(opened->all[0]->state().second.find("No space left"), std::string::npos);
}

}  // namespace
}  // namespace moiregauge::internal
