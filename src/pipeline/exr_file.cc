// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/exr_file.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>

#include "pliant/base/files.h"

namespace pliant {
namespace {

// OpenEXR's name of a depth is Z, but OpenCV and ffmpeg read a single channel by the name of luminance alone, and
// OpenCV gives zeros for others without an error.
constexpr const char* kDepthChannel = "Y";

// A file in memory.
class MemoryStream final : public Imf::OStream {
 public:
  MemoryStream() : OStream("memory") {}

  void write(const char* bytes, int count) override {
    bytes_.replace(at_, static_cast<std::size_t>(count), bytes, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace

Status WriteDepthExr(const std::filesystem::path& path, const cv::Mat& depth) {
  MemoryStream stream;
  try {
    Imf::Header header(depth.cols, depth.rows);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.channels().insert(kDepthChannel, Imf::Channel(Imf::FLOAT));
    Imf::OutputFile file(stream, header);
    Imf::FrameBuffer pixels;
    pixels.insert(kDepthChannel,
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(depth.data), sizeof(float), depth.step[0]));
    file.setFrameBuffer(pixels);
    file.writePixels(depth.rows);
  } catch (const std::exception& error) {
    return {ErrorCode::kUnwritable, "cannot write " + path.string() + ": " + error.what()};
  }
  return WriteFileAtomically(path.string(), stream.bytes());
}

}  // namespace pliant
