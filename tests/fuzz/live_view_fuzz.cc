// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a client sends to the live view.
#include <cstdlib>
#include <string>
#include <string_view>

#include <netinet/in.h>
#include <opencv2/core.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "fuzz_input.h"
#include "pliant/viewer/live_view.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

namespace {

// Of a run that has ended: nobody waits for news. It is never stopped.
LiveView& View() {
  static LiveView* const view = [] {
    auto started = LiveView::Start({.name = "run", .in_millimeters = true}, {});
    if (!started.ok()) std::abort();
    const auto camera = Camera::Create(CameraModelId::kPinhole, 32, 24, std::vector<double>{30, 30, 15.5, 11.5});
    (*started)->OnCamera(*camera);
    (*started)->OnStart(2);
    for (int k = 0; k < 2; ++k) {
      FrameReport report;
      report.frame_idx = k;
      (*started)->OnImage(k, cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(80)));
      (*started)->OnFrame(report);
    }
    (*started)->KeepRun();
    return started->release();
  }();
  return *view;
}

int Connect() {
  const std::string url = View().Url();
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(std::atoi(url.c_str() + url.rfind(':') + 1)));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  const timeval longest = {.tv_sec = 10, .tv_usec = 0};
  setsockopt(connection, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  // Closed without waiting, as a hostile client does, or there would be no ports left.
  const linger at_once = {.l_onoff = 1, .l_linger = 0};
  setsockopt(connection, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  if (connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) std::abort();
  return connection;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int connection = Connect();
  send(connection, data, size, MSG_NOSIGNAL);
  shutdown(connection, SHUT_WR);
  std::string answer;
  char part[65536];
  ssize_t received = 0;
  while ((received = recv(connection, part, sizeof part, 0)) > 0)
    answer.append(part, static_cast<std::size_t>(received));
  const bool waited_in_vain = received < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
  close(connection);
  if (waited_in_vain || (!answer.empty() && !answer.starts_with("HTTP/1.1 "))) std::abort();
  return 0;
}
