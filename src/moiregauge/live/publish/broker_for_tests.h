// SPDX-License-Identifier: Apache-2.0
// A mosquitto broker on the loopback interface, and a subscriber.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mosquitto.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal::test {

// Returns a free port of the loopback interface.
inline int free_port() {
  const int file = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ::bind(file, reinterpret_cast<const sockaddr*>(&address), size);
  ::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(file);
  return ntohs(address.sin_port);
}

inline bool is_listening(int port) {
  const int file = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool connected = ::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(file);
  return connected;
}

class Broker {
 public:
  // `lines`: further lines of its configuration.
  Broker(int port, const std::string& lines) : port_(port) {
    put_text(folder_ / "mosquitto.conf",
             fmt::format("listener {} 127.0.0.1\nuser root\nlog_type none\n{}\n", port, lines));
    start();
  }
  explicit Broker(int port) : Broker(port, "allow_anonymous true") {}
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;
  ~Broker() { stop(); }

  void start() {
    std::string program = "mosquitto", option = "-c", file = folder_ / "mosquitto.conf";
    char* words[] = {program.data(), option.data(), file.data(), nullptr};
    ASSERT_EQ(::posix_spawn(&process_, "/usr/sbin/mosquitto", nullptr, nullptr, words, environ), 0);
    for (int i = 0; i < 500 && !is_listening(port_); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(is_listening(port_));
  }
  void stop() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(std::exchange(process_, -1), nullptr, 0);
  }

 private:
  int port_;
  TestFolder folder_;
  pid_t process_ = -1;
};

// Receives all messages below a topic, on a thread of libmosquitto.
class Subscriber {
 public:
  explicit Subscriber(int port) : client_(mosquitto_new(nullptr, true, this)) {
    mosquitto_message_callback_set(client_, [](mosquitto*, void* self, const mosquitto_message* message) {
      auto& subscriber = *static_cast<Subscriber*>(self);
      const std::lock_guard lock(subscriber.mutex_);
      subscriber.messages_.emplace_back(message->topic, std::string(static_cast<const char*>(message->payload),
                                                                    static_cast<std::size_t>(message->payloadlen)));
    });
    mosquitto_connect_callback_set(
        client_, [](mosquitto* client, void*, int) { mosquitto_subscribe(client, nullptr, "bridge/#", 1); });
    mosquitto_subscribe_callback_set(client_, [](mosquitto*, void* self, int, int, const int*) {
      static_cast<Subscriber*>(self)->is_subscribed_ = true;
    });
    mosquitto_reconnect_delay_set(client_, 1, 1, false);
    mosquitto_connect(client_, "127.0.0.1", port, 30);
    mosquitto_loop_start(client_);
    // Messages before the subscription would be lost.
    for (int i = 0; i < 1500 && !is_subscribed_; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;
  ~Subscriber() {
    mosquitto_disconnect(client_);
    mosquitto_loop_stop(client_, false);
    mosquitto_destroy(client_);
  }
  // Returns all messages of a topic so far.
  [[nodiscard]] std::vector<std::string> of(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> all;
    for (const auto& [at, text] : messages_) {
      if (at == topic) all.push_back(text);
    }
    return all;
  }
  // Waits until a topic has this many messages. Returns them.
  [[nodiscard]] std::vector<std::string> wait_for(const std::string& topic, std::size_t count) {
    for (int i = 0; i < 1500 && of(topic).size() < count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return of(topic);
  }

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::string>> messages_;
  std::atomic<bool> is_subscribed_ = false;
  mosquitto* client_;
};

}  // namespace moiregauge::internal::test
