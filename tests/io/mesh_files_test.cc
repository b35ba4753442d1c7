// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Meshes as other programs read them: each file is read back by its format's rules, not by our own writer's.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <pugixml.hpp>
#include <tiny_gltf.h>
#include <zlib.h>

#include "pliant/io/gltf.h"
#include "pliant/io/obj.h"
#include "pliant/io/ply.h"
#include "pliant/io/vtk.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::FloatEq;
using testing::HasSubstr;

// A square of two triangles, 20 map units before the camera, which faces it; its texture has a seam.
Mesh Square() {
  Mesh mesh;
  mesh.vertices = {{-5, -5, 20}, {5, -5, 20}, {-5, 5, 20}, {5, 5, 20}};
  mesh.normals.assign(4, -Eigen::Vector3f::UnitZ());
  mesh.rgb = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 9, 9}};
  mesh.sigmas = {0.1F, 0.2F, 0.3F, 0.4F};
  mesh.triangles = {{0, 2, 1}, {2, 3, 1}};
  mesh.texture_uvs = {{Eigen::Vector2f(0, 0), Eigen::Vector2f(0, 0.5F), Eigen::Vector2f(0.5F, 0)},
                      {Eigen::Vector2f(0.5F, 1), Eigen::Vector2f(1, 1), Eigen::Vector2f(1, 0.5F)}};
  return mesh;
}

std::string JpegOf(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes);
  return {bytes.begin(), bytes.end()};
}

std::vector<float> FloatsOf(const tinygltf::Model& model, int accessor) {
  const auto& entry = model.accessors[static_cast<std::size_t>(accessor)];
  const auto& view = model.bufferViews[static_cast<std::size_t>(entry.bufferView)];
  std::vector<float> values(view.byteLength / sizeof(float));
  std::memcpy(values.data(), model.buffers[0].data.data() + view.byteOffset, view.byteLength);
  return values;
}

class MeshFilesTest : public testing::Test {
 protected:
  tinygltf::Model WriteAndRead(const MeshAnimation& animation) const {
    const Status status = WriteGlb(folder_.Path("a.glb"), animation);
    EXPECT_TRUE(status.ok()) << status.message();
    tinygltf::Model model;
    std::string error;
    std::string warning;
    EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, folder_.Path("a.glb")))
        << error << warning;
    return model;
  }

  TestFolder folder_;
  Mesh mesh_ = Square();
  std::string texture_ = JpegOf(cv::Mat(8, 8, CV_8UC3, cv::Scalar(10, 20, 200)));
  std::vector<MeshKey> keys_ = {{4, 2.0, mesh_.vertices},
                                {9, 3.0, {{-5, -5, 21}, {5, -5, 21}, {-5, 5, 21}, {5, 5, 21}}}};
  std::vector<CameraKey> path_ = {{2.0, {}}, {3.0, {RotationExp({0, 0.5, 0}), Eigen::Vector3d(1, 2, 3)}}};
  Camera camera_ = Camera::Create(CameraModelId::kPinhole, 640, 480, std::array{400.0, 400.0, 319.5, 239.5}).value();
};

TEST_F(MeshFilesTest, GltfIsInMetersAndYIsUp) {
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3});
  ASSERT_EQ(model.meshes.size(), 1U);
  const tinygltf::Primitive& primitive = model.meshes[0].primitives[0];
  const std::vector<float> positions = FloatsOf(model, primitive.attributes.at("POSITION"));
  EXPECT_EQ(positions.size(), 3U * 6U);  // two vertices are on the seam
  EXPECT_FLOAT_EQ(positions[0], -0.005F);
  EXPECT_FLOAT_EQ(positions[1], 0.005F);
  EXPECT_FLOAT_EQ(positions[2], -0.020F);
  const std::vector<float> normals = FloatsOf(model, primitive.attributes.at("NORMAL"));
  EXPECT_FLOAT_EQ(normals[2], 1.0F);  // towards the camera, which looks along -z
  const std::vector<float> moved = FloatsOf(model, primitive.targets[1].at("POSITION"));
  EXPECT_NEAR(moved[2], -0.001F, 1e-8);  // by one millimeter away from it
}

