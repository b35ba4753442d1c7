// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/bundle.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <regex>
#include <sstream>
#include <system_error>
#include <thread>

#include <nlohmann/json.hpp>
#include <sys/utsname.h>

#include "pliant/base/files.h"
#include "pliant/base/staged_folder.h"
#include "pliant/base/text.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_summary.h"
#include "viewer/view_images.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxTableBytes = 1500000;  // of frames.csv, and of trajectory.txt
constexpr std::size_t kMaxImageBytes = 180000;
constexpr int kJpegQuality = 92;

constexpr const char* kReadMe = "README.txt";
constexpr const char* kWhatItIs = "A bundle of a run of Pliant, to be sent with a question.";  // README.txt begins so
constexpr const char* kVersions = "versions.txt";
constexpr const char* kSummary = "run.json";
constexpr const char* kConfig = "config.yaml";
constexpr const char* kCamera = "camera.yaml";
constexpr std::array kBundleNames = {kReadMe, kVersions,    kSummary,         kConfig,
                                     kCamera, "frames.csv", "trajectory.txt", "images"};

bool HoldsBundle(const fs::path& folder) {
  const auto read_me = ReadFile((folder / kReadMe).string());
  return read_me.ok() && read_me->starts_with(kWhatItIs);
}

// Of a bundle that is replaced only the files of a bundle may be in the way.
Result<StagedFolder> StageBundle(const BundleRequest& request) {
  if (!HoldsBundle(request.output_path))
    return StagedFolder::Create(request.output_path, {kBundleNames.begin(), kBundleNames.end()});
  if (request.replaces_bundle) return StagedFolder::Create(request.output_path, {});
  return Status(ErrorCode::kInvalidArgument,
                Quoted(request.output_path) +
                    " holds a bundle already; give another --output_path, or --overwrite to replace it");
}

void DeleteBundle(const fs::path& folder) {
  std::error_code error;
  if (!HoldsBundle(folder)) return;
  for (const char* name : kBundleNames) fs::remove_all(folder / name, error);
}

bool IsWordCharacter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// With the ending, where it is one, and says no more than what kind of a file it is.
std::string Placeholder(const std::string& path) {
  constexpr std::size_t kLongest = 6;  // ".webm"
  const std::string ending = path.find("://") == std::string::npos ? fs::path(path).extension().string() : "";
  const bool is_short = ending.size() <= kLongest &&
                        std::all_of(ending.begin() + (ending.empty() ? 0 : 1), ending.end(), IsWordCharacter);
  return "<path>" + (is_short ? ending : "");
}

// Whether a text names a file by its looks: "clip.mp4", "data/camera.yaml".
bool LooksLikeFile(const std::string& text) {
  if (text.find('/') != std::string::npos) return true;
  const std::size_t dot = text.rfind('.');
  return dot != std::string::npos && dot + 1 < text.size() &&
         std::isalpha(static_cast<unsigned char>(text[dot + 1])) != 0 &&
         std::all_of(text.begin() + static_cast<std::ptrdiff_t>(dot) + 1, text.end(), IsWordCharacter);
}

// Images and videos that a sentence names without their folder, up to the blank before them.
std::string WithoutImageNames(const std::string& sentence) {
  constexpr std::array kEndings = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp", ".mp4",
                                   ".m4v", ".avi", ".mov",  ".mkv", ".mpg", ".mpeg", ".webm", ".wmv"};
  std::string cleaned;
  for (std::size_t begin = 0; begin < sentence.size();) {
    std::size_t end = std::min(sentence.find_first_of(" \n'\"(),;:", begin), sentence.size());
    std::string word = sentence.substr(begin, end - begin);
    std::string lower = word.substr(0, word.find_last_not_of(".!?") + 1);
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (std::ranges::any_of(kEndings, [&](const char* ending) { return lower.ends_with(ending); }))
      word = Placeholder(word);
    cleaned += word;
    if (end < sentence.size()) cleaned += sentence[end++];
    begin = end;
  }
  return cleaned;
}

// Of "--camera=data/camera.yaml" what is behind the sign; nothing of another name, and any other word as it is.
std::string ValueIn(const std::string& word) {
  if (!word.starts_with("-")) return word;
  const std::size_t sign = word.find('=');
  return sign == std::string::npos ? "" : word.substr(sign + 1);
}

