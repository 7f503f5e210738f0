/// JSON with positions: every complaint about a value can name file, line and column.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace outcrop {

/// One value of a parsed document, with the place where it stands.
class Json {
 public:
  enum class Type { Null, Boolean, Number, String, Array, Object };

  Type type = Type::Null;
  bool boolean = false;
  double number = 0.0;
  std::string string{};
  std::vector<Json> items{};                           ///< Of an array.
  std::vector<std::pair<std::string, Json>> members{}; ///< Of an object, in file order; no key twice.
  std::shared_ptr<const std::string> file{};           ///< Name for messages.
  int line = 0;                                        ///< 1-based; of a member, where its key stands.
  int column = 0;

  /// `file:line:column`.
  [[nodiscard]] std::string place() const;
  /// Throws InputError `file:line:column: expected <expected>, got <what stands there>`.
  [[noreturn]] void fail(std::string_view expected) const;
  /// The same with `got` in the caller's words.
  [[noreturn]] void fail(std::string_view expected, std::string_view got) const;
  /// "object", "array", "string \"abc\"", "number 3", …
  [[nodiscard]] std::string describe() const;
};

/// @throws InputError with line and column when the text is no JSON or holds a key twice. `name` stands for the file.
[[nodiscard]] Json parse_json(std::string_view text, std::string_view name);
[[nodiscard]] Json read_json(const std::filesystem::path& path);

/// Inclusive bounds for a number in a file.
struct Bounds {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
  bool open_lo = false;  ///< lo itself is excluded.
};

/// Reads the members of one object, each with a default, and refuses what it does not know.
///
/// Getters name the key, its bound and the value when they throw InputError. Call `finish()` last: it throws for keys that
/// no getter asked for, with the nearest known key.
class JsonReader {
 public:
  /// @throws InputError when `json` is no object.
  explicit JsonReader(const Json& json);

  [[nodiscard]] bool has(std::string_view key);
  [[nodiscard]] double number(std::string_view key, double fallback, Bounds bounds = {});
  [[nodiscard]] int integer(std::string_view key, int fallback, int lo, int hi);
  [[nodiscard]] bool boolean(std::string_view key, bool fallback);
  [[nodiscard]] std::string string(std::string_view key, std::string_view fallback);
  /// One of `choices`; the index. An unknown word is an error that lists the choices and the nearest.
  [[nodiscard]] std::size_t choice(std::string_view key, std::size_t fallback, const std::vector<std::string_view>& choices);
  /// n numbers, each within bounds; `fallback` when the key is missing.
  [[nodiscard]] std::vector<double> numbers(std::string_view key, std::vector<double> fallback, std::size_t count,
                                            Bounds bounds = {});
  /// The raw member, or null. Marks the key as known.
  [[nodiscard]] const Json* child(std::string_view key);
  /// The items of an array member (each checked by the caller), empty when missing.
  [[nodiscard]] const std::vector<Json>& array(std::string_view key);
  /// @throws InputError for the first key that nobody asked for.
  void finish() const;
  [[nodiscard]] const Json& json() const noexcept { return *json_; }

 private:
  const Json* json_;
  std::vector<std::string> known_;
};

/// Writes JSON text: values in call order, indented by two spaces, shortest numbers that read back the same.
///
/// Inside an array the key is ignored. Numbers that are not finite become null. Bytes of strings are taken as UTF-8.
class JsonWriter {
 public:
  JsonWriter& begin_object(std::string_view key = {});
  JsonWriter& end_object();
  JsonWriter& begin_array(std::string_view key = {});
  JsonWriter& end_array();
  JsonWriter& value(std::string_view key, double v);
  JsonWriter& value(std::string_view key, std::string_view v);
  JsonWriter& value(std::string_view key, const char* v) { return value(key, std::string_view(v)); }
  JsonWriter& boolean(std::string_view key, bool v);
  JsonWriter& item(double v);
  JsonWriter& item(std::string_view v);
  /// The finished document with a final newline.
  [[nodiscard]] std::string text() const;

 private:
  /// An object or array that is still open.
  struct Level {
    bool array = false;
    bool empty = true;
    bool broken = false;  ///< Over several lines: its end gets a line too.
  };

  JsonWriter& begin(std::string_view key, bool array);
  JsonWriter& end();
  void next(std::string_view key, bool on_its_own_line);

  std::string text_;
  std::vector<Level> levels_;
};

}  // namespace outcrop