TEST_F(MeshFilesTest, GltfPlaysTheKeysOneAfterTheOther) {
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3});
  ASSERT_EQ(model.animations.size(), 1U);
  const tinygltf::Animation& animation = model.animations[0];
  EXPECT_EQ(animation.channels[0].target_path, "weights");
  EXPECT_THAT(FloatsOf(model, animation.samplers[0].input), ElementsAre(0, 1));
  EXPECT_THAT(FloatsOf(model, animation.samplers[0].output), ElementsAre(1, 0, 0, 1));
  EXPECT_THAT(model.meshes[0].weights, ElementsAre(1, 0));
}

// Tracking is lost behind frame 6 until frame 9, and between two keys until frame 19.
TEST_F(MeshFilesTest, GltfHoldsTheLastValueThroughAGap) {
  keys_.push_back({24, 6.0, mesh_.vertices});
  path_ = {{2.0, {}}, {2.4, {}}, {3.0, {RotationExp({0, 0.5, 0}), Eigen::Vector3d(1, 2, 3)}}, {6.0, {}}};
  const std::vector<MotionGap> gaps = {{6, 9, 2.4, 2.8, 3.0}, {12, 19, 3.6, 4.8, 5.0}};
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3, gaps});
  const auto& samplers = model.animations[0].samplers;
  const testing::Matcher<std::vector<float>> times = ElementsAre(0, FloatEq(0.8F), 1, FloatEq(2.8F), 3, 4);
  EXPECT_THAT(FloatsOf(model, samplers[0].input), times);
  EXPECT_THAT(FloatsOf(model, samplers[0].output), ElementsAre(1, 0, 0,  //
                                                               1, 0, 0,  //
                                                               0, 1, 0,  //
                                                               0, 1, 0,  //
                                                               0, 0, 1,  //
                                                               0, 0, 1));
  EXPECT_THAT(FloatsOf(model, samplers[1].input), ElementsAre(0, FloatEq(0.4F), FloatEq(0.8F), 1, FloatEq(2.8F), 3, 4));
  const std::vector<float> at = FloatsOf(model, samplers[1].output);
  for (const std::size_t row : {1U, 2U, 5U, 6U}) EXPECT_EQ(at[3 * row], 0.0F) << row;
  for (const std::size_t row : {3U, 4U}) EXPECT_FLOAT_EQ(at[3 * row], 0.001F) << row;
}

// A recording that began long ago: its times are as near to each other as floats can be.
TEST_F(MeshFilesTest, GltfsTimesIncreaseThroughAGap) {
  keys_ = {{0, 0.0, mesh_.vertices}, {4, 1e6, mesh_.vertices}, {9, 1e6 + 0.1, mesh_.vertices}};
  const std::vector<MotionGap> gaps = {{4, 9, 1e6, 1e6 + 0.02, 1e6 + 0.1}};
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, {}, camera_, 3, gaps});
  const std::vector<float> times = FloatsOf(model, model.animations[0].samplers[0].input);
  EXPECT_EQ(std::ranges::adjacent_find(times, std::ranges::greater_equal()), times.end())
      << testing::PrintToString(times);
}