// Whether the word behind this one of a command line is a path.
bool TakesPath(const std::string& name) {
  constexpr std::array kNames = {"-o",       "--config",      "--camera", "--run",    "--sequence",
                                 "--tracks", "--depth_prior", "--figure", "--surface"};
  return std::ranges::find(kNames, name) != kNames.end() || (name.starts_with("--") && name.ends_with("path"));
}

// Names in a folder that have blanks, which a sentence does not tell from its words.
std::vector<fs::path> NamesWithBlanks(const fs::path& folder) {
  constexpr int kMostNames = 100000;
  std::vector<fs::path> names;
  std::error_code error;
  int seen = 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end && ++seen < kMostNames; it.increment(error))
    if (const fs::path name = it->path().filename(); name.string().find(' ') != std::string::npos)
      names.push_back(name);
  return names;
}

// The files and folders that a run speaks of, by their whole names and as they were typed; the run's own folder, too.
// The longest first: none is a part of a later one.
std::vector<fs::path> KnownPaths(const std::string& run_path, const RunDescription& run) {
  std::vector<fs::path> paths = {fs::absolute(run_path + "/").parent_path()};
  for (const std::string& word : run.command_line) {
    const std::string value = ValueIn(word);
    if (LooksLikeFile(value) || value.find(' ') != std::string::npos) paths.emplace_back(value);
  }
  for (const fs::path& folder : {fs::path(run.input), fs::path(run.input) / "images", fs::path(run.mask)})
    for (fs::path& name : NamesWithBlanks(folder)) paths.push_back(std::move(name));
  for (const std::string* path : {&run.input, &run.camera, &run.mask, &run.refined_from, &run.tracks, &run.depth_prior})
    if (!path->empty()) paths.emplace_back(*path);
  for (const std::string& path : run.joined_from)
    if (!path.empty()) paths.emplace_back(path);
  std::ranges::stable_sort(paths, {}, [](const fs::path& path) { return -static_cast<int>(path.native().size()); });
  return paths;
}

std::string ReplacedAll(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// No line of ours is that long, and the matcher of regular expressions runs out of stack on longer ones.
std::string WithoutLongLines(const std::string& text) {
  constexpr std::size_t kLongest = 8000;
  std::string shortened;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    shortened += end - begin > kLongest ? "<long line>" : text.substr(begin, end - begin);
    if (end < text.size()) shortened += '\n';
    begin = end + 1;
  }
  return shortened;
}

std::string Cleaned(std::string sentence, const std::vector<fs::path>& known) {
  constexpr std::size_t kLongest = 4000;  // of a sentence of ours
  if (sentence.size() > kLongest) sentence = "<long text>";
  for (const fs::path& path : known) sentence = ReplacedAll(std::move(sentence), path.string(), Placeholder(path));
  return WithoutImageNames(WithoutPaths(sentence));
}

// A word of the command line, and the one before it: "clip.mp4", "--camera=data/camera.yaml", "run of monday".
std::string CleanedWord(const std::string& before, const std::string& word, const std::vector<fs::path>& known) {
  const std::string value = ValueIn(word);
  if (value.empty() || value == "unknown") return word;  // a name, or a camera without a calibration
  const std::size_t begin = word.size() - value.size();
  const bool is_known = TakesPath(begin > 0 ? word.substr(0, begin - 1) : before) ||
                        std::ranges::any_of(known, [&](const fs::path& path) { return path.filename() == value; });
  return is_known || LooksLikeFile(value) ? word.substr(0, begin) + Placeholder(value) : word;
}

Json Cleaned(const Json& json, const std::vector<fs::path>& known) {
  if (json.is_string()) return Cleaned(json.get<std::string>(), known);
  if (!json.is_structured()) return json;
  Json cleaned = json;
  for (Json& value : cleaned) value = Cleaned(value, known);
  return cleaned;
}

std::string CleanedSummary(const std::string& text, const std::vector<fs::path>& known) {
  const Json summary = Json::parse(text);
  Json cleaned = Cleaned(summary, known);
  Json words = Json::array();
  std::string before;
  for (const Json& word : summary.at("command_line")) {
    words.push_back(CleanedWord(before, word.get<std::string>(), known));
    before = word.get<std::string>();
  }
  cleaned["command_line"] = std::move(words);
  return cleaned.dump(2) + "\n";
}

