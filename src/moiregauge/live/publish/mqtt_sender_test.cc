// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/mqtt_sender.h"

#include <cstdlib>
#include <set>

#include "moiregauge/live/publish/broker_for_tests.h"
#include "moiregauge/live/publish/rows_for_tests.h"

namespace moiregauge::internal {
namespace {

MqttOptions options(int port, const std::string& scheme = "mqtt", const std::string& user = "") {
  return {
      *parse_outlet_url(fmt::format("{}://{}127.0.0.1:{}/bridge/span2", scheme, user.empty() ? "" : user + "@", port)),
      "", ""};
}

std::unique_ptr<BlockOutlet> started(MqttOptions mqtt) {
  auto outlet = block_outlet("mqtt", mqtt_sender(std::move(mqtt)));
  outlet->start(test::two_targets());
  return outlet;
}

bool waits_for_state(const BlockOutlet& outlet, const std::string& state) {
  for (int i = 0; i < 1500 && outlet.state().second != state; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return outlet.state().second == state;
}

// Returns the numbers of all frames in the messages.
std::set<long> frames_in(const std::vector<std::string>& messages) {
  std::set<long> frames;
  for (const std::string& text : messages) {
    std::size_t at = text.find("\"frame\":[") + 9;
    while (text[at - 1] != ']') {
      std::size_t used = 0;
      frames.insert(std::stol(text.substr(at), &used));
      at += used + 1;
    }
  }
  return frames;
}

TEST(MqttSender, RowsHealthAlarmsAndStatusArrive) {
  const int port = test::free_port();
  const test::Broker broker(port);
  test::Subscriber subscriber(port);
  const auto outlet = started(options(port));
  for (long frame = 0; frame < 120; ++frame) outlet->put(test::frame_with_rows(frame, 50.0));
  AlarmEvent event;
  event.rule = "T1.dy > 2 mm";
  event.is_raised = true;
  outlet->alarm(event);
  outlet->finish(10.0);
  EXPECT_EQ(outlet->lost_rows(), 0);
  EXPECT_EQ(subscriber.wait_for("bridge/span2/status", 2), (std::vector<std::string>{"online", "offline"}));
  EXPECT_EQ(frames_in(subscriber.of("bridge/span2/rows")).size(), 120U);
  EXPECT_FALSE(subscriber.of("bridge/span2/health").empty());
  const auto alarms = subscriber.of("bridge/span2/alarm");
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_NE(alarms[0].find("\"state\":\"raised\""), std::string::npos) << alarms[0];
}

TEST(MqttSender, AnAbsentBrokerGetsAllRowsWhenItReturns) {
  const int port = test::free_port();
  test::Broker broker(port);
  const auto outlet = started(options(port));
  ASSERT_TRUE(waits_for_state(*outlet, "connected"));
  broker.stop();
  ASSERT_TRUE(waits_for_state(*outlet, "reconnecting"));
  for (long frame = 0; frame < 50 * 60; ++frame) outlet->put(test::frame_with_rows(frame, 50.0));  // a minute
  broker.start();
  test::Subscriber subscriber(port);
  outlet->finish(20.0);
  static_cast<void>(subscriber.wait_for("bridge/span2/status", 2));
  EXPECT_EQ(frames_in(subscriber.of("bridge/span2/rows")).size(), 3000U);
  EXPECT_EQ(outlet->lost_rows(), 0);
}

TEST(MqttSender, TheBrokerReportsAProgramThatEndsWithoutAGoodbye) {
  const int port = test::free_port();
  const test::Broker broker(port);
  test::Subscriber subscriber(port);
  {
    const auto sender = mqtt_sender(options(port));
    sender->start(test::two_targets());
    ASSERT_EQ(sender->state(), "connected");
    RowBlock block;
    block.rows.emplace_back();
    ASSERT_EQ(sender->send(block), SendResult::kSent);
  }  // destroyed without stop(): the connection breaks
  const auto status = subscriber.wait_for("bridge/span2/status", 2);
  ASSERT_EQ(status.size(), 2U);
  EXPECT_EQ(status[1], "lost");
}

TEST(MqttSender, AWrongPasswordIsReportedAndTheRightOneAccepted) {
  const TestFolder folder;
  const std::string file = folder / "passwords";
  ASSERT_EQ(std::system(("mosquitto_passwd -c -b " + file + " gauge right").c_str()), 0);
  const int port = test::free_port();
  const test::Broker broker(port, "allow_anonymous false\npassword_file " + file);
  MqttOptions wrong = options(port, "mqtt", "gauge");
  wrong.password = "wrong";
  const auto refused = mqtt_sender(wrong);
  refused->start(test::two_targets());
  EXPECT_EQ(refused->state(), "rejected (user or password)");
  wrong.password = "right";
  const auto accepted = mqtt_sender(wrong);
  accepted->start(test::two_targets());
  EXPECT_EQ(accepted->state(), "connected");
}

TEST(MqttSender, TlsProvesTheBroker) {
  const TestFolder folder;
  const std::string make = fmt::format(
      "cd {} && openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout key.pem -out "
      "cert.pem -days 2 "
      "-subj /CN=broker -addext subjectAltName=IP:127.0.0.1 2>/dev/null && cp cert.pem other.pem",
      folder.path());
  ASSERT_EQ(std::system(make.c_str()), 0);
  const int port = test::free_port();
  const test::Broker broker(
      port, fmt::format("allow_anonymous true\ncafile {0}/cert.pem\ncertfile {0}/cert.pem\nkeyfile {0}/key.pem",
                        folder.path()));
  MqttOptions secure = options(port, "mqtts");
  secure.ca_file = folder / "cert.pem";
  const auto trusted = mqtt_sender(secure);
  trusted->start(test::two_targets());
  EXPECT_EQ(trusted->state(), "connected");
  secure.ca_file = "";
  const auto unknown = mqtt_sender(secure);
  unknown->start(test::two_targets());
  EXPECT_NE(unknown->state(), "connected") << "the system's certificates do not contain this one";
}

}  // namespace
}  // namespace moiregauge::internal