TEST_F(MeshFilesTest, GltfsGapsComeBack) {
  const std::vector<MotionGap> gaps = {{4, 9, 2.0, 2.8, 3.0}};
  ASSERT_TRUE(WriteGlb(folder_.Path("a.glb"), {mesh_, texture_, keys_, path_, camera_, 3, gaps}).ok());
  const auto read = ReadGlb(folder_.Path("a.glb"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->gaps.size(), 1U);
  EXPECT_EQ(read->gaps[0].last_frame_idx, 4);
  EXPECT_EQ(read->gaps[0].next_frame_idx, 9);
  EXPECT_NEAR(read->gaps[0].last_time_s, 0.0, 1e-9);
  EXPECT_NEAR(read->gaps[0].held_until_s, 0.8, 1e-9);
  EXPECT_NEAR(read->gaps[0].next_time_s, 1.0, 1e-9);
  EXPECT_EQ(read->keys[1].time_s, 1.0);
}

TEST_F(MeshFilesTest, GltfsCameraLooksAtWhatOursDoes) {
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3});
  EXPECT_NEAR(model.cameras[0].perspective.yfov, 2 * std::atan(240.0 / 400.0), 1e-9);
  EXPECT_NEAR(model.cameras[0].perspective.aspectRatio, 4.0 / 3.0, 1e-9);
  const tinygltf::Animation& animation = model.animations[0];
  const std::vector<float> at = FloatsOf(model, animation.samplers[1].output);
  const std::vector<float> turned = FloatsOf(model, animation.samplers[2].output);
  const Eigen::Vector3f center(at[3], at[4], at[5]);
  const Eigen::Quaternionf rotation(turned[7], turned[4], turned[5], turned[6]);
  // A point on our optical axis at 10 mm is on that of glTF's camera, its -z, at 10 mm.
  const Eigen::Vector3d ours = path_[1].world_from_cam * Eigen::Vector3d(0, 0, 10);
  const Eigen::Vector3f theirs = center + rotation * Eigen::Vector3f(0, 0, -0.01F);
  EXPECT_TRUE(theirs.isApprox(0.001F * Eigen::Vector3d(ours.x(), -ours.y(), -ours.z()).cast<float>(), 1e-5F));
}

TEST_F(MeshFilesTest, GltfsCameraShowsTheWholeImageOfAnyLens) {
  const auto view_of = [&](CameraModelId model, const std::vector<double>& params) {
    const Camera camera = Camera::Create(model, 640, 480, params).value();
    const tinygltf::PerspectiveCamera view =
        WriteAndRead({mesh_, texture_, keys_, path_, camera, 3}).cameras[0].perspective;
    const double half_height = std::tan(0.5 * view.yfov);
    return Eigen::Vector2d(view.aspectRatio * half_height, half_height);
  };
  // To the border that is farther from the principal point.
  const Eigen::Vector2d aside = view_of(CameraModelId::kPinhole, {400, 400, 349.5, 199.5});
  EXPECT_TRUE(aside.isApprox(Eigen::Vector2d(350.0 / 400.0, 280.0 / 400.0), 1e-9)) << aside.transpose();
  // Equidistant: the corners are 400 px from the middle, of which 320 are to the side.
  const Eigen::Vector2d wide = view_of(CameraModelId::kOpenCvFisheye, {400, 400, 319.5, 239.5, 0, 0, 0, 0});
  EXPECT_TRUE(wide.isApprox(std::tan(1.0) * Eigen::Vector2d(0.8, 0.6), 1e-6)) << wide.transpose();
  // The corners are behind the camera.
  const Eigen::Vector2d widest = view_of(CameraModelId::kOpenCvFisheye, {200, 200, 319.5, 239.5, 0, 0, 0, 0});
  EXPECT_TRUE(widest.isApproxToConstant(std::tan(75.0 * std::numbers::pi / 180.0), 1e-9)) << widest.transpose();
}

TEST_F(MeshFilesTest, GltfsCameraHasTheIntrinsics) {
  const tinygltf::Value intrinsics = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3}).cameras[0].extras;
  ASSERT_TRUE(intrinsics.IsObject());
  EXPECT_EQ(intrinsics.Get("model").Get<std::string>(), "PINHOLE");
  EXPECT_EQ(intrinsics.Get("width").GetNumberAsInt(), 640);
  EXPECT_EQ(intrinsics.Get("height").GetNumberAsInt(), 480);
  ASSERT_EQ(intrinsics.Get("params").ArrayLen(), 4U);
  EXPECT_EQ(intrinsics.Get("params").Get(2).GetNumberAsDouble(), 319.5);
}