// Of config.yaml: `name: value  # [unit] why`; units of files and folders are FILE, DIR, file and path.
std::string CleanedOptions(const std::string& options) {
  const std::string yaml = WithoutLongLines(options);
  static const std::regex path_option(R"re((\n\s+\w+: )([^"\s#][^\s#]*|"[^"\n]+")(?=\s+# \[(FILE|DIR|file|path)\]))re");
  return WithoutPaths(std::regex_replace(yaml, path_option, "$1<path>"));
}

// Every second line below the header is left out, as often as it takes.
std::string Thinned(const std::string& table, bool has_header, std::vector<std::string>* notes,
                    const std::string& name) {
  if (table.size() <= kMaxTableBytes) return table;
  const std::size_t step = table.size() / kMaxTableBytes + 1;
  std::istringstream lines(table);
  std::string thinned;
  std::string line;
  for (std::size_t i = 0; std::getline(lines, line); ++i)
    if ((has_header && i == 0) || i % step == (has_header ? 1 % step : 0)) thinned += line + "\n";
  notes->push_back("of " + name + " the bundle has one line in " + std::to_string(step));
  return thinned;
}

std::string SystemText() {
  std::string text;
  utsname system{};
  if (uname(&system) == 0) text = std::string(system.sysname) + " " + system.release + ", " + system.machine + "\n";
  if (const auto release = ReadFile("/etc/os-release"); release.ok()) {
    std::istringstream lines(*release);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("PRETTY_NAME=")) text += line.substr(12) + "\n";
  }
  return text + std::to_string(std::thread::hardware_concurrency()) + " processors\n";
}

std::string VersionsText(const std::string& program_version, const RunDescription& run) {
  return "pliant " + program_version + "\nbuilt by " + std::string(BuildText()) + "\nwith " +
         std::string(LibrariesText()) + "\nthe run is of version " + run.program_version + "\n" + SystemText();
}

// Small enough, at whatever size.
std::string SmallJpeg(cv::Mat image) {
  std::string jpeg = ToJpeg(image, kJpegQuality);
  while (jpeg.size() > kMaxImageBytes && image.cols > 64) {
    image = Shrink(image, image.cols * 3 / 4);
    jpeg = ToJpeg(image, kJpegQuality);
  }
  return jpeg;
}

class Bundle {
 public:
  Bundle(const BundleRequest& request, const JobProgress& progress, StagedFolder staged)
      : request_(request), progress_(progress), staged_(std::move(staged)) {}

  Status Add(const std::string& name, const std::string& content) {
    if (Status status = Write(name, content); !status.ok()) return status;
    return Tell(progress_, "bundle", static_cast<int>(summary_.files.size()), 0);
  }

  Status AddTable(const std::string& name, bool has_header) {
    const auto table = ReadFile(request_.run_path + "/" + name);
    if (!table.ok()) {
      summary_.notes.push_back("the run has no " + name);
      return Status::Ok();
    }
    return Add(name, Thinned(*table, has_header, &summary_.notes, name));
  }

  // The calibration, and images evenly spread over the recording.
  Status AddSequence() {
    const SequenceRequest request = SequenceOfRun(request_.run_path, request_.sequence_path, request_.camera_path);
    auto sequence = OpenImagesOfRun(request_.run_path, request);
    if (!sequence.ok()) {
      summary_.notes.push_back("there is no camera.yaml and there are no images: " +
                               WithoutPaths(sequence.status().message()));
      return Status::Ok();
    }
    const fs::path camera = staged_.Path(kCamera);
    if (Status status = WriteCameraFile(camera.string(), {.camera = (*sequence)->camera()}); !status.ok())
      return status;
    summary_.files.emplace_back(kCamera);
    std::error_code error;
    summary_.megabytes += static_cast<double>(fs::file_size(camera, error)) / 1e6;
    if (request_.images == BundledImages::kNone) return Status::Ok();
    return AddImages(**sequence);
  }

