// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The data sets that are known, each with a file of its own: how one is recognized, and how it is opened.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "datasets/data_set.h"

namespace pliant {

struct DataSetFormat {
  std::string_view name;  // as in docs/formats.md
  std::string_view what;  // for people
  bool (*is_at)(const std::filesystem::path& path);
  Result<DataSet> (*open)(const SequenceRequest& request);
  // Of a folder that is not one, but nearly: what would make it one, in words; "" where it is nothing like it.
  std::string (*lacks)(const std::filesystem::path& path) = nullptr;
};

// The images of `request.given`. Fails with kMismatch where their times are not as many.
Result<DataSet> OpenGivenImages(const SequenceRequest& request);

// In the order in which they are asked; the last two, a folder of images and a video, take what no other does.
std::span<const DataSetFormat> DataSetFormats();

// What a folder without images may be meant for, a sentence: a part of a data set, one that lacks a file, or the folder
// of a video. "" where nothing is known.
std::string WhatIsThereInstead(const std::filesystem::path& folder);

bool IsNativeSequence(const std::filesystem::path& path);
Result<DataSet> OpenNativeSequence(const SequenceRequest& request);

bool IsColmapFolder(const std::filesystem::path& path);
Result<DataSet> OpenColmapFolder(const SequenceRequest& request);

bool IsC3vd(const std::filesystem::path& path);
Result<DataSet> OpenC3vd(const SequenceRequest& request);

bool IsEndomapper(const std::filesystem::path& path);
std::string EndomapperLacks(const std::filesystem::path& path);
Result<DataSet> OpenEndomapper(const SequenceRequest& request);

bool IsEndomapperSimulated(const std::filesystem::path& path);
Result<DataSet> OpenEndomapperSimulated(const SequenceRequest& request);

bool IsEndoSlam(const std::filesystem::path& path);
Result<DataSet> OpenEndoSlam(const SequenceRequest& request);

bool IsEuroc(const std::filesystem::path& path);
std::string EurocLacks(const std::filesystem::path& path);
Result<DataSet> OpenEuroc(const SequenceRequest& request);

bool IsHamlynRectified(const std::filesystem::path& path);
std::string HamlynRectifiedLacks(const std::filesystem::path& path);
Result<DataSet> OpenHamlynRectified(const SequenceRequest& request);

bool IsScared(const std::filesystem::path& path);
std::string ScaredLacks(const std::filesystem::path& path);
Result<DataSet> OpenScared(const SequenceRequest& request);

bool IsSimCol(const std::filesystem::path& path);
Result<DataSet> OpenSimCol(const SequenceRequest& request);

bool IsStir(const std::filesystem::path& path);
std::string StirLacks(const std::filesystem::path& path);
Result<DataSet> OpenStir(const SequenceRequest& request);

bool IsStereoMis(const std::filesystem::path& path);
std::string StereoMisLacks(const std::filesystem::path& path);
Result<DataSet> OpenStereoMis(const SequenceRequest& request);

bool IsTumRgbd(const std::filesystem::path& path);
std::string TumRgbdLacks(const std::filesystem::path& path);
Result<DataSet> OpenTumRgbd(const SequenceRequest& request);

bool IsFolder(const std::filesystem::path& path);
Result<DataSet> OpenImageFolder(const SequenceRequest& request);

bool IsFile(const std::filesystem::path& path);
Result<DataSet> OpenVideo(const SequenceRequest& request);

}  // namespace pliant
