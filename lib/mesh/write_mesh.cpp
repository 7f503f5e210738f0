#include "outcrop/mesh/write_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "mesh_text.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/mesh/mesh_measure.h"
#include "spool.h"

namespace outcrop {
namespace {

using meshing::Spool;
using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t kFlushBytes = 1 << 18;

/// Numbers as little-endian bytes or as text.
class Bytes {
 public:
  template <class T>
  Bytes& raw(T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    buffer_.append(bytes.data(), bytes.size());
    return *this;
  }
  Bytes& raw(const Vec3f& v) { return raw(v.x).raw(v.y).raw(v.z); }
  Bytes& text(std::string_view text) {
    buffer_.append(text);
    return *this;
  }
  /// The shortest digits that read back the same.
  template <class T>
  Bytes& number(T value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    buffer_.append(digits.data(), end);
    return *this;
  }
  Bytes& numbers(std::string_view keyword, const Vec3f& v) {
    return text(keyword).number(v.x).text(" ").number(v.y).text(" ").number(v.z).text("\n");
  }
  [[nodiscard]] bool full() const noexcept { return buffer_.size() >= kFlushBytes; }
  [[nodiscard]] std::string_view view() const noexcept { return buffer_; }
  void clear() noexcept { buffer_.clear(); }

 private:
  std::string buffer_;
};

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

/// IEC 61966-2-1.
std::uint8_t srgb_byte(float linear) {
  const float v = std::clamp(linear, 0.0f, 1.0f);
  const float encoded = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255.0f * encoded));
}

/// The parts of a file that come one after another: the first is written as it comes, the others wait until those
/// before them are whole.
class Writer : public MeshSink {
 public:
  Writer(const std::filesystem::path& path, MeshMetadata metadata, const Task& task)
      : metadata_(std::move(metadata)), path_(path), file_(path), task_(task) {}

  void begin(const MeshTotals& totals) final {
    totals_ = totals;
    if (metadata_.origin) shift_ = totals.origin - *metadata_.origin;
    task_.begin("writing " + path_.filename().string(), totals.vertices + totals.triangles);
    header();
  }
  void add(const MeshPiece& piece) final {
    for (std::size_t v = 0; v < piece.positions.size(); ++v) {
      if (piece.numbers[v] < piece.first_number) continue;
      vertex(piece, v);
      if (++vertices_ % kProgress == 0) task_.advance(kProgress);
    }
    if (vertices_ == totals_.vertices && direct_section_ == 0) go_to(1);
    for (const Triangle& t : piece.triangles) {
      face(piece, t);
      if (++triangles_ % kProgress == 0) task_.advance(kProgress);
    }
  }
  void end() final {
    while (!sections_.empty()) go_to(sections_.begin()->first);
    flush();
    file_.commit();
  }

 protected:
  /// Appends to a section of the file, in the order of their numbers; 0 is the first.
  template <class Write>
  void append(std::uint32_t section, Write&& write) {
    if (section <= direct_section_) {
      write(direct_);
      if (direct_.full()) flush();
    } else {
      Stream& waiting = sections_.try_emplace(section, path_).first->second;
      write(waiting.bytes);
      if (waiting.bytes.full()) flush(waiting);
    }
  }
  [[nodiscard]] Vec3f position(const MeshPiece& piece, std::size_t v) const {
    return metadata_.origin ? Vec3f(Vec3(piece.positions[v]) + shift_) : piece.positions[v];
  }
  virtual void header() = 0;
  virtual void vertex(const MeshPiece& piece, std::size_t v) = 0;
  virtual void face(const MeshPiece& piece, const Triangle& t) = 0;
  /// Written in front of a section past the first.
  virtual std::string section_header(std::uint32_t) { return {}; }

  MeshMetadata metadata_;
  MeshTotals totals_;

