// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/interlacing.h"

#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr int kMinSide_px = 8;
// Added to either side of the ratio, so that images of one color have none: the noise of rounding.
constexpr double kRounding = 0.01;

// Of CV_32FC1, along its columns.
double Alternation(const cv::Mat& image) {
  const int rows = image.rows;
  const cv::Mat s = image.rowRange(0, rows - 2) - 2.0 * image.rowRange(1, rows - 1) + image.rowRange(2, rows);
  const cv::Mat products = -s.rowRange(0, s.rows - 1).mul(s.rowRange(1, s.rows));
  cv::Mat means;
  cv::reduce(cv::max(products, 0.0), means, 1, cv::REDUCE_AVG);
  return Median(std::vector<double>(means.begin<float>(), means.end<float>()));
}

}  // namespace

double CombRatio(const cv::Mat& image) {
  if (image.rows < kMinSide_px || image.cols < kMinSide_px) return 1.0;
  cv::Mat gray = image;
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::Mat values;
  gray.convertTo(values, CV_32F);
  return std::sqrt((Alternation(values) + kRounding) / (Alternation(values.t()) + kRounding));
}

cv::Mat WithoutOddRows(const cv::Mat& image) {
  cv::Mat even = image.clone();
  for (int y = 1; y < image.rows; y += 2) {
    const cv::Mat above = image.row(y - 1);
    cv::Mat between = even.row(y);
    cv::addWeighted(above, 0.5, y + 1 < image.rows ? image.row(y + 1) : above, 0.5, 0.0, between);
  }
  return even;
}

}  // namespace pliant
