// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/live/publish/mqtt_sender.h"

#include <unistd.h>

#include <chrono>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <mosquitto.h>

#include "moiregauge/live/publish/block_text.h"

namespace moiregauge::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPort = 1883, kTlsPort = 8883;
constexpr int kKeepAlive_s = 15;
constexpr auto kAnswerTime = std::chrono::seconds(5);  // for a connection or the acknowledgements of one block (chosen)
constexpr int kQos = 1;

// Initialises the library once.
void start_library() {
  static const int started = mosquitto_lib_init();
  static_cast<void>(started);
}

struct Destroy {
  void operator()(mosquitto* client) const { mosquitto_destroy(client); }
};

class MqttSender final : public BlockSender {
 public:
  explicit MqttSender(MqttOptions options) : options_(std::move(options)) {
    start_library();
    topic_ = options_.url.path.substr(options_.url.path.empty() ? 0 : 1);
  }

  void start(const LiveRun& run) override {
    run_ = run;
    static_cast<void>(connect());
  }

  [[nodiscard]] SendResult send(const RowBlock& block) override {
    if (!is_connected_ && !connect()) return SendResult::kRetry;
    for (const AlarmEvent& event : block.alarms) publish("/alarm", alarm_json(event), false);
    if (!block.rows.empty()) {
      publish("/rows", rows_json(run_, block), false);
      publish("/health", health_json(block), false);
    }
    if (all_acknowledged()) return SendResult::kSent;
    disconnect();  // a new connection sends the whole block again
    return SendResult::kRetry;
  }

  void idle() override {
    if (is_connected_ && mosquitto_loop(client_.get(), 0, 1) != MOSQ_ERR_SUCCESS) disconnect();
  }

  void stop() override {
    if (!is_connected_) return;
    publish("/status", "offline", true);
    static_cast<void>(all_acknowledged());
    mosquitto_disconnect(client_.get());
    static_cast<void>(mosquitto_loop(client_.get(), 100, 1));
    disconnect();
    state_ = "closed";
  }

  [[nodiscard]] std::string state() const override { return state_; }

 private:
  static void on_connect(mosquitto* /*client*/, void* self, int code) {
    auto& sender = *static_cast<MqttSender*>(self);
    sender.is_connected_ = code == 0;
    sender.answer_ = code;
  }
  static void on_disconnect(mosquitto* /*client*/, void* self, int /*code*/) {
    static_cast<MqttSender*>(self)->is_connected_ = false;
  }
  static void on_publish(mosquitto* /*client*/, void* self, int message) {
    static_cast<MqttSender*>(self)->unacknowledged_.erase(message);
  }

  void disconnect() {
    client_.reset();
    is_connected_ = false;
    unacknowledged_.clear();
    state_ = "reconnecting";
  }

  [[nodiscard]] bool set_up() {
    client_.reset(mosquitto_new(nullptr, true, this));  // the library makes a unique client identifier
    if (client_ == nullptr) return false;
    mosquitto_connect_callback_set(client_.get(), on_connect);
    mosquitto_disconnect_callback_set(client_.get(), on_disconnect);
    mosquitto_publish_callback_set(client_.get(), on_publish);
    const std::string topic = topic_ + "/status";
    constexpr std::string_view kLost = "lost";
    mosquitto_will_set(client_.get(), topic.c_str(), static_cast<int>(kLost.size()), kLost.data(), kQos, true);
    if (!options_.url.user.empty())
      mosquitto_username_pw_set(client_.get(), options_.url.user.c_str(),
                                options_.password.empty() ? nullptr : options_.password.c_str());
    if (options_.url.scheme != "mqtts") return true;
    const bool has_file = !options_.ca_file.empty();
    mosquitto_tls_opts_set(client_.get(), 1, "tlsv1.2", nullptr);
    return mosquitto_tls_set(client_.get(), has_file ? options_.ca_file.c_str() : nullptr,
                             has_file ? nullptr : "/etc/ssl/certs", nullptr, nullptr, nullptr) == MOSQ_ERR_SUCCESS;
  }

  [[nodiscard]] bool connect() {
    disconnect();
    if (!set_up()) {
      state_ = "no TLS certificates";
      return false;
    }
    const int standard = options_.url.scheme == "mqtts" ? kTlsPort : kPort;
    const int port = options_.url.port > 0 ? options_.url.port : standard;
    answer_ = -1;
    if (mosquitto_connect(client_.get(), options_.url.host.c_str(), port, kKeepAlive_s) != MOSQ_ERR_SUCCESS)
      return false;
    const auto until = Clock::now() + kAnswerTime;
    while (answer_ < 0 && Clock::now() < until) {
      if (mosquitto_loop(client_.get(), 100, 1) != MOSQ_ERR_SUCCESS) break;
    }
    if (!is_connected_) {
      constexpr int kBadUser = 4, kNotAuthorised = 5;  // MQTT 3.1.1, 3.2.2.3
      const bool is_rejected = answer_ == kBadUser || answer_ == kNotAuthorised;
      state_ = is_rejected ? "rejected (user or password)" : "reconnecting";
      return false;
    }
    state_ = "connected";
    publish("/status", "online", true);
    return true;
  }

  void publish(const std::string& below, const std::string& text, bool retain) {
    const std::string topic = topic_ + below;
    int message = 0;
    if (mosquitto_publish(client_.get(), &message, topic.c_str(), static_cast<int>(text.size()), text.data(), kQos,
                          retain) == MOSQ_ERR_SUCCESS)
      unacknowledged_.insert(message);
    else
      is_connected_ = false;
  }

  [[nodiscard]] bool all_acknowledged() {
    const auto until = Clock::now() + kAnswerTime;
    while (is_connected_ && !unacknowledged_.empty() && Clock::now() < until) {
      if (mosquitto_loop(client_.get(), 100, 1) != MOSQ_ERR_SUCCESS) is_connected_ = false;
    }
    return is_connected_ && unacknowledged_.empty();
  }

  MqttOptions options_;
  std::string topic_;
  LiveRun run_;
  std::unique_ptr<mosquitto, Destroy> client_;
  bool is_connected_ = false;
  int answer_ = -1;  // broker's answer to the connection; -1: none yet
  std::set<int> unacknowledged_;
  std::string state_ = "connecting";
};

}  // namespace

std::unique_ptr<BlockSender> mqtt_sender(MqttOptions options) {
  return std::make_unique<MqttSender>(std::move(options));
}

}  // namespace moiregauge::internal
