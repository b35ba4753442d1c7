// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// An HTTP server for browsers on this machine, which costs the program that it is a part of little whatever it is
// asked: GET alone, one request a connection, heads of bounded size and time, no bodies, no ranges, no compression (a
// copy in memory is faster), a bounded number of connections, and an end that no client can hold up.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <httplib.h>

namespace pliant {

// Of the request line and header lines of one request. A connection that exceeds them is closed.
struct HeadLimits {
  // Browsers send the cookies of all servers of this machine, some kB.
  std::size_t bytes = std::size_t{1} << 16;
  // From when a thread takes the connection to the end of the head, however often something arrives.
  std::chrono::milliseconds time = std::chrono::seconds(5);
};

class LoopbackServer {
 public:
  // Fills the response in; called from one of several threads.
  using Handler = std::function<void(const httplib::Request&, httplib::Response*)>;

  // `on_thread` is called once in each thread that answers. At most `threads` requests are answered at a time.
  LoopbackServer(int threads, const std::function<void()>& on_thread, const HeadLimits& limits = {});
  ~LoopbackServer() { Stop(); }
  LoopbackServer(const LoopbackServer&) = delete;
  LoopbackServer& operator=(const LoopbackServer&) = delete;

  // `path` is a regular expression. Before Start.
  void Get(const std::string& path, const Handler& handler);

  // Serves on 127.0.0.1 at this port, or at a free one where it is 0 or taken. False: there is none.
  bool Start(int port);
  int port() const { return port_; }
  // Closes all connections, and comes back when they are closed. Nothing is answered any more.
  void Stop();

 private:
  std::unique_ptr<httplib::Server> http_;
  std::thread thread_;
  std::atomic<bool> serving_ = false;
  int port_ = 0;
};

// The body as it is: no compression.
void SetBody(std::string body, const std::string& content_type, httplib::Response* response);

}  // namespace pliant