TEST_F(MeshFilesTest, GltfHasTheTextureInside) {
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3});
  ASSERT_EQ(model.images.size(), 1U);
  EXPECT_EQ(model.images[0].width, 8);
  EXPECT_NEAR(model.images[0].image[0], 200, 6);  // RGB
  const std::vector<float> uvs = FloatsOf(model, model.meshes[0].primitives[0].attributes.at("TEXCOORD_0"));
  EXPECT_EQ(uvs.size(), 2U * 6U);
  EXPECT_FLOAT_EQ(uvs[3], 0.5F);
}

TEST_F(MeshFilesTest, GltfsTextureIsShownAsItWasRecorded) {
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3});
  EXPECT_THAT(model.extensionsUsed, ElementsAre("KHR_materials_unlit"));
  EXPECT_THAT(model.extensionsRequired, testing::IsEmpty());  // a program that does not know it shows the mesh, too
  ASSERT_EQ(model.materials.size(), 1U);
  EXPECT_TRUE(model.materials[0].extensions.contains("KHR_materials_unlit"));
}

TEST_F(MeshFilesTest, GltfWithoutTextureHasColorsAndWithoutKeysIsStill) {
  const tinygltf::Model model = WriteAndRead({mesh_, "", {}, {}, camera_, 0});
  EXPECT_TRUE(model.images.empty());
  EXPECT_TRUE(model.animations.empty());
  const std::vector<float> colors = FloatsOf(model, model.meshes[0].primitives[0].attributes.at("COLOR_0"));
  EXPECT_FLOAT_EQ(colors[0], 1.0F);
  EXPECT_FLOAT_EQ(colors[1], 0.0F);
}

TEST_F(MeshFilesTest, GltfNeedsTriangles) {
  mesh_.triangles.clear();
  const Status status = WriteGlb(folder_.Path("a.glb"), {mesh_, texture_, keys_, path_, camera_, 3});
  EXPECT_EQ(status.code(), ErrorCode::kInsufficient);
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("a.glb")));
}

TEST_F(MeshFilesTest, GltfIsTheSameTwice) {
  ASSERT_TRUE(WriteGlb(folder_.Path("a.glb"), {mesh_, texture_, keys_, path_, camera_, 3}).ok());
  ASSERT_TRUE(WriteGlb(folder_.Path("b.glb"), {mesh_, texture_, keys_, path_, camera_, 3}).ok());
  EXPECT_EQ(folder_.Read("a.glb"), folder_.Read("b.glb"));
}

TEST_F(MeshFilesTest, GltfComesBack) {
  ASSERT_TRUE(WriteGlb(folder_.Path("a.glb"), {mesh_, texture_, keys_, path_, camera_, 3}).ok());
  const auto read = ReadGlb(folder_.Path("a.glb"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->mesh.triangles.size(), 2U);
  ASSERT_EQ(read->mesh.vertices.size(), 6U);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto here = static_cast<std::size_t>(mesh_.triangles[t][k]);
      const auto there = static_cast<std::size_t>(read->mesh.triangles[t][k]);
      EXPECT_TRUE(read->mesh.vertices[there].isApprox(mesh_.vertices[here], 1e-5F));
      EXPECT_TRUE(read->mesh.normals[there].isApprox(mesh_.normals[here]));
      EXPECT_FLOAT_EQ(read->mesh.sigmas[there], mesh_.sigmas[here]);
      EXPECT_EQ(read->mesh.texture_uvs[t][k], mesh_.texture_uvs[t][k]);
      EXPECT_TRUE(read->keys[1].positions[there].isApprox(keys_[1].positions[here], 1e-5F));
    }
  ASSERT_EQ(read->keys.size(), 2U);
  EXPECT_EQ(read->keys[0].frame_idx, 4);
  EXPECT_EQ(read->keys[1].frame_idx, 9);
  EXPECT_EQ(read->keys[1].time_s, 1.0);
  EXPECT_EQ(read->submap, 3);
  EXPECT_EQ(read->texture_jpeg, texture_);
}

