#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <utility>

#include "mesh_text.h"

namespace outcrop::meshing {
namespace {

enum class Format { Text, LittleEndian, BigEndian };
enum class Scalar { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

struct Property {
  std::string name;
  Scalar type = Scalar::Float32;
  std::optional<Scalar> count;  ///< Of a list: the type of its length.
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  /// Index of the first property with one of these names, else −1.
  [[nodiscard]] int find(std::initializer_list<std::string_view> names) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
      for (const std::string_view known : names)
        if (properties[i].name == known) return static_cast<int>(i);
    return -1;
  }
};

struct Header {
  Format format = Format::Text;
  std::vector<Element> elements;
};

std::optional<Scalar> scalar_named(std::string_view name) {
  constexpr std::pair<std::string_view, Scalar> kNames[] = {
      {"char", Scalar::Int8},      {"int8", Scalar::Int8},       {"uchar", Scalar::Uint8},
      {"uint8", Scalar::Uint8},    {"short", Scalar::Int16},     {"int16", Scalar::Int16},
      {"ushort", Scalar::Uint16},  {"uint16", Scalar::Uint16},   {"int", Scalar::Int32},
      {"int32", Scalar::Int32},    {"uint", Scalar::Uint32},     {"uint32", Scalar::Uint32},
      {"float", Scalar::Float32},  {"float32", Scalar::Float32}, {"double", Scalar::Float64},
      {"float64", Scalar::Float64}};
  for (const auto& [known, type] : kNames)
    if (known == name) return type;
  return std::nullopt;
}

Scalar type_word(const TextLines& lines, std::size_t index) {
  const auto& words = lines.words();
  const auto type = index < words.size() ? scalar_named(words[index]) : std::nullopt;
  if (!type)
    lines.fail("a type such as float, uchar or int", index < words.size() ? words[index] : "the end of the line");
  return *type;
}

Header read_header(TextLines& lines) {
  lines.need("ply");
  if (lines.words()[0] != "ply") lines.fail("\"ply\"", "a file that is no PLY");
  Header header;
  bool has_format = false;
  for (lines.need("a header"); lines.words()[0] != "end_header"; lines.need("\"end_header\"")) {
    const auto& words = lines.words();
    if (words[0] == "format" && words.size() >= 2) {
      has_format = true;
      if (words[1] == "ascii") {
        header.format = Format::Text;
      } else if (words[1] == "binary_little_endian") {
        header.format = Format::LittleEndian;
      } else if (words[1] == "binary_big_endian") {
        header.format = Format::BigEndian;
      } else {
        lines.fail("ascii, binary_little_endian or binary_big_endian", words[1]);
      }
    } else if (words[0] == "element" && words.size() >= 3) {
      const long long count = lines.integer(words[2], "a count");
      // Each one takes a byte at least: larger counts are no reason to reserve memory.
      if (count < 0 || static_cast<unsigned long long>(count) > lines.rest().size())
        lines.fail("as many elements as fit in the file", words[2]);
      header.elements.push_back({std::string(words[1]), static_cast<std::size_t>(count), {}});
    } else if (words[0] == "property") {
      if (header.elements.empty()) lines.fail("an element before its properties", "a property");
      const bool list = words.size() > 1 && words[1] == "list";
      Property property;
      if (list) property.count = type_word(lines, 2);
      property.type = type_word(lines, list ? 3 : 1);
      if (words.size() <= (list ? 4u : 2u)) lines.fail("a property's name", "the end of the line");
      property.name = words[list ? 4 : 2];
      header.elements.back().properties.push_back(property);
    } else if (words[0] != "comment" && words[0] != "obj_info") {
      lines.fail("format, element, property, comment or end_header", quoted(words[0]));
    }
  }
  if (!has_format) lines.fail("a format line before the header's end", "none");
  return header;
}

/// The numbers of the body one after another, whatever the format.
class Body {
 public:
  Body(const std::filesystem::path& path, TextLines& lines, Format format)
      : path_(path.string()),
        lines_(lines),
        format_(format),
        bytes_(format == Format::Text ? std::string_view() : lines.rest()) {}

  void begin(const Element& element, std::size_t index) {
    element_ = &element;
    index_ = index;
    if (format_ == Format::Text) {
      lines_.need(element.name + " " + std::to_string(index) + " of " + std::to_string(element.count));
      word_ = 0;
    }
  }
  double number(Scalar type) {
    if (format_ == Format::Text) return lines_.number(word_++, "a finite number");
    static constexpr std::size_t kSize[] = {1, 1, 2, 2, 4, 4, 4, 8};
    const std::size_t size = kSize[static_cast<int>(type)];
    if (bytes_.size() < size) fail("more bytes", "the end of the file");
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), bytes_.data(), size);
    bytes_.remove_prefix(size);
    const bool swap = (format_ == Format::BigEndian) != (std::endian::native == std::endian::big);
    if (swap) std::reverse(raw.begin(), raw.begin() + size);
    return decode(type, raw);
  }
  std::size_t length(Scalar type) {
    const double count = number(type);
    if (count < 0 || count != std::floor(count) || count > 1e6) fail("a list's length", std::to_string(count));
    return static_cast<std::size_t>(count);
  }
  [[noreturn]] void fail(std::string_view expected, std::string_view got) const {
    if (format_ == Format::Text) lines_.fail(expected, got);
    meshing::fail(path_, expected, std::string(got) + " in " + element_->name + " " + std::to_string(index_));
  }