 private:
  static constexpr std::size_t kProgress = 1 << 14;
  struct Stream {
    explicit Stream(const std::filesystem::path& beside) : spool(beside) {}
    Bytes bytes;
    Spool spool;
  };
  void flush() {
    task_.check();
    file_.write(direct_.view());
    direct_.clear();
  }
  void flush(Stream& stream) {
    task_.check();
    stream.spool.write(std::as_bytes(std::span(stream.bytes.view())));
    stream.bytes.clear();
  }
  /// All that comes before the section is there: it continues directly in the file.
  void go_to(std::uint32_t section) {
    direct_.text(section_header(section));
    flush();
    direct_section_ = section;
    const auto found = sections_.find(section);
    if (found == sections_.end()) return;
    flush(found->second);
    Spool& spool = found->second.spool;
    std::vector<std::byte> bytes;
    for (std::uint64_t at = 0; at < spool.size(); at += bytes.size()) {
      bytes.resize(std::min<std::uint64_t>(kFlushBytes, spool.size() - at));
      spool.read(at, bytes);
      task_.check();
      file_.write(bytes);
    }
    sections_.erase(found);
  }

  std::filesystem::path path_;
  OutputFile file_;
  Task task_;
  Vec3 shift_{0.0};
  Bytes direct_;
  std::uint32_t direct_section_ = 0;
  std::map<std::uint32_t, Stream> sections_;
  std::size_t vertices_ = 0, triangles_ = 0;
};

class PlyWriter final : public Writer {
 public:
  using Writer::Writer;

 private:
  void header() override {
    colours_ = totals_.labels && !metadata_.material_colours.empty();
    wide_ = totals_.largest_label > 255;
    for (const Vec3f& c : metadata_.material_colours)
      colour_bytes_.push_back({srgb_byte(c.x), srgb_byte(c.y), srgb_byte(c.z)});
    append(0, [&](Bytes& out) {
      out.text("ply\nformat binary_little_endian 1.0\n");
      for (const std::string& comment : metadata_.comments) out.text("comment ").text(one_line(comment)).text("\n");
      for (std::size_t i = 0; totals_.labels && i < metadata_.material_names.size(); ++i)
        out.text("comment material ").number(i).text(" ").text(one_line(metadata_.material_names[i])).text("\n");
      out.text("element vertex ").number(totals_.vertices);
      out.text("\nproperty float x\nproperty float y\nproperty float z\n");
      if (totals_.normals) out.text("property float nx\nproperty float ny\nproperty float nz\n");
      if (colours_) out.text("property uchar red\nproperty uchar green\nproperty uchar blue\n");
      if (totals_.labels) out.text(wide_ ? "property ushort material\n" : "property uchar material\n");
      out.text("element face ").number(totals_.triangles);
      out.text("\nproperty list uchar uint vertex_indices\nend_header\n");
    });
  }
  void vertex(const MeshPiece& piece, std::size_t v) override {
    append(0, [&](Bytes& out) {
      out.raw(position(piece, v));
      if (totals_.normals) out.raw(piece.normals[v]);
      if (colours_) {
        constexpr std::array<std::uint8_t, 3> kNobodysColour = {128, 128, 128};
        const auto& c = piece.labels[v] < colour_bytes_.size() ? colour_bytes_[piece.labels[v]] : kNobodysColour;
        out.raw(c[0]).raw(c[1]).raw(c[2]);
      }
      if (wide_ && totals_.labels) {
        out.raw(static_cast<std::uint16_t>(piece.labels[v]));
      } else if (totals_.labels) {
        out.raw(static_cast<std::uint8_t>(piece.labels[v]));
      }
    });
  }
  void face(const MeshPiece& piece, const Triangle& t) override {
    append(1, [&](Bytes& out) {
      out.raw(std::uint8_t{3}).raw(piece.numbers[t[0]]).raw(piece.numbers[t[1]]).raw(piece.numbers[t[2]]);
    });
  }

  bool colours_ = false, wide_ = false;
  std::vector<std::array<std::uint8_t, 3>> colour_bytes_;
};

