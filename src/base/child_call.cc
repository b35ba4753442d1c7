// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/child_call.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pliant {
namespace {

// An answer is an error code, the size of what follows, and the bytes or the sentence.
constexpr std::size_t kHeadSize = 1 + sizeof(std::uint64_t);
constexpr int kWallByCpu = 5;  // seconds by the clock: the machine may have other work

void Limit(int what, rlim_t soft, rlim_t hard) {
  struct rlimit limit = {};
  if (getrlimit(what, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, hard);
  limit.rlim_cur = std::min(limit.rlim_max, soft);
  setrlimit(what, &limit);
}

// Addresses of this process, in bytes; 0 where the system does not say.
rlim_t AddressSpace() {
#ifdef __SANITIZE_ADDRESS__
  return 0;  // the address sanitizer waits for ever where it gets no addresses
#endif
  std::ifstream file("/proc/self/statm");
  rlim_t pages = 0;
  file >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

bool WriteAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

std::string ReadAll(int file) {
  std::string bytes;
  std::array<char, 1 << 16> part;
  for (;;) {
    const ssize_t size = read(file, part.data(), part.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return bytes;
    bytes.append(part.data(), static_cast<std::size_t>(size));
  }
}

// In the child: its signals and limits, the call, the answer. Never returns.
[[noreturn]] void Answer(int file, pid_t parent, const std::string& what, const ChildLimits& limits,
                         const std::function<Result<std::string>()>& call) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGALRM}) std::signal(signal, SIG_DFL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  Limit(RLIMIT_CORE, 0, 0);
  const auto seconds = static_cast<rlim_t>(limits.cpu_seconds);
  Limit(RLIMIT_CPU, seconds, seconds + 1);
  alarm(static_cast<unsigned>(kWallByCpu * limits.cpu_seconds));  // one that waits takes no CPU time
  const std::string too_much =
      what + ": its reader asks for more than " + std::to_string(limits.memory_bytes / 1000000) + " MB of memory";
  if (const rlim_t now = AddressSpace(); now > 0) {
    const rlim_t most = now + static_cast<rlim_t>(limits.memory_bytes);
    Limit(RLIMIT_AS, most, most);
  }
  ErrorCode code = ErrorCode::kUnreadable;
  std::string answer;
  try {
    Result<std::string> result = call();
    code = result.status().code();
    answer = result.ok() ? std::move(*result) : result.status().message();
  } catch (const std::bad_alloc&) {
    answer = too_much;
  } catch (const std::exception& error) {
    answer = what + ": " + error.what();
  }
  std::array<char, kHeadSize> head;
  head[0] = static_cast<char>(code);
  const std::uint64_t size = answer.size();
  std::memcpy(&head[1], &size, sizeof size);
  _exit(WriteAll(file, {head.data(), head.size()}) && WriteAll(file, answer) ? 0 : 1);
}

}  // namespace

Result<std::string> CallInChild(const std::string& what, const ChildLimits& limits,
                                const std::function<Result<std::string>()>& call) {
  const auto no_process = [&] {
    return Status(ErrorCode::kUnreadable,
                  what + ": no process can be started for it: " + std::generic_category().message(errno));
  };
  std::array<int, 2> ends = {};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return no_process();
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) Answer(ends[1], parent, what, limits, call);
  close(ends[1]);
  if (child < 0) {
    const Status failed = no_process();
    close(ends[0]);
    return failed;
  }
  std::string bytes = ReadAll(ends[0]);
  close(ends[0]);
  int state = 0;
  while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  std::uint64_t size = 0;
  if (bytes.size() >= kHeadSize) std::memcpy(&size, &bytes[1], sizeof size);
  if (bytes.size() >= kHeadSize && bytes.size() - kHeadSize == size) {
    const auto code = static_cast<ErrorCode>(bytes[0]);
    bytes.erase(0, kHeadSize);
    if (code == ErrorCode::kOk) return bytes;
    return {code, bytes};
  }
  const int signal = WIFSIGNALED(state) ? WTERMSIG(state) : 0;
  std::string why = signal == 0 ? "did not answer" : "was ended by signal " + std::to_string(signal);
  if (signal == SIGXCPU || signal == SIGALRM) why = "needs more than " + std::to_string(limits.cpu_seconds) + " s";
  return {ErrorCode::kUnreadable, what + ": its reader " + why};
}

}  // namespace pliant