 private:
  template <class T>
  static double as(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof value);
    return static_cast<double>(value);
  }
  static double decode(Scalar type, const std::array<char, 8>& raw) {
    switch (type) {
      case Scalar::Int8:
        return as<std::int8_t>(raw);
      case Scalar::Uint8:
        return as<std::uint8_t>(raw);
      case Scalar::Int16:
        return as<std::int16_t>(raw);
      case Scalar::Uint16:
        return as<std::uint16_t>(raw);
      case Scalar::Int32:
        return as<std::int32_t>(raw);
      case Scalar::Uint32:
        return as<std::uint32_t>(raw);
      case Scalar::Float32:
        return as<float>(raw);
      case Scalar::Float64:
        return as<double>(raw);
    }
    return 0.0;
  }

  std::string path_;
  TextLines& lines_;
  Format format_;
  std::string_view bytes_;
  const Element* element_ = nullptr;
  std::size_t index_ = 0;
  std::size_t word_ = 0;
};

void read_vertices(Body& body, const Element& element, FileMesh& mesh) {
  const int x = element.find({"x"}), y = element.find({"y"}), z = element.find({"z"});
  const int nx = element.find({"nx"}), ny = element.find({"ny"}), nz = element.find({"nz"});
  const int material = element.find({"material", "label"});
  const bool normals = nx >= 0 && ny >= 0 && nz >= 0;
  std::vector<double> values(element.properties.size());
  for (std::size_t i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (std::size_t p = 0; p < values.size(); ++p) {
      const Property& property = element.properties[p];
      values[p] = 0.0;
      if (!property.count) {
        values[p] = body.number(property.type);
      } else {
        for (std::size_t n = body.length(*property.count); n > 0; --n) (void)body.number(property.type);
      }
    }
    const Vec3 position(values[x], values[y], values[z]);
    if (!std::isfinite(position.x + position.y + position.z)) body.fail("finite coordinates", "none");
    mesh.positions.push_back(position);
    if (normals) mesh.normals.emplace_back(values[nx], values[ny], values[nz]);
    if (material >= 0) {
      if (!(values[material] >= 0.0 && values[material] <= 65535.0))
        body.fail("a material from 0 to 65535", std::to_string(values[material]));
      mesh.labels.push_back(static_cast<Label>(values[material]));
    }
  }
}

void read_faces(Body& body, const Element& element, int indices, std::size_t vertices, FileMesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      const bool wanted = static_cast<int>(p) == indices;
      if (wanted) corners.clear();
      for (std::size_t n = property.count ? body.length(*property.count) : 1; n > 0; --n) {
        const double value = body.number(property.type);
        if (!wanted) continue;
        if (!(value >= 0.0 && value < static_cast<double>(vertices)) || value != std::floor(value)) {
          char got[32];
          std::snprintf(got, sizeof got, "%.9g", value);
          body.fail("a vertex number below " + std::to_string(vertices), got);
        }
        corners.push_back(static_cast<std::uint32_t>(value));
      }
    }
    if (corners.size() < 3) body.fail("a face of three or more vertices", std::to_string(corners.size()));
    mesh.add_polygon(corners);
  }
}

void skip(Body& body, const Element& element) {
  for (std::size_t i = 0; i < element.count; ++i) {
    body.begin(element, i);
    for (const Property& property : element.properties)
      for (std::size_t n = property.count ? body.length(*property.count) : 1; n > 0; --n)
        (void)body.number(property.type);
  }
}

}  // namespace

FileMesh read_ply(const std::filesystem::path& path, std::string_view bytes) {
  TextLines lines(path, bytes);
  const Header header = read_header(lines);
  const auto vertex =
      std::find_if(header.elements.begin(), header.elements.end(), [](const Element& e) { return e.name == "vertex"; });
  if (vertex == header.elements.end() || vertex->find({"x"}) < 0 || vertex->find({"y"}) < 0 || vertex->find({"z"}) < 0)
    fail(path.string(), "an element vertex with x, y and z", "none in the header");
  FileMesh mesh;
  Body body(path, lines, header.format);
  for (const Element& element : header.elements) {
    const int indices = element.find({"vertex_indices", "vertex_index"});
    if (&element == &*vertex) {
      read_vertices(body, element, mesh);
    } else if (element.name == "face" && element.count > 0) {
      if (indices < 0 || !element.properties[indices].count)
        fail(path.string(), "faces with a list vertex_indices", "none in the header");
      read_faces(body, element, indices, vertex->count, mesh);
    } else {
      skip(body, element);
    }
  }
  return mesh;
}

}  // namespace outcrop::meshing