  Result<BundleSummary> Finish() {
    std::string text = std::string(kWhatItIs) +
                       " Look through it before you send it.\n\n"
                       "The folders and names of files are left out of its texts.";
    text += request_.images == BundledImages::kNone
                ? " It holds no images.\n"
                : " It holds images of the recording (images/), which whoever gets it can see.\n";
    for (const std::string& note : summary_.notes) text += "\nnote: " + WithoutImageNames(note);
    if (Status status = Write(kReadMe, text + (summary_.notes.empty() ? "" : "\n")); !status.ok()) return status;
    DeleteBundle(request_.output_path);
    if (Status status = staged_.Commit(); !status.ok()) return status;
    return summary_;
  }

 private:
  Status Write(const std::string& name, const std::string& content) {
    if (Status status = WriteFileAtomically(staged_.Path(name).string(), content); !status.ok()) return status;
    summary_.files.push_back(name);
    summary_.megabytes += static_cast<double>(content.size()) / 1e6;
    return Status::Ok();
  }

  Status AddImages(Sequence& sequence) {
    if (Status status = staged_.AddFolder("images"); !status.ok()) return status;
    const int count = std::max(1, sequence.size());
    int taken = 0;
    for (int i = 0; taken < kMaxBundledImages; ++i) {
      if (Status status = Tell(progress_, "images", i, sequence.size()); !status.ok()) return status;
      auto frame = sequence.Next();
      if (!frame.ok()) {
        summary_.notes.push_back("the images end early: " + WithoutPaths(frame.status().message()));
        break;
      }
      if (!frame->has_value()) break;
      if (static_cast<long long>(i) * kMaxBundledImages < static_cast<long long>(taken) * count) continue;
      if (Status status = Write("images/" + std::to_string((*frame)->frame_idx) + ".jpg", SmallJpeg((*frame)->image));
          !status.ok())
        return status;
      ++taken;
    }
    return Status::Ok();
  }

  const BundleRequest& request_;
  const JobProgress& progress_;
  StagedFolder staged_;
  BundleSummary summary_;
};

}  // namespace

std::string WithoutPaths(const std::string& any_text) {
  const std::string text = WithoutLongLines(any_text);
  // In single quotes; from a / on; with a / and an ending.
  static const std::regex path_pattern(
      R"re('([^'\n]*/[^'\n]*)'|(^|[\s"'=:(,\[])(/[^\s/"',)\]][^\s"',)\]]*|[^\s"'=:(,\[/]+/[^\s"',)\]]*\.[A-Za-z]\w*))re");
  std::string cleaned;
  auto last = text.cbegin();
  for (std::sregex_iterator match(text.begin(), text.end(), path_pattern), end; match != end; ++match) {
    const auto& path = (*match)[1].matched ? (*match)[1] : (*match)[3];
    cleaned.append(last, path.first);
    cleaned += Placeholder(path.str());
    last = path.second;
  }
  return cleaned.append(last, text.cend());
}

Result<BundleSummary> WriteBundle(const BundleRequest& request, const JobProgress& progress) {
  const auto summary_text = ReadFile(request.run_path + "/" + kSummary);
  if (!summary_text.ok()) return summary_text.status();
  const auto run = ReadRunSummary(request.run_path + "/" + kSummary);
  if (!run.ok()) return run.status();
  auto staged = StageBundle(request);
  if (!staged.ok()) return staged.status();
  const std::vector<fs::path> known = KnownPaths(request.run_path, run->description);
  Bundle bundle(request, progress, *std::move(staged));
  if (Status status = bundle.Add(kVersions, VersionsText(request.program_version, run->description)); !status.ok())
    return status;
  if (Status status = bundle.Add(kSummary, CleanedSummary(*summary_text, known)); !status.ok()) return status;
  if (const auto config = ReadFile(request.run_path + "/" + kConfig); config.ok())
    if (Status status = bundle.Add(kConfig, CleanedOptions(*config)); !status.ok()) return status;
  if (Status status = bundle.AddTable("frames.csv", true); !status.ok()) return status;
  if (Status status = bundle.AddTable("trajectory.txt", false); !status.ok()) return status;
  if (Status status = bundle.AddSequence(); !status.ok()) return status;
  return bundle.Finish();
}

}  // namespace pliant
