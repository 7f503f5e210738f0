#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>

#include "mesh_text.h"

namespace outcrop::meshing {
namespace {

constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50, kNormalBytes = 12;

/// The corners of all triangles, three each, as one mesh: corners of equal coordinates become one vertex.
FileMesh weld(std::vector<Vec3> corners) {
  const auto key = [&](std::uint32_t i) { return std::tie(corners[i].x, corners[i].y, corners[i].z); };
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::vector<std::uint32_t> first(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  // Numbered by first appearance, so that the mesh keeps the file's order.
  FileMesh mesh;
  std::vector<std::uint32_t> number(corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (first[i] != i) continue;
    number[i] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(corners[i]);
  }
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const std::array<std::uint32_t, 3> t = {number[first[i]], number[first[i + 1]], number[first[i + 2]]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return mesh;
}

std::uint32_t little_endian(const char* at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(at[i]);
  return value;
}

FileMesh read_binary(const std::filesystem::path& path, std::string_view bytes, std::uint32_t count) {
  std::vector<Vec3> corners;
  corners.reserve(std::size_t{count} * 3);
  for (std::uint32_t i = 0; i < count; ++i) {
    const char* at = bytes.data() + kHeaderBytes + kTriangleBytes * i + kNormalBytes;
    for (int corner = 0; corner < 3; ++corner) {
      Vec3 p;
      for (int axis = 0; axis < 3; ++axis, at += 4) p[axis] = std::bit_cast<float>(little_endian(at));
      if (!std::isfinite(p.x + p.y + p.z))
        fail(path.string(), "finite coordinates", "none in triangle " + std::to_string(i));
      corners.push_back(p);
    }
  }
  return weld(std::move(corners));
}

FileMesh read_text_form(const std::filesystem::path& path, std::string_view text) {
  TextLines lines(path, text);
  std::vector<Vec3> corners;
  std::size_t in_loop = 0;
  while (lines.next()) {
    const auto& words = lines.words();
    if (words.empty()) continue;
    if (words[0] == "vertex") {
      if (++in_loop > 3) lines.fail("three vertices a facet", "a fourth");
      corners.push_back(lines.vec3(1, "three coordinates after \"vertex\""));
    } else if (words[0] == "endloop" || words[0] == "endfacet") {
      if (in_loop != 3 && words[0] == "endloop") lines.fail("three vertices a facet", std::to_string(in_loop));
      in_loop = 0;
    } else if (words[0] != "solid" && words[0] != "facet" && words[0] != "outer" && words[0] != "endsolid") {
      lines.fail("\"facet\", \"vertex\" or another word of text STL", quoted(words[0]));
    }
  }
  if (in_loop != 0) lines.fail("\"endloop\"", "the end of the file");
  return weld(std::move(corners));
}

}  // namespace

FileMesh read_stl(const std::filesystem::path& path, std::string_view bytes) {
  // Some programs begin binary files with "solid", too: the size decides first.
  if (bytes.size() >= kHeaderBytes) {
    const std::uint32_t count = little_endian(bytes.data() + 80);
    if (bytes.size() == kHeaderBytes + kTriangleBytes * std::size_t{count}) return read_binary(path, bytes, count);
    if (!bytes.starts_with("solid"))
      fail(path.string(),
           std::to_string(count) + " triangles in " +
               std::to_string(kHeaderBytes + kTriangleBytes * std::size_t{count}) + " bytes of binary STL",
           std::to_string(bytes.size()) + " bytes");
  }
  if (!bytes.starts_with("solid")) fail(path.string(), "STL", "a file that is neither its text nor its binary form");
  return read_text_form(path, bytes);
}

}  // namespace outcrop::meshing