TEST_F(MeshFilesTest, GltfHasSigmasInMetersAsPositions) {
  const tinygltf::Model model = WriteAndRead({mesh_, texture_, keys_, path_, camera_, 3});
  const std::vector<float> sigmas = FloatsOf(model, model.meshes[0].primitives[0].attributes.at("_SIGMA"));
  EXPECT_FLOAT_EQ(*std::ranges::max_element(sigmas), 0.001F * *std::ranges::max_element(mesh_.sigmas));
}

TEST_F(MeshFilesTest, GltfOfAnEarlierVersionHasSigmasInMapUnits) {
  ASSERT_TRUE(WriteGlb(folder_.Path("a.glb"), {mesh_, texture_, keys_, path_, camera_, 3}).ok());
  std::string earlier = folder_.Read("a.glb");
  const std::string field = "\"sigma_unit\"";
  ASSERT_NE(earlier.find(field), std::string::npos);
  earlier.replace(earlier.find(field), field.size(), "\"other_unit\"");
  folder_.Write("earlier.glb", earlier);
  const auto now = ReadGlb(folder_.Path("a.glb"));
  const auto then = ReadGlb(folder_.Path("earlier.glb"));
  ASSERT_TRUE(now.ok() && then.ok());
  ASSERT_EQ(now->mesh.sigmas.size(), then->mesh.sigmas.size());
  for (std::size_t v = 0; v < now->mesh.sigmas.size(); ++v)
    EXPECT_FLOAT_EQ(then->mesh.sigmas[v], 0.001F * now->mesh.sigmas[v]);
}

TEST_F(MeshFilesTest, GltfThatIsDamagedOrAnothersIsRefused) {
  ASSERT_TRUE(WriteGlb(folder_.Path("a.glb"), {mesh_, texture_, keys_, path_, camera_, 3}).ok());
  const std::string whole = folder_.Read("a.glb");
  EXPECT_EQ(ReadGlb(folder_.Path("no.glb")).status().code(), ErrorCode::kNotFound);
  for (std::size_t size : {std::size_t{0}, std::size_t{19}, whole.size() / 2, whole.size() - 1}) {
    folder_.Write("cut.glb", whole.substr(0, size));
    EXPECT_EQ(ReadGlb(folder_.Path("cut.glb")).status().code(), ErrorCode::kUnreadable) << size;
  }
  for (const auto& [what, instead] :
       {std::pair("Pliant", "Client"), std::pair("\"_SIGMA\"", "\"_SOGMA\""), std::pair("\"frames\"", "\"phrase\""),
        std::pair("\"POSITION\"", "\"POSITRON\""), std::pair("\"indices\":0", "\"indices\":9")}) {
    std::string other = whole;
    ASSERT_NE(other.find(what), std::string::npos) << what;
    other.replace(other.find(what), std::strlen(what), instead);
    folder_.Write("other.glb", other);
    EXPECT_EQ(ReadGlb(folder_.Path("other.glb")).status().code(), ErrorCode::kUnreadable) << what;
  }
}

