// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Options of every kind from a file that is anything at all.
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz_input.h"
#include "pliant/io/options_file.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

namespace {

struct EveryKind {
  bool flag = true;
  int count = 8;
  double width_px = 0.5;
  std::string path;
  Switch choice = Switch::kOff;
  std::vector<Switch> choices;

  void List(OptionTable& table) {
    table.BeginGroup("Kinds", "an option of every kind");
    table.Add("flag", &flag, "-", "a switch");
    table.Add("count", &count, "-", "an integer", -3, 64);
    table.Add("width", &width_px, "px", "a number", 0, 1e9);
    table.Add("path", &path, "-", "a text");
    table.Renamed("file", "path");
    table.BeginGroup("More", "the others");
    table.AddChoice("choice", &choice, "one of them");
    table.AddChoices("choices", &choices, "any of them");
    table.RenamedValue("choice", "none", "off");
    table.RenamedGroup("Other", "More");
  }
};

}  // namespace

// A file that is refused changes nothing; one that is taken leaves options that come back from their own file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  EveryKind options;
  OptionTable table;
  options.List(table);
  const std::string before = table.ToYaml();
  const Status status = LoadOptionsFile(WriteFuzzFile("options.yaml", {data, size}), table);
  if (!status.ok()) {
    if (status.message().empty() || table.ToYaml() != before) std::abort();
    return 0;
  }
  const std::string after = table.ToYaml();
  EveryKind again;
  OptionTable read;
  again.List(read);
  const std::string_view bytes = after;
  if (!LoadOptionsFile(WriteFuzzFile("again.yaml", {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}),
                       read)
           .ok() ||
      read.ToYaml() != after)
    std::abort();
  return 0;
}
