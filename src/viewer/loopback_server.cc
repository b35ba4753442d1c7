// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/loopback_server.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "pliant/base/options.h"

namespace pliant {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
// Browsers on this machine send a request at once, and read the answer as fast as they can. The times are those of one
// read and one write.
constexpr std::chrono::seconds kReadTimeout(2);
constexpr std::chrono::seconds kWriteTimeout(5);

// A page of another site must not read it by naming this machine after itself.
bool IsForThisMachine(const httplib::Request& request) {
  const std::string host = request.get_header_value("Host");
  const std::string name = host.substr(0, host.rfind(':'));
  return name == kLoopback || name == "localhost";
}

int StatusOfWhatIsRefused(const httplib::Request& request) {
  if (!IsForThisMachine(request)) return 403;
  if (request.method != "GET") return 405;
  return request.has_header("Range") ? 416 : 0;
}

// As many threads as connections: a further one waits in the system's queue, not in ours, where it would take a file
// descriptor of the program.
class BoundedThreads final : public httplib::TaskQueue {
 public:
  BoundedThreads(int threads, const std::function<void()>& on_thread) : free_(threads) {
    for (int k = 0; k < threads; ++k)
      threads_.emplace_back([this, on_thread] {
        on_thread();
        Work();
      });
  }
  void enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return free_ > 0; });
    --free_;
    tasks_.push_back(std::move(task));
    changed_.notify_all();
  }
  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  void Work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return !tasks_.empty() || ends_; });
      if (tasks_.empty()) return;
      const std::function<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
      lock.lock();
      ++free_;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  int free_;
  bool ends_ = false;
  std::vector<std::thread> threads_;
};

// False: nothing can be read or written until then.
bool WaitForSocket(socket_t descriptor, short event, std::chrono::steady_clock::time_point until) {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd polled = {descriptor, event, 0};
    const int ready = poll(&polled, 1, static_cast<int>(left.count()));
    if (ready > 0) return (polled.revents & event) != 0;
    if (ready == 0 || errno != EINTR) return false;
  }
}

// A connection with one request. The library limits the length of a header line, but neither the number of lines nor
// the length of a line that does not end, and the time of one read, but not of all reads. All that is read counts as
// the head: no body is read.
class LimitedStream final : public httplib::Stream {
 public:
  LimitedStream(socket_t descriptor, const HeadLimits& limits)
      : descriptor_(descriptor), bytes_left_(limits.bytes), end_(std::chrono::steady_clock::now() + limits.time) {}
  bool is_readable() const override { return begin_ < size_ || WaitToRead(); }
  bool is_writable() const override {
    return WaitForSocket(descriptor_, POLLOUT, std::chrono::steady_clock::now() + kWriteTimeout);
  }
  ssize_t read(char* data, std::size_t size) override {
    if (begin_ == size_) {
      const ssize_t received = Receive();
      if (received <= 0) return received;
    }
    const std::size_t taken = std::min(size, size_ - begin_);
    std::copy_n(buffer_.data() + begin_, taken, data);
    begin_ += taken;
    return static_cast<ssize_t>(taken);
  }
  ssize_t write(const char* data, std::size_t size) override {
    if (!is_writable()) return -1;
    ssize_t sent = -1;
    do sent = send(descriptor_, data, size, MSG_NOSIGNAL);  // for kWriteTimeout at most, an option of the socket
    while (sent < 0 && errno == EINTR);
    return sent;
  }
  // All clients are on this machine, and no handler asks for their ports.
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = kLoopback;
    port = 0;
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override { get_remote_ip_and_port(ip, port); }
  socket_t socket() const override { return descriptor_; }

