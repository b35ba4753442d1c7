// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/loopback_server.h"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

namespace pliant {
namespace {

constexpr std::string_view kHeadBegin = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n";
constexpr std::chrono::milliseconds kShortTime(300);

std::unique_ptr<LoopbackServer> StartLoopbackServer(int threads, const HeadLimits& limits) {
  auto server = std::make_unique<LoopbackServer>(
      threads, [] {}, limits);
  server->Get("/", [](const auto&, auto* response) { SetBody("answer", "text/plain", response); });
  EXPECT_TRUE(server->Start(0));
  return server;
}

int StatusOfGet(const LoopbackServer& server, const httplib::Headers& headers = {}) {
  const auto answer = httplib::Client("127.0.0.1", server.port()).Get("/", headers);
  return answer ? answer->status : 0;
}

// A client that sends what it is told to.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    // So that little is on its way that the server has not read, and a server that reads nothing is noticed.
    const int buffer_bytes = 1 << 15;
    setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &buffer_bytes, sizeof buffer_bytes);
    const timeval longest = {.tv_sec = 10, .tv_usec = 0};
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  ~RawClient() { close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  // False, with the reason in errno: not all of it was taken.
  bool Send(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t sent = send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (sent < 0) return false;
      text.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

 private:
  int socket_;
};

// A client that sends one header line after the other, slowly, as long as it may.
class DrippingClient {
 public:
  explicit DrippingClient(int port) : client_(port) {
    sender_ = std::thread([this] {
      client_.Send(kHeadBegin);
      while (!ends_ && client_.Send("X: a\r\n")) std::this_thread::sleep_for(std::chrono::milliseconds(30));
    });
  }
  ~DrippingClient() {
    ends_ = true;
    sender_.join();
  }
  DrippingClient(const DrippingClient&) = delete;
  DrippingClient& operator=(const DrippingClient&) = delete;

 private:
  RawClient client_;
  std::atomic<bool> ends_ = false;
  std::thread sender_;
};

// Sends the beginning of a head and then this text again and again.
void ExpectCutOff(const LoopbackServer& server, std::string_view text) {
  constexpr std::size_t kFarTooMuch = std::size_t{1} << 22;
  const RawClient client(server.port());
  ASSERT_TRUE(client.Send(kHeadBegin));
  std::size_t sent = 0;
  while (sent < kFarTooMuch && client.Send(text)) sent += text.size();
  const int error = errno;
  ASSERT_LT(sent, kFarTooMuch);
  EXPECT_TRUE(error == EPIPE || error == ECONNRESET) << error;
}

TEST(LoopbackServer, CutsOffAHeadOfEndlessLines) {
  const auto server = StartLoopbackServer(1, {});
  std::string lines;
  for (int k = 0; k < 100; ++k) lines += "x: a\r\n";
  ExpectCutOff(*server, lines);
  EXPECT_EQ(StatusOfGet(*server), 200);
}

TEST(LoopbackServer, CutsOffAnEndlessLine) {
  const auto server = StartLoopbackServer(1, {});
  ExpectCutOff(*server, std::string(1000, 'x'));
  EXPECT_EQ(StatusOfGet(*server), 200);
}

TEST(LoopbackServer, AnswersARequestWithManyCookies) {
  const auto server = StartLoopbackServer(1, {});
  httplib::Headers headers;
  for (int k = 0; k < 10; ++k) headers.emplace("Cookie", std::string(4000, 'x'));
  EXPECT_EQ(StatusOfGet(*server, headers), 200);
}

TEST(LoopbackServer, AnswersOthersAfterClientsWhoseHeadsDrip) {
  const auto server = StartLoopbackServer(2, {.time = kShortTime});
  std::vector<std::unique_ptr<DrippingClient>> clients;
  for (int k = 0; k < 4; ++k) clients.push_back(std::make_unique<DrippingClient>(server->port()));
  EXPECT_EQ(StatusOfGet(*server), 200);
}

TEST(LoopbackServer, AnswersOthersAfterAClientThatSendsNothing) {
  const auto server = StartLoopbackServer(1, {.time = kShortTime});
  const RawClient client(server->port());
  EXPECT_EQ(StatusOfGet(*server), 200);
}

// The time is that of the head, not of the answer.
TEST(LoopbackServer, AnAnswerMayTakeLongerThanAHead) {
  LoopbackServer server(1, [] {}, {.time = kShortTime});
  server.Get("/", [](const auto&, auto* response) {
    std::this_thread::sleep_for(2 * kShortTime);
    SetBody(std::string(std::size_t{1} << 20, 'x'), "text/plain", response);
  });
  ASSERT_TRUE(server.Start(0));
  const auto answer = httplib::Client("127.0.0.1", server.port()).Get("/");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->body.size(), std::size_t{1} << 20);
}

}  // namespace
}  // namespace pliant
