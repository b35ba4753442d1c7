# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Everything Pliant links. The installed package includes this file too, so both find the same libraries.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs videoio video features2d calib3d
             OPTIONAL_COMPONENTS aruco)
find_package(Ceres 2.1 REQUIRED)
find_package(opengv CONFIG REQUIRED)
find_package(flann CONFIG REQUIRED)
find_library(PLIANT_LZ4_LIBRARY lz4 REQUIRED)
find_package(hwy CONFIG REQUIRED)
find_package(TBB CONFIG REQUIRED)
find_package(embree 3 CONFIG REQUIRED)
find_package(assimp CONFIG REQUIRED)
find_package(yaml-cpp CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(pugixml CONFIG REQUIRED)
find_package(TinyGLTF CONFIG REQUIRED)
find_package(OpenEXR 3 CONFIG REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)
