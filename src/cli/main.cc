// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/messages.h"
#include "commit.h"  // made by cmake/WriteCommit.cmake
#include "pliant/base/options.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"

namespace pliant::cli {
namespace {

struct Command {
  std::string_view name;
  std::string_view summary;
  int (*run)(std::span<const std::string> args);
  std::size_t words = 1;  // of a manual's name: "dataset info"
};

constexpr std::array kCommands = {
    Command{"track", "camera pose and the motion of every point, from a folder of images or a video", TrackCommand},
    Command{"calibrate", "camera.yaml from images or a video of a calibration board", CalibrateCommand},
    Command{"simulate", "render a scene that deforms, with depth, poses and the paths of its material",
            SimulateCommand},
    Command{"dataset", "say what a data set holds and what is wrong with it, or convert it", DatasetCommand, 2},
    Command{"evaluate", "compare a run with the truth of its sequence, or with other runs", EvaluateCommand},
    Command{"compare", "set runs side by side: Pliant's, COLMAP's, other systems'", CompareCommand},
    Command{"truth", "follow the material that pixels of a simulated sequence show", TruthCommand},
    Command{"import", "make a run, or a sequence's truth, of another program's result: COLMAP, TUM, KITTI, EuRoC",
            ImportCommand},
    Command{"refine", "solve for all frames of a run at once", RefineCommand},
    Command{"join", "one run of runs of parts of a recording, which overlap", JoinCommand},
    Command{"surface", "dense depth of every frame of a run", SurfaceCommand},
    Command{"export", "write a run in other programs' formats: COLMAP, PLY, TUM, nerfstudio, EndoNeRF, tracks",
            ExportCommand},
    Command{"report", "show runs: a page for the browser, figures, films", ReportCommand},
    Command{"model", "check a COLMAP model, or convert it between text and binary", ModelCommand, 2},
    Command{"demo", "simulate, track and evaluate a small sequence", DemoCommand},
};

std::string Usage() {
  std::string text =
      "pliant - camera pose and scene deformation from one moving camera\n\nusage: pliant COMMAND ...\n\n";
  for (const Command& command : kCommands)
    text += "  " + std::string(command.name) + std::string(12 - command.name.size(), ' ') +
            std::string(command.summary) + "\n";
  return text +
         "\npliant COMMAND --help is the command's manual, and --help-all has all of its options; pliant --version "
         "prints the versions of it and of its libraries.\n";
}

int Run(std::span<const std::string> args);

// The manual of `command`, which begins with its name.
int Help(std::span<const std::string> command) {
  const auto known = std::ranges::find(kCommands, command.front(), &Command::name);
  if (const std::size_t most = known == kCommands.end() ? command.size() : known->words; command.size() > most) {
    SayError("help is of one command, and '" + command[most] + "' is more than its name; leave it out");
    return kExitUsage;
  }
  std::vector<std::string> args(command.begin(), command.end());
  args.emplace_back("--help");
  return Run(args);
}

int Run(std::span<const std::string> args) {
  if (args.empty()) {
    std::cerr << Usage();
    return kExitUsage;
  }
  const std::string& name = args.front();
  if (name == "help" && args.size() > 1) return Help(args.subspan(1));
  if (name == "--help" || name == "--help-all" || name == "-h" || name == "help") {
    std::cout << Usage();
    return kExitOk;
  }
  if (name == "--version" || name == "version" || name == "-V" || name == "-v") {
    std::cout << "pliant " << ProgramVersion() << "\nbuilt by " << BuildText() << "\nwith " << LibrariesText() << "\n";
    return kExitOk;
  }
  std::vector<std::string> names;
  for (const Command& command : kCommands) {
    if (command.name == name) return command.run(args.subspan(1));
    names.emplace_back(command.name);
  }
  const std::string similar = SimilarName(name, names);
  SayError("there is no command '" + name + "'; " + (similar.empty() ? "" : "did you mean '" + similar + "'? ") +
           "pliant --help lists them");
  return kExitUsage;
}

// A closed standard stream would give its number to the next file that is opened, and messages would end up in a run's
// files.
void OpenStandardStreams() {
  int opened = 0;
  do {
    opened = open("/dev/null", O_RDWR);
  } while (opened >= 0 && opened <= STDERR_FILENO);
  if (opened > STDERR_FILENO) close(opened);
}

// What the video decoder says of a damaged file is said once, by the command. Whoever sets the variable wants to see
// it.
void QuietVideoDecoder() { setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0); }

// A write beyond the limit of a file's size then fails as one to a full disk does, instead of ending the program.
void SurviveFileSizeLimit() { std::signal(SIGXFSZ, SIG_IGN); }

// Whether nobody reads any more what is written there.
bool IsClosedPipe(int descriptor) {
  pollfd stream = {descriptor, POLLOUT, 0};
  return poll(&stream, 1, 0) == 1 && (stream.revents & (POLLERR | POLLHUP)) != 0;
}

// Of what a library threw that ran out of memory, or met what it did not expect.
std::string SentenceOf(const std::exception& error) {
  std::string what = error.what();
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr || what.find("Insufficient memory") != std::string::npos)
    return "there is not enough memory; give smaller images, fewer points or a part of the frames, or end other "
           "programs";
  if (!what.starts_with("OpenCV(")) return what;
  constexpr std::string_view kBefore = "in function '";
  const std::size_t found = what.find(kBefore);
  const std::size_t begin = found == std::string::npos ? what.size() : found + kBefore.size();
  return "OpenCV failed in its function " + Quoted(what.substr(begin, what.find('\'', begin) - begin)) +
         "; is there enough memory? If there is, report it with the command";
}

}  // namespace
}  // namespace pliant::cli

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + (argc > 0 ? 1 : 0), argv + argc);
  pliant::cli::OpenStandardStreams();
  pliant::cli::QuietVideoDecoder();
  pliant::cli::SurviveFileSizeLimit();
  try {
    pliant::cli::ProgramVersion() += kCommitText;
    const int exit = pliant::cli::Run(args);
    if (std::cout.flush() || exit != pliant::cli::kExitOk) return exit;
    // Whoever closed the pipe has read all that was wanted.
    if (!pliant::cli::IsClosedPipe(STDOUT_FILENO))
      pliant::cli::SayError("cannot write to standard output; is the disk full?");
    return pliant::cli::kExitFailed;
  } catch (const std::exception& error) {
    pliant::cli::SayError(pliant::cli::SentenceOf(error));
    return pliant::cli::kExitFailed;
  }
}
