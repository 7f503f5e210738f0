#include "outcrop/mesh/write_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "mesh_text.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"

namespace outcrop {
namespace {

constexpr std::size_t kFlushBytes = 1 << 18;

/// Numbers as little-endian bytes or as text, gathered into large writes.
class Stream {
 public:
  Stream(OutputFile& file, const Task& task) : file_(file), task_(task) { buffer_.reserve(kFlushBytes + 4096); }

  template <class T>
  Stream& raw(T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    buffer_.append(bytes.data(), bytes.size());
    return *this;
  }
  Stream& raw(const Vec3f& v) { return raw(v.x).raw(v.y).raw(v.z); }
  Stream& text(std::string_view text) {
    buffer_.append(text);
    return *this;
  }
  /// The shortest digits that read back the same.
  template <class T>
  Stream& number(T value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    buffer_.append(digits.data(), end);
    return *this;
  }
  Stream& numbers(std::string_view keyword, const Vec3f& v) {
    return text(keyword).number(v.x).text(" ").number(v.y).text(" ").number(v.z).text("\n");
  }
  /// One vertex or triangle is complete.
  void item() {
    ++items_;
    if (buffer_.size() >= kFlushBytes) flush();
  }
  void flush() {
    task_.check();
    file_.write(buffer_);
    buffer_.clear();
    task_.advance(items_);
    items_ = 0;
  }

 private:
  OutputFile& file_;
  const Task& task_;
  std::string buffer_;
  std::size_t items_ = 0;
};

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

std::string material_name(const MeshMetadata& metadata, Label label) {
  return label < metadata.material_names.size() ? metadata.material_names[label] : "material" + std::to_string(label);
}

/// IEC 61966-2-1.
std::uint8_t srgb_byte(float linear) {
  const float v = std::clamp(linear, 0.0f, 1.0f);
  const float encoded = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * encoded));
}

void write_ply(Stream& out, const TriangleMesh& mesh, const MeshMetadata& metadata) {
  const bool normals = !mesh.normals.empty(), labels = !mesh.labels.empty();
  const bool colours = labels && !metadata.material_colours.empty();
  const bool wide = labels && *std::max_element(mesh.labels.begin(), mesh.labels.end()) > 255;
  out.text("ply\nformat binary_little_endian 1.0\n");
  for (const std::string& comment : metadata.comments) out.text("comment ").text(one_line(comment)).text("\n");
  for (std::size_t i = 0; labels && i < metadata.material_names.size(); ++i)
    out.text("comment material ").number(i).text(" ").text(one_line(metadata.material_names[i])).text("\n");
  out.text("element vertex ")
      .number(mesh.positions.size())
      .text("\nproperty float x\nproperty float y\nproperty float z\n");
  if (normals) out.text("property float nx\nproperty float ny\nproperty float nz\n");
  if (colours) out.text("property uchar red\nproperty uchar green\nproperty uchar blue\n");
  if (labels) out.text(wide ? "property ushort material\n" : "property uchar material\n");
  out.text("element face ")
      .number(mesh.triangles.size())
      .text("\nproperty list uchar uint vertex_indices\nend_header\n");

  std::vector<std::array<std::uint8_t, 3>> colour_bytes;
  for (const Vec3f& c : metadata.material_colours)
    colour_bytes.push_back({srgb_byte(c.x), srgb_byte(c.y), srgb_byte(c.z)});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    out.raw(mesh.positions[v]);
    if (normals) out.raw(mesh.normals[v]);
    if (colours) {
      constexpr std::array<std::uint8_t, 3> kNobodysColour = {128, 128, 128};
      const auto& c = mesh.labels[v] < colour_bytes.size() ? colour_bytes[mesh.labels[v]] : kNobodysColour;
      out.raw(c[0]).raw(c[1]).raw(c[2]);
    }
    if (wide) {
      out.raw(static_cast<std::uint16_t>(mesh.labels[v]));
    } else if (labels) {
      out.raw(static_cast<std::uint8_t>(mesh.labels[v]));
    }
    out.item();
  }
  for (const auto& t : mesh.triangles) {
    out.raw(std::uint8_t{3}).raw(t[0]).raw(t[1]).raw(t[2]);
    out.item();
  }
}

