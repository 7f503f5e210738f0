#include "outputs.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <utility>

#include "outcrop/core/file.h"
#include "outcrop/core/image.h"
#include "outcrop/implicit/grid_field.h"
#include "outcrop/implicit/primitives.h"

namespace outcrop {
namespace {

std::string extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

void check_extension(const std::filesystem::path& path, std::string_view option, std::string_view expected,
                     const std::vector<std::string_view>& known) {
  require(std::find(known.begin(), known.end(), extension(path)) != known.end(), option, expected, path.string());
}

}  // namespace

std::vector<std::filesystem::path> Outputs::all() const {
  std::vector<std::filesystem::path> paths = meshes;
  paths.insert(paths.end(), previews.begin(), previews.end());
  if (!report.empty()) paths.push_back(report);
  paths.insert(paths.end(), tile_reports.begin(), tile_reports.end());
  return paths;
}

void check_outputs(const Outputs& outputs, const std::vector<std::filesystem::path>& inputs) {
  for (const auto& path : outputs.meshes)
    check_extension(path, "--output", "a name that ends in .ply, .obj, .stl or .vdb", {".ply", ".obj", ".stl", ".vdb"});
  for (const auto& path : outputs.previews)
    check_extension(path, "--preview", "a name that ends in .png or .exr", {".png", ".exr"});
  for (const auto& path : outputs.tile_reports)
    check_extension(path, "--tile-report", "a name that ends in .html or .json", {".html", ".json"});
  const std::vector<std::filesystem::path> paths = outputs.all();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    check_output_path(paths[i]);
    std::error_code error;
    for (const auto& input : inputs)
      require(!std::filesystem::equivalent(paths[i], input, error), "output", "a file that is not an input",
              paths[i].string());
    for (std::size_t j = 0; j < i; ++j)
      require(std::filesystem::weakly_canonical(paths[i], error) != std::filesystem::weakly_canonical(paths[j], error),
              "output", "a name for each output", paths[i].string() + " twice");
  }
}

void check_size(int width, int height) {
  require(width >= 16 && width <= 16384 && height >= 16 && height <= 16384, "--size", "16 to 16384 pixels each",
          std::to_string(width) + " " + std::to_string(height));
}

bool is_vdb(const std::filesystem::path& path) { return extension(path) == ".vdb"; }

bool wants_triangles(const Outputs& outputs) {
  return std::any_of(outputs.meshes.begin(), outputs.meshes.end(), [](const auto& path) { return !is_vdb(path); });
}

bool wants_level_set(const Outputs& outputs) {
  return std::any_of(outputs.meshes.begin(), outputs.meshes.end(), is_vdb);
}

void write_preview(const std::filesystem::path& path, const Preview& preview) {
  write_image(path, extension(path) == ".exr" ? preview.layers : preview.beauty);
}

void write_level_set(const std::filesystem::path& path, const TriangleMesh& mesh, double voxel, const Task& task) {
  if (mesh.triangles.empty()) {
    const Box outside{Vec3(0.0), Vec3(voxel)};
    write_vdb(path, *sphere(Vec3(2.0 * kVdbBand * voxel), voxel), outside, voxel, Vec3(0.0), kVdbBand, task);
    return;
  }
  std::vector<Vec3> vertices;
  vertices.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) vertices.push_back(mesh.origin + Vec3(p));
  const FieldPtr distance = mesh_distance(vertices, mesh.triangles, voxel, kVdbBand + 1.0, task);
  const Box region = mesh.bounds().grown(kVdbBand * voxel);
  write_vdb(path, *distance, region, voxel, Vec3(0.0), kVdbBand, task);
}

std::size_t memory_limit_bytes(double gib) {
  constexpr double kGib = 1024.0 * 1024.0 * 1024.0;
  if (gib > 0.0 && std::isfinite(gib)) return static_cast<std::size_t>(std::min(gib, 1e6) * kGib);
  require(gib == 0.0, "--memory-limit", "a positive number of GiB", gib);
  const double physical = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  return static_cast<std::size_t>(0.5 * physical);
}

std::string number_text(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string byte_text(double bytes) {
  const char* const units[] = {"bytes", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (; bytes >= 1000.0 && unit + 1 < std::size(units); ++unit) bytes /= 1000.0;
  return number_text(bytes, 3) + " " + units[unit];
}

std::string count_text(double value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.0f", value);
  std::string grouped = text;
  for (std::size_t i = grouped.size(); i > 3; i -= 3) grouped.insert(i - 3, 1, ' ');
  return grouped;
}

}  // namespace outcrop
