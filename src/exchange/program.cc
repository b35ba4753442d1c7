// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "exchange/program.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

std::string LastLine(const std::string& path) {
  auto reader = LineReader::Open(path);
  std::string last;
  if (!reader.ok()) return last;
  for (std::string_view line; reader->Next(&line);)
    if (line.find_first_not_of(" \t") != std::string_view::npos) last = line;
  return last;
}

}  // namespace

Status RunProgram(const std::vector<std::string>& arguments, const std::string& log_path) {
  if (auto log = OutputFile::Create(log_path); !log.ok()) return log.status();
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log_path.c_str(), O_WRONLY | O_APPEND, 0);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int error = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT)
    return {ErrorCode::kNotFound, "there is no program " + Quoted(arguments[0]) + " on PATH; install it"};
  if (error != 0)
    return {ErrorCode::kNotFound, "cannot run " + Quoted(arguments[0]) + ": " + std::generic_category().message(error)};
  int state = 0;
  while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return Status::Ok();
  std::string call = arguments[0];
  if (arguments.size() > 1) call += " " + arguments[1];
  const std::string how = WIFEXITED(state) ? "ended with " + std::to_string(WEXITSTATUS(state))
                                           : "was ended by signal " + std::to_string(WTERMSIG(state));
  const std::string last = LastLine(log_path);
  return {ErrorCode::kUnreadable,
          Quoted(call) + " " + how + (last.empty() ? "" : ": " + last) + " (its output: " + log_path + ")"};
}

}  // namespace pliant