// The values of an array of a .vtp file.
template <class T>
std::vector<T> VtpArray(const std::string& file, const char* name) {
  const std::string head = file.substr(0, file.find("<AppendedData"));
  const std::size_t data = file.find('_', file.find("<AppendedData")) + 1;
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string((head + "</VTKFile>").c_str()));
  const pugi::xml_node array = document.select_node(("//DataArray[@Name='" + std::string(name) + "']").c_str()).node();
  const std::size_t offset = data + array.attribute("offset").as_ullong();
  std::array<std::uint64_t, 4> head_of_block{};  // blocks, size, size of the last, compressed size
  std::memcpy(head_of_block.data(), file.data() + offset, sizeof(head_of_block));
  EXPECT_EQ(head_of_block[0], 1U);
  std::vector<T> values(head_of_block[1] / sizeof(T));
  uLongf size = head_of_block[1];
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(values.data()), &size,
                       reinterpret_cast<const Bytef*>(file.data() + offset + sizeof(head_of_block)), head_of_block[3]),
            Z_OK);
  return values;
}

TEST_F(MeshFilesTest, VtpHasTheMeshAndItsArrays) {
  const std::vector<VtkArray> of_vertices = {{"displacement", 3, std::vector<float>(12, 2.5F)}};
  const std::vector<VtkArray> of_triangles = {{"area_change", 1, {0.25F, -0.5F}}};
  ASSERT_TRUE(WriteVtp(folder_.Path("a.vtp"), mesh_, of_vertices, of_triangles).ok());
  const std::string file = folder_.Read("a.vtp");
  EXPECT_THAT(file, HasSubstr("NumberOfPoints=\"4\" NumberOfPolys=\"2\""));
  EXPECT_THAT(VtpArray<std::int32_t>(file, "connectivity"), ElementsAre(0, 2, 1, 2, 3, 1));
  EXPECT_THAT(VtpArray<std::int32_t>(file, "offsets"), ElementsAre(3, 6));
  EXPECT_EQ(VtpArray<float>(file, "Points")[11], 20.0F);
  EXPECT_THAT(VtpArray<float>(file, "area_change"), ElementsAre(0.25F, -0.5F));
  EXPECT_EQ(VtpArray<float>(file, "displacement").size(), 12U);
  EXPECT_THAT(VtpArray<float>(file, "sigma"), ElementsAre(0.1F, 0.2F, 0.3F, 0.4F));
  EXPECT_EQ(VtpArray<std::uint8_t>(file, "rgb")[4], 255);
}

TEST_F(MeshFilesTest, PvdSaysWhichFileIsWhen) {
  ASSERT_TRUE(WritePvd(folder_.Path("a.pvd"), std::vector<VtkTime>{{0.04, "vtp/a & b.vtp"}, {1.5, "vtp/c.vtp"}}).ok());
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(folder_.Read("a.pvd").c_str()));
  const auto sets = document.select_nodes("/VTKFile[@type='Collection']/Collection/DataSet");
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_STREQ(sets[0].node().attribute("file").value(), "vtp/a & b.vtp");
  EXPECT_DOUBLE_EQ(sets[0].node().attribute("timestep").as_double(), 0.04);
  EXPECT_DOUBLE_EQ(sets[1].node().attribute("timestep").as_double(), 1.5);
}

TEST_F(MeshFilesTest, ObjHasTheTextureFromBelow) {
  ASSERT_TRUE(WriteObj(folder_.Path("a.obj"), mesh_, "a.mtl").ok());
  const std::string text = folder_.Read("a.obj");
  EXPECT_THAT(text, HasSubstr("mtllib a.mtl\nusemtl tissue\n"));
  EXPECT_THAT(text, HasSubstr("v -5.000000 -5.000000 20.000000\n"));
  EXPECT_THAT(text, HasSubstr("vt 0.000000 0.500000\n"));
  EXPECT_THAT(text, HasSubstr("f 1/1/1 3/2/3 2/3/2\nf 3/4/3 4/5/4 2/6/2\n"));
  ASSERT_TRUE(WriteObjMaterial(folder_.Path("a.mtl"), "a.jpg").ok());
  EXPECT_THAT(folder_.Read("a.mtl"), HasSubstr("newmtl tissue"));
  EXPECT_THAT(folder_.Read("a.mtl"), HasSubstr("map_Kd a.jpg"));
}

