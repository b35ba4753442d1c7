// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The program itself, started as a user starts it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

namespace pliant::program_test {

struct Outcome {
  int exit = -1;
  std::string out;
  std::string err;
};

inline std::filesystem::path Temporary(const std::string& name) {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "pliant_program_test" / test->name();
  static std::string started;  // the test whose folder was emptied, of what an earlier run left
  if (started != test->name()) std::filesystem::remove_all(folder);
  started = test->name();
  std::filesystem::create_directories(folder);
  return folder / name;
}

inline std::string ReadText(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A coarse scene, in view for a short way only, so that it is made fast.
inline const std::string kCoarse =
    " --Scene.view_mm 80 --Scene.mesh_step_mm 2 --Texture.smallest_mm 2 --Texture.texel_mm 0.8 --Camera.width 64"
    " --Camera.height 48 --Sensor.samples 1 ";

// Runs `pliant arguments` through the shell, after the command `before`, with standard error in a file (so no
// terminal).
inline Outcome Pliant(const std::string& arguments, const std::string& before = "true") {
  const std::filesystem::path out = Temporary("out.txt");
  const std::filesystem::path err = Temporary("err.txt");
  const std::string command =
      before + "; '" PLIANT_PROGRAM "' " + arguments + " >'" + out.string() + "' 2>'" + err.string() + "'";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadText(out), ReadText(err)};
}

// A result as another system would leave it, of a camera that moves along x, with one point.
inline std::string ForeignResult(const std::string& name, int frames) {
  const std::filesystem::path folder = Temporary(name);
  std::filesystem::create_directories(folder);
  std::ofstream trajectory(folder / "trajectory.txt");
  std::ofstream observations(folder / "observations.csv");
  observations << "frame,point_id,u_px,v_px,x,y,z\n";
  for (int i = 0; i < frames; ++i) {
    trajectory << i / 30.0 << " " << i << " 0 0 0 0 0 1\n";
    observations << i << ",1,30,20,0,0,40\n";
  }
  return folder.string();
}

}  // namespace pliant::program_test
