// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// An HTTP server for browsers on this machine, which costs the program that it is a part of little whatever it is
// asked: GET alone, no bodies, no ranges, no compression (a copy in memory is faster), a bounded number of connections,
// and an end that no client can hold up.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include <httplib.h>

namespace pliant {

class LoopbackServer {
 public:
  // Fills the response in; called from one of several threads.
  using Handler = std::function<void(const httplib::Request&, httplib::Response*)>;

  // `on_thread` is called once in each thread that answers. At most `threads` requests are answered at a time.
  LoopbackServer(int threads, const std::function<void()>& on_thread);
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
  httplib::Server http_;
  std::thread thread_;
  std::atomic<bool> serving_ = false;
  int port_ = 0;
};

// The body as it is: no compression.
void SetBody(std::string body, const std::string& content_type, httplib::Response* response);

}  // namespace pliant
