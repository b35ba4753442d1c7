// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A server on this machine that sends one program the same bytes, whatever it asks for, and cuts the connection.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace pliant {

class ServedBytes {
 public:
  explicit ServedBytes(const std::string& bytes) : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(listener_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
    EXPECT_EQ(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, bytes] { Serve(bytes); });
  }
  ~ServedBytes() {
    shutdown(listener_, SHUT_RDWR);  // wakes a server that nobody has asked
    thread_.join();
    close(listener_);
  }
  ServedBytes(const ServedBytes&) = delete;
  ServedBytes& operator=(const ServedBytes&) = delete;

  std::string address() const { return "http://127.0.0.1:" + std::to_string(port_) + "/stream"; }

 private:
  void Serve(std::string_view bytes) const {
    const int connection = accept(listener_, nullptr, nullptr);
    if (connection < 0) return;
    std::array<char, 4096> request;
    bool goes_on = recv(connection, request.data(), request.size(), 0) > 0;
    while (goes_on && !bytes.empty()) {
      const ssize_t sent = send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      goes_on = sent > 0;
      if (goes_on) bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    close(connection);
  }

  int listener_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace pliant
