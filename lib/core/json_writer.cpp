#include <charconv>
#include <cmath>
#include <cstdio>

#include "outcrop/core/json.h"

namespace outcrop {

namespace {

// Counts read better as 100000 than as the equally short 1e+05; up to here every integer is exact.
constexpr double kLargestExactInteger = 0x1p53;

void append_number(std::string& text, double v) {
  if (!std::isfinite(v)) {
    text += "null";  // JSON has no word for it
    return;
  }
  char digits[32];
  const bool whole = std::abs(v) <= kLargestExactInteger && v == std::trunc(v);
  const auto end = whole ? std::to_chars(digits, digits + sizeof digits, v, std::chars_format::fixed)
                         : std::to_chars(digits, digits + sizeof digits, v);
  text.append(digits, end.ptr);
}

void append_string(std::string& text, std::string_view s) {
  text += '"';
  for (const char c : s) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", c);
      text += escape;
    } else {
      text += c;
    }
  }
  text += '"';
}

}  // namespace

void JsonWriter::next(std::string_view key, bool on_its_own_line) {
  if (levels_.empty()) return;
  Level& level = levels_.back();
  if (!level.empty) text_ += ',';
  if (!level.array || on_its_own_line) {
    text_ += '\n';
    text_.append(2 * levels_.size(), ' ');
    level.broken = true;
  } else if (!level.empty) {
    text_ += ' ';
  }
  level.empty = false;
  if (level.array) return;
  append_string(text_, key);
  text_ += ": ";
}

JsonWriter& JsonWriter::begin(std::string_view key, bool array) {
  next(key, true);
  text_ += array ? '[' : '{';
  levels_.push_back({.array = array});
  return *this;
}

JsonWriter& JsonWriter::end() {
  const Level level = levels_.back();
  levels_.pop_back();
  if (level.broken) {
    text_ += '\n';
    text_.append(2 * levels_.size(), ' ');
  }
  text_ += level.array ? ']' : '}';
  return *this;
}

JsonWriter& JsonWriter::begin_object(std::string_view key) { return begin(key, false); }
JsonWriter& JsonWriter::end_object() { return end(); }
JsonWriter& JsonWriter::begin_array(std::string_view key) { return begin(key, true); }
JsonWriter& JsonWriter::end_array() { return end(); }

JsonWriter& JsonWriter::value(std::string_view key, double v) {
  next(key, false);
  append_number(text_, v);
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view key, std::string_view v) {
  next(key, false);
  append_string(text_, v);
  return *this;
}

JsonWriter& JsonWriter::boolean(std::string_view key, bool v) {
  next(key, false);
  text_ += v ? "true" : "false";
  return *this;
}

JsonWriter& JsonWriter::item(double v) { return value({}, v); }
JsonWriter& JsonWriter::item(std::string_view v) { return value({}, v); }

std::string JsonWriter::text() const { return text_ + '\n'; }

}  // namespace outcrop