TEST_F(MeshFilesTest, ObjWithoutTextureHasColors) {
  mesh_.texture_uvs.clear();
  ASSERT_TRUE(WriteObj(folder_.Path("a.obj"), mesh_, "").ok());
  EXPECT_THAT(folder_.Read("a.obj"), HasSubstr("v 5.000000 -5.000000 20.000000 0.000000 1.000000 0.000000\n"));
  EXPECT_THAT(folder_.Read("a.obj"), HasSubstr("f 1//1 3//3 2//2\n"));
}

TEST_F(MeshFilesTest, PlyHasTheVerticesIds) {
  mesh_.ids = {7, 8, 9, 300};
  ASSERT_TRUE(WritePly(folder_.Path("a.ply"), mesh_).ok());
  const std::string text = folder_.Read("a.ply");
  EXPECT_THAT(text, HasSubstr("property float sigma\nproperty int vertex\nelement face 2\n"));
  // 31 bytes a vertex before its id.
  std::int32_t id = 0;
  std::memcpy(&id, text.data() + text.find("end_header\n") + 11 + 3 * 35 + 31, sizeof(id));
  EXPECT_EQ(id, 300);
}

TEST_F(MeshFilesTest, PlysVerticesComeBackWithTheirSigmas) {
  ASSERT_TRUE(WritePly(folder_.Path("square.ply"), Square()).ok());
  const auto vertices = ReadPlyVertices(folder_.Path("square.ply"));
  ASSERT_TRUE(vertices.ok()) << vertices.status().message();
  EXPECT_EQ(vertices->positions[3], Eigen::Vector3d(5, 5, 20));
  EXPECT_EQ(vertices->sigmas, (std::vector<double>{0.1F, 0.2F, 0.3F, 0.4F}));

  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const auto bare = ReadPlyVertices(folder_.Write("bare.ply", header + "end_header\n1 2 3\n"));
  ASSERT_TRUE(bare.ok()) << bare.status().message();
  EXPECT_TRUE(bare->sigmas.empty());
  const auto ascii =
      ReadPlyVertices(folder_.Write("ascii.ply", header + "property float sigma\nend_header\n1 2 3 0.5\n"));
  ASSERT_TRUE(ascii.ok()) << ascii.status().message();
  EXPECT_THAT(ascii->sigmas, ElementsAre(0.5));
  EXPECT_FALSE(ReadPlyVertices(folder_.Write("other.ply", "solid\n")).ok());
}

TEST_F(MeshFilesTest, PlyHasTheVerticesViews) {
  mesh_.ids = {7, 8, 9, 300};
  mesh_.views = {1, 2, 1, 2};
  ASSERT_TRUE(WritePly(folder_.Path("a.ply"), mesh_).ok());
  const std::string text = folder_.Read("a.ply");
  EXPECT_THAT(text, HasSubstr("property int vertex\nproperty uchar view\nelement face 2\n"));
  // 35 bytes a vertex before its view.
  for (std::size_t v = 0; v < 4; ++v)
    EXPECT_EQ(text[text.find("end_header\n") + 11 + 36 * v + 35], static_cast<char>(mesh_.views[v])) << v;
}

TEST_F(MeshFilesTest, WhatCannotBeWrittenIsSaid) {
  const std::string nowhere = folder_.Path("nowhere/a");
  EXPECT_EQ(WriteGlb(nowhere, {mesh_, texture_, keys_, path_, camera_, 3}).code(), ErrorCode::kUnwritable);
  EXPECT_EQ(WriteVtp(nowhere, mesh_, {}, {}).code(), ErrorCode::kUnwritable);
  EXPECT_EQ(WritePvd(nowhere, {}).code(), ErrorCode::kUnwritable);
  EXPECT_EQ(WriteObj(nowhere, mesh_, "").code(), ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace pliant