 private:
  // The first byte may take longer: browsers connect before they have something to ask.
  bool WaitToRead() const {
    const auto until = std::chrono::steady_clock::now() + kReadTimeout;
    return WaitForSocket(descriptor_, POLLIN, size_ == 0 ? end_ : std::min(end_, until));
  }
  // 0: the client sends no more. Negative: it has used up its bytes or its time, or is gone.
  ssize_t Receive() {
    if (bytes_left_ == 0 || !WaitToRead()) return -1;
    const ssize_t received = recv(descriptor_, buffer_.data(), std::min(buffer_.size(), bytes_left_), MSG_DONTWAIT);
    if (received <= 0) return received;
    begin_ = 0;
    size_ = static_cast<std::size_t>(received);
    bytes_left_ -= size_;
    return received;
  }

  const socket_t descriptor_;
  std::size_t bytes_left_;
  const std::chrono::steady_clock::time_point end_;
  std::array<char, 4096> buffer_;  // the library reads single bytes
  std::size_t begin_ = 0;          // of what is in the buffer and not read yet
  std::size_t size_ = 0;
};

// The library's, with streams of our own.
class LimitedServer final : public httplib::Server {
 public:
  explicit LimitedServer(const HeadLimits& limits) : limits_(limits) {}

 private:
  // An idle connection would hold a thread: none is kept for a second request.
  bool process_and_close_socket(socket_t descriptor) override {
    bool answered = false;
    if (svr_sock_ != INVALID_SOCKET) {  // or the server is being stopped
      LimitedStream stream(descriptor, limits_);
      bool closed = false;
      answered = process_request(stream, /*close_connection=*/true, closed, nullptr);
    }
    shutdown(descriptor, SHUT_RDWR);
    close(descriptor);
    return answered;
  }

  const HeadLimits limits_;
};

// Ends the connections to this port of this machine that this program has accepted: who reads or writes there goes on
// at once. The library does not say which they are.
void EndConnections(int port) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    int descriptor = -1;
    if (!ParseInt(entry.path().filename().string(), &descriptor)) continue;
    sockaddr_in address = {};
    socklen_t size = sizeof address;
    if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
    if (address.sin_family == AF_INET && ntohs(address.sin_port) == port) shutdown(descriptor, SHUT_RDWR);
  }
}

}  // namespace

LoopbackServer::LoopbackServer(int threads, const std::function<void()>& on_thread, const HeadLimits& limits)
    : http_(std::make_unique<LimitedServer>(limits)) {
  // Not the library's own, by which two programs could share a port.
  http_->set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  http_->set_payload_max_length(0);
  http_->set_read_timeout(kReadTimeout);
  http_->set_write_timeout(kWriteTimeout);
  http_->new_task_queue = [threads, on_thread] { return new BoundedThreads(threads, on_thread); };
  // Before a body is read.
  http_->set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
    const int refused = StatusOfWhatIsRefused(request);
    if (refused == 0) return httplib::Server::HandlerResponse::Unhandled;
    response.status = refused;
    return httplib::Server::HandlerResponse::Handled;
  });
}

void LoopbackServer::Get(const std::string& path, const Handler& handler) {
  http_->Get(path,
             [handler](const httplib::Request& request, httplib::Response& response) { handler(request, &response); });
}

bool LoopbackServer::Start(int port) {
  port_ = port;
  if (port == 0 || !http_->bind_to_port(kLoopback, port)) port_ = http_->bind_to_any_port(kLoopback);
  if (port_ <= 0) return false;
  serving_ = true;
  thread_ = std::thread([this] {
    http_->listen_after_bind();
    serving_ = false;
  });
  while (!http_->is_running()) std::this_thread::yield();  // before that it cannot be stopped
  return true;
}

void LoopbackServer::Stop() {
  if (!thread_.joinable()) return;
  http_->stop();
  while (serving_) {
    EndConnections(port_);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  thread_.join();
}

void SetBody(std::string body, const std::string& content_type, httplib::Response* response) {
  if (body.empty()) return;
  const std::size_t size = body.size();
  response->set_content_provider(size, content_type,
                                 [kept = std::make_shared<const std::string>(std::move(body))](
                                     std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                   return sink.write(kept->data() + offset, length);
                                 });
}

}  // namespace pliant
