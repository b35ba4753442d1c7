// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/picture_file.h"

#include <filesystem>

#include <cairo-pdf.h>
#include <cairo-svg.h>

#include "pliant/base/files.h"
#include "viewer/drawing.h"

namespace pliant {
namespace {

// For Cairo: `file` is a std::string.
cairo_status_t AppendBytes(void* file, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(file)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

// What is drawn comes into `file`, of a .png when it is asked for. Cairo's own writing to a file does not tell of a
// disk that is full.
CairoSurface MakeSurface(const std::string& ending, double width, double height, std::string* file) {
  if (ending == ".svg") return CairoSurface(cairo_svg_surface_create_for_stream(AppendBytes, file, width, height));
  if (ending == ".pdf") {
    CairoSurface pdf(cairo_pdf_surface_create_for_stream(AppendBytes, file, width, height));
    cairo_pdf_surface_set_metadata(pdf.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");  // else that of now
    return pdf;
  }
  return CairoSurface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height)));
}

}  // namespace

Status WritePicture(const std::string& output_path, double width, double height,
                    const std::function<Status(cairo_t*)>& draw) {
  const std::string ending = std::filesystem::path(output_path).extension().string();
  std::string file;
  const CairoSurface surface = MakeSurface(ending, width, height, &file);
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return TooLarge(width, height);
  const Drawing drawing(cairo_create(surface.get()));
  cairo_set_source_rgb(drawing.get(), 1, 1, 1);
  cairo_paint(drawing.get());
  if (Status status = draw(drawing.get()); !status.ok()) return status;
  bool complete = cairo_status(drawing.get()) == CAIRO_STATUS_SUCCESS;
  if (ending == ".png")
    complete = complete && cairo_surface_write_to_png_stream(surface.get(), AppendBytes, &file) == CAIRO_STATUS_SUCCESS;
  cairo_surface_finish(surface.get());
  if (!complete || cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return TooLarge(width, height);
  return WriteFileAtomically(output_path, file);
}

}  // namespace pliant