class ObjWriter final : public Writer {
 public:
  using Writer::Writer;

 private:
  // Triangles of one material stand together.
  static constexpr std::uint32_t kNormals = 1, kFaces = 2;

  void header() override {
    append(0, [&](Bytes& out) {
      for (const std::string& comment : metadata_.comments) out.text("# ").text(one_line(comment)).text("\n");
    });
  }
  void vertex(const MeshPiece& piece, std::size_t v) override {
    append(0, [&](Bytes& out) { out.numbers("v ", position(piece, v)); });
    if (totals_.normals) append(kNormals, [&](Bytes& out) { out.numbers("vn ", piece.normals[v]); });
  }
  void face(const MeshPiece& piece, const Triangle& t) override {
    append(kFaces + (totals_.labels ? label_of(piece, t) : 0u), [&](Bytes& out) {
      out.text("f");
      for (const std::uint32_t v : t) {
        const std::uint64_t one_based = std::uint64_t{piece.numbers[v]} + 1;
        out.text(" ").number(one_based);
        if (totals_.normals) out.text("//").number(one_based);
      }
      out.text("\n");
    });
  }
  std::string section_header(std::uint32_t section) override {
    if (!totals_.labels || section < kFaces) return {};
    const std::uint32_t label = section - kFaces;
    std::string name = one_line(label < metadata_.material_names.size() ? metadata_.material_names[label]
                                                                        : "material" + std::to_string(label));
    std::replace(name.begin(), name.end(), ' ', '_');
    return "usemtl " + name + "\n";
  }
  /// The label that most corners of the triangle have.
  static Label label_of(const MeshPiece& piece, const Triangle& t) {
    const Label a = piece.labels[t[0]], b = piece.labels[t[1]], c = piece.labels[t[2]];
    return b == c ? b : a;
  }
};

class StlWriter final : public Writer {
 public:
  using Writer::Writer;

 private:
  void header() override {
    require(totals_.triangles <= std::numeric_limits<std::uint32_t>::max(), "triangles",
            "at most 2^32 - 1 in an .stl file", static_cast<double>(totals_.triangles));
    // Readers take a header that begins with "solid" for the text form.
    constexpr std::size_t kHeaderBytes = 80;
    std::string text = "binary STL, metres";
    for (const std::string& comment : metadata_.comments) text += "; " + one_line(comment);
    text.resize(kHeaderBytes, ' ');
    append(0, [&](Bytes& out) { out.text(text).raw(static_cast<std::uint32_t>(totals_.triangles)); });
  }
  void vertex(const MeshPiece&, std::size_t) override {}
  void face(const MeshPiece& piece, const Triangle& t) override {
    const Vec3f a = position(piece, t[0]), b = position(piece, t[1]), c = position(piece, t[2]);
    const Vec3 normal = glm::cross(Vec3(b) - Vec3(a), Vec3(c) - Vec3(a));
    const double length = glm::length(normal);
    append(0, [&](Bytes& out) {
      out.raw(length > 0.0 ? Vec3f(normal / length) : Vec3f(0.0f)).raw(a).raw(b).raw(c).raw(std::uint16_t{0});
    });
  }
};

}  // namespace

std::unique_ptr<MeshSink> mesh_writer(const std::filesystem::path& path, MeshMetadata metadata, const Task& task) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".ply") return std::make_unique<PlyWriter>(path, std::move(metadata), task);
  if (extension == ".obj") return std::make_unique<ObjWriter>(path, std::move(metadata), task);
  require(extension == ".stl", "mesh file", "a name that ends in .ply, .obj or .stl",
          meshing::quoted(path.filename().string()));
  return std::make_unique<StlWriter>(path, std::move(metadata), task);
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, const MeshMetadata& metadata,
                const Task& task) {
  feed(mesh, *mesh_writer(path, metadata, task));
}

}  // namespace outcrop