/// The label that most corners of the triangle have.
Label triangle_label(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Label a = mesh.labels[t[0]], b = mesh.labels[t[1]], c = mesh.labels[t[2]];
  return b == c ? b : a;
}

void write_obj(Stream& out, const TriangleMesh& mesh, const MeshMetadata& metadata) {
  for (const std::string& comment : metadata.comments) out.text("# ").text(one_line(comment)).text("\n");
  for (const Vec3f& p : mesh.positions) {
    out.numbers("v ", p);
    out.item();
  }
  for (const Vec3f& n : mesh.normals) out.numbers("vn ", n);

  const auto write_face = [&](const std::array<std::uint32_t, 3>& t) {
    out.text("f");
    for (const std::uint32_t v : t) {
      const std::uint64_t one_based = std::uint64_t{v} + 1;
      out.text(" ").number(one_based);
      if (!mesh.normals.empty()) out.text("//").number(one_based);
    }
    out.text("\n");
    out.item();
  };
  if (mesh.labels.empty()) {
    for (const auto& t : mesh.triangles) write_face(t);
    return;
  }
  // Triangles of one material together: a stable counting sort by label.
  const std::size_t materials = std::size_t{*std::max_element(mesh.labels.begin(), mesh.labels.end())} + 1;
  std::vector<std::size_t> next(materials + 1, 0);
  for (const auto& t : mesh.triangles) ++next[triangle_label(mesh, t) + 1];
  for (std::size_t m = 0; m < materials; ++m) next[m + 1] += next[m];
  std::vector<std::uint64_t> order(mesh.triangles.size());
  for (std::uint64_t i = 0; i < order.size(); ++i) order[next[triangle_label(mesh, mesh.triangles[i])]++] = i;
  int current = -1;
  for (const std::uint64_t i : order) {
    const Label label = triangle_label(mesh, mesh.triangles[i]);
    if (label != current) {
      std::string name = one_line(material_name(metadata, label));
      std::replace(name.begin(), name.end(), ' ', '_');
      out.text("usemtl ").text(name).text("\n");
      current = label;
    }
    write_face(mesh.triangles[i]);
  }
}

void write_stl(Stream& out, const TriangleMesh& mesh, const MeshMetadata& metadata) {
  require(mesh.triangles.size() <= std::numeric_limits<std::uint32_t>::max(), "triangles",
          "at most 2^32 - 1 in an .stl file", static_cast<double>(mesh.triangles.size()));
  // Readers take a header that begins with "solid" for the text form.
  constexpr std::size_t kHeaderBytes = 80;
  std::string header = "binary STL, metres";
  for (const std::string& comment : metadata.comments) header += "; " + one_line(comment);
  header.resize(kHeaderBytes, ' ');
  out.text(header).raw(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Vec3f &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3 normal = glm::cross(Vec3(b) - Vec3(a), Vec3(c) - Vec3(a));
    const double length = glm::length(normal);
    out.raw(length > 0.0 ? Vec3f(normal / length) : Vec3f(0.0f)).raw(a).raw(b).raw(c).raw(std::uint16_t{0});
    out.item();
  }
}

}  // namespace

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, const MeshMetadata& metadata,
                const Task& task) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const bool ply = extension == ".ply", obj = extension == ".obj", stl = extension == ".stl";
  require(ply || obj || stl, "mesh file", "a name that ends in .ply, .obj or .stl",
          meshing::quoted(path.filename().string()));

  OutputFile file(path);
  task.begin("writing " + path.filename().string(), (stl ? 0 : mesh.positions.size()) + mesh.triangles.size());
  Stream out(file, task);
  if (ply) write_ply(out, mesh, metadata);
  if (obj) write_obj(out, mesh, metadata);
  if (stl) write_stl(out, mesh, metadata);
  out.flush();
  file.commit();
}

}  // namespace outcrop
