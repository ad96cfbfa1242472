// SPDX-License-Identifier: Apache-2.0
// Servers on the loopback interface: HTTP by ffmpeg, and RTSP with interleaved RTP (RFC 2326, RFC 6184).
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "moiregauge/base/folder_for_tests.h"

namespace moiregauge::internal::test {

// Returns a listening socket of the loopback interface. Port 0 chooses a free one.
inline int listening_socket(int& port) {
  const int file = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(file, reinterpret_cast<const sockaddr*>(&address), size), 0);
  EXPECT_EQ(::listen(file, 4), 0);
  ::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
  port = ntohs(address.sin_port);
  return file;
}

inline int free_stream_port() {
  int port = 0;
  ::close(listening_socket(port));
  return port;
}

// Serves a moving test image to one client, at 25 frames/s.
class HttpCamera {
 public:
  // `format`: "mpegts" with H.264, or "mpjpeg".
  HttpCamera(int port, const std::string& format) {
    const std::string codec = format == "mpjpeg" ? "mjpeg" : "libx264 -tune zerolatency -g 10 -bf 0";
    std::string command = fmt::format(
        "exec ffmpeg -nostdin -v quiet -re -f lavfi -i testsrc2=size=320x240:rate=25 -pix_fmt yuvj420p -c:v {} -f {} "
        "-listen 1 http://127.0.0.1:{}",
        codec, format, port);
    std::string shell = "sh", option = "-c";
    char* words[] = {shell.data(), option.data(), command.data(), nullptr};
    EXPECT_EQ(::posix_spawn(&process_, "/bin/sh", nullptr, nullptr, words, environ), 0);
  }
  HttpCamera(const HttpCamera&) = delete;
  HttpCamera& operator=(const HttpCamera&) = delete;
  ~HttpCamera() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

 private:
  pid_t process_ = -1;
};

// Serves an H.264 video over RTSP, with RTP inside the connection.
class RtspCamera {
 public:
  explicit RtspCamera(int port) : port_(port), listener_(listening_socket(port_)), thread_([this] { serve(); }) {}
  RtspCamera(const RtspCamera&) = delete;
  RtspCamera& operator=(const RtspCamera&) = delete;
  ~RtspCamera() {
    is_stopping_ = true;
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  [[nodiscard]] int port() const { return port_; }

 private:
  using Unit = std::string;  // NAL unit

  void serve() {
    while (!is_stopping_) {
      const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (client < 0) return;
      if (answer_requests(client)) send_video(client);
      ::close(client);
    }
  }

  // Answers up to and including PLAY. Returns false if the client has left.
  [[nodiscard]] bool answer_requests(int client) {
    std::string text;
    while (true) {
      const std::size_t end = text.find("\r\n\r\n");
      if (end == std::string::npos) {
        char bytes[2048];
        const ssize_t got = ::recv(client, bytes, sizeof bytes, 0);
        if (got <= 0) return false;
        text.append(bytes, static_cast<std::size_t>(got));
        continue;
      }
      const std::string request = text.substr(0, end);
      text.erase(0, end + 4);
      const std::size_t at = request.find("CSeq:");
      const std::string sequence = request.substr(at + 5, request.find("\r\n", at) - at - 5);
      std::string more;
      if (request.starts_with("DESCRIBE")) {
        const std::string sdp =
            "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=test\r\nc=IN IP4 127.0.0.1\r\nt=0 0\r\nm=video 0 RTP/AVP 96\r\n"
            "a=rtpmap:96 H264/90000\r\na=fmtp:96 packetization-mode=1\r\na=control:track0\r\n";
        more = fmt::format("Content-Type: application/sdp\r\nContent-Length: {}\r\n\r\n{}", sdp.size(), sdp);
      } else if (request.starts_with("SETUP")) {
        if (request.find("interleaved") == std::string::npos) ADD_FAILURE() << "RTP must be inside the connection";
        more = "Transport: RTP/AVP/TCP;unicast;interleaved=0-1\r\nSession: 1\r\n\r\n";
      } else {
        more = "Session: 1\r\n\r\n";
      }
      const std::string answer = fmt::format("RTSP/1.0 200 OK\r\nCSeq:{}\r\n{}", sequence, more);
      if (::send(client, answer.data(), answer.size(), MSG_NOSIGNAL) < 0) return false;
      if (request.starts_with("PLAY")) return true;
    }
  }

  static std::vector<Unit> units() {
    const TestFolder folder;
    const std::string file = folder / "video.h264";
    const std::string command =
        "ffmpeg -nostdin -v error -f lavfi -i testsrc2=size=320x240:rate=25:duration=2 -pix_fmt yuv420p -c:v libx264 "
        "-g 10 -bf 0 "
        "-x264-params repeat-headers=1:slices=1 -f h264 " +
        file;
    EXPECT_EQ(std::system(command.c_str()), 0);
    const std::string bytes = text_of(file);
    const std::string mark("\0\0\1", 3);
    std::vector<Unit> all;
    for (std::size_t at = bytes.find(mark); at != std::string::npos;) {
      const std::size_t next = bytes.find(mark, at + 3);
      Unit unit = bytes.substr(at + 3, next == std::string::npos ? next : next - at - 3);
      while (!unit.empty() && unit.back() == '\0') unit.pop_back();  // the next start code may have four bytes
      all.push_back(std::move(unit));
      at = next;
    }
    return all;
  }

  void send_video(int client) {
    std::uint16_t sequence = 0;
    std::uint32_t time = 0;  // 1/90000 s
    while (!is_stopping_) {
      for (const Unit& unit : units_) {
        const int kind = unit[0] & 0x1f;
        const bool is_image = kind == 1 || kind == 5;  // others belong to the next image
        std::string packet = {'$', '\0', static_cast<char>((unit.size() + 12) >> 8),
                              static_cast<char>(unit.size() + 12)};
        packet += {static_cast<char>(0x80), static_cast<char>(is_image ? 0xe0 : 0x60)};
        packet += {static_cast<char>(sequence >> 8), static_cast<char>(sequence)};
        for (const int shift : {24, 16, 8, 0}) packet += static_cast<char>(time >> shift);
        packet += "test" + unit;
        ++sequence;
        if (is_stopping_ || ::send(client, packet.data(), packet.size(), MSG_NOSIGNAL) < 0) return;
        if (!is_image) continue;
        time += 3600;
        std::this_thread::sleep_for(std::chrono::milliseconds(40));
      }
    }
  }

  std::vector<Unit> units_ = units();
  int port_;
  std::atomic<bool> is_stopping_ = false;
  int listener_;
  std::thread thread_;
};

}  // namespace moiregauge::internal::test
