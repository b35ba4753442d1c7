// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/vtk.h"

#include <cstddef>
#include <cstdint>
#include <sstream>
#include <utility>

#include <pugixml.hpp>
#include <zlib.h>

#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr const char* kHead =
    "<?xml version=\"1.0\"?>\n"
    "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
    "compressor=\"vtkZLibDataCompressor\">\n";

// An array's bytes as VTK's zlib compressor has them, in one block: how many blocks, the size of a block, that of a
// last one that is smaller (0: none is), the compressed size, and the block.
std::string Compressed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string block(size, '\0');
  compress(reinterpret_cast<Bytef*>(block.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  block.resize(size);
  std::string result;
  for (const std::uint64_t value :
       {std::uint64_t{1}, std::uint64_t{bytes.size()}, std::uint64_t{0}, std::uint64_t{size}})
    AppendBytes(&result, value, 8);
  return result + block;
}

// The two parts of a file: elements that name arrays, and the arrays' bytes.
class AppendedArrays {
 public:
  std::string& elements() { return elements_; }
  const std::string& bytes() const { return bytes_; }

  void Add(const std::string& name, const char* type, int components, const std::string& bytes) {
    elements_ += "<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                 std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(bytes_.size()) +
                 "\"/>\n";
    bytes_ += Compressed(bytes);
  }

  void Add(const VtkArray& array) {
    std::string bytes;
    for (const float value : array.values) AppendFloat(&bytes, value);
    Add(array.name, "Float32", array.components, bytes);
  }

  void Add(const char* name, const std::vector<Eigen::Vector3f>& vectors) {
    std::string bytes;
    for (const Eigen::Vector3f& vector : vectors)
      for (const float coordinate : vector) AppendFloat(&bytes, coordinate);
    Add(name, "Float32", 3, bytes);
  }

 private:
  std::string elements_;
  std::string bytes_;
};

void AddPointData(const Mesh& mesh, std::span<const VtkArray> of_vertices, AppendedArrays* arrays) {
  arrays->elements() += "<PointData>\n";
  if (!mesh.normals.empty()) arrays->Add("Normals", mesh.normals);
  std::string bytes;
  for (const auto& rgb : mesh.rgb)
    for (const std::uint8_t channel : rgb) AppendBytes(&bytes, channel, 1);
  if (!mesh.rgb.empty()) arrays->Add("rgb", "UInt8", 3, bytes);
  if (!mesh.sigmas.empty()) arrays->Add({"sigma", 1, mesh.sigmas});
  bytes.clear();
  for (const std::int32_t id : mesh.ids) AppendBytes(&bytes, static_cast<std::uint32_t>(id), 4);
  if (!mesh.ids.empty()) arrays->Add("vertex", "Int32", 1, bytes);
  for (const VtkArray& array : of_vertices) arrays->Add(array);
  arrays->elements() += "</PointData>\n";
}

void AddTriangles(const Mesh& mesh, AppendedArrays* arrays) {
  std::string connectivity;
  std::string offsets;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::int32_t v : mesh.triangles[t]) AppendBytes(&connectivity, static_cast<std::uint32_t>(v), 4);
    AppendBytes(&offsets, 3 * (t + 1), 4);
  }
  arrays->elements() += "<Polys>\n";
  arrays->Add("connectivity", "Int32", 1, connectivity);
  arrays->Add("offsets", "Int32", 1, offsets);
  arrays->elements() += "</Polys>\n";
}

}  // namespace

Status WriteVtp(const std::string& path, const Mesh& mesh, std::span<const VtkArray> of_vertices,
                std::span<const VtkArray> of_triangles) {
  AppendedArrays arrays;
  AddPointData(mesh, of_vertices, &arrays);
  arrays.elements() += "<CellData>\n";
  for (const VtkArray& array : of_triangles) arrays.Add(array);
  arrays.elements() += "</CellData>\n<Points>\n";
  arrays.Add("Points", mesh.vertices);
  arrays.elements() += "</Points>\n";
  AddTriangles(mesh, &arrays);
  return WriteFileAtomically(path, kHead + std::string("<PolyData>\n<Piece NumberOfPoints=\"") +
                                       std::to_string(mesh.vertices.size()) + "\" NumberOfPolys=\"" +
                                       std::to_string(mesh.triangles.size()) + "\">\n" + arrays.elements() +
                                       "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" + arrays.bytes() +
                                       "\n</AppendedData>\n</VTKFile>\n");
}

Status WritePvd(const std::string& path, std::span<const VtkTime> times) {
  pugi::xml_document document;
  pugi::xml_node file = document.append_child("VTKFile");
  file.append_attribute("type") = "Collection";
  file.append_attribute("version") = "1.0";
  pugi::xml_node collection = file.append_child("Collection");
  for (const VtkTime& time : times) {
    pugi::xml_node entry = collection.append_child("DataSet");
    std::string time_s;
    AppendFixed(&time_s, time.time_s, 6);
    entry.append_attribute("timestep") = time_s.c_str();
    entry.append_attribute("part") = "0";
    entry.append_attribute("file") = time.file.c_str();
  }
  std::ostringstream text;
  document.save(text, "  ");
  return WriteFileAtomically(path, std::move(text).str());
}

}  // namespace pliant
