/// What the mesh readers share: lines and words with their places, complaints, and the mesh as it comes out of a file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "outcrop/core/vec.h"
#include "outcrop/implicit/field.h"

namespace outcrop::meshing {

/// A mesh in the file's own coordinates.
struct FileMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3f> normals;  ///< One a vertex, or empty.
  std::vector<Label> labels;   ///< One a vertex, or empty.
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Appends a polygon as a fan.
  void add_polygon(const std::vector<std::uint32_t>& corners);
};

/// The word in quotation marks, cut short and without control characters, for a message.
[[nodiscard]] std::string quoted(std::string_view word);

/// Throws InputError `place: expected <expected>, got <got>`.
[[noreturn]] void fail(std::string_view place, std::string_view expected, std::string_view got);

/// Walks through a text line by line; CR LF is one line end.
class TextLines {
 public:
  TextLines(const std::filesystem::path& path, std::string_view text) : path_(path.string()), rest_(text) {}

  /// Goes to the next line; false at the end of the text.
  bool next();
  /// Goes to the next line that holds a word; fails at the end of the text.
  void need(std::string_view expected);
  /// The words of the current line.
  [[nodiscard]] const std::vector<std::string_view>& words() const noexcept { return words_; }
  [[nodiscard]] std::string_view line() const noexcept { return line_; }
  /// What follows the current line.
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
  /// Throws InputError `path:line: …`.
  [[noreturn]] void fail(std::string_view expected, std::string_view got) const;
  /// Word `index` as a finite number, as an integer.
  [[nodiscard]] double number(std::size_t index, std::string_view expected) const;
  [[nodiscard]] long long integer(std::string_view word, std::string_view expected) const;
  /// Words first to first + 2 as a place.
  [[nodiscard]] Vec3 vec3(std::size_t first, std::string_view expected) const;

 private:
  std::string path_;
  std::string_view rest_, line_;
  std::vector<std::string_view> words_;
  std::size_t number_ = 0;
};

[[nodiscard]] FileMesh read_ply(const std::filesystem::path& path, std::string_view bytes);
[[nodiscard]] FileMesh read_obj(const std::filesystem::path& path, std::string_view text);
[[nodiscard]] FileMesh read_stl(const std::filesystem::path& path, std::string_view bytes);

}  // namespace outcrop::meshing
