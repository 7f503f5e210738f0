#include "mesh_text.h"

#include <charconv>
#include <cmath>

#include "outcrop/core/error.h"

namespace outcrop::meshing {
namespace {

constexpr std::size_t kQuoted = 40;

}  // namespace

std::string quoted(std::string_view word) {
  std::string text = "\"";
  for (const char c : word.substr(0, kQuoted)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > kQuoted ? "…\"" : "\"");
}

void FileMesh::add_polygon(const std::vector<std::uint32_t>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

void fail(std::string_view place, std::string_view expected, std::string_view got) {
  throw InputError(std::string(place) + ": expected " + std::string(expected) + ", got " + std::string(got));
}

bool TextLines::next() {
  words_.clear();
  if (rest_.empty()) return false;
  ++number_;
  const std::size_t end = rest_.find('\n');
  line_ = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
  if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
  constexpr std::string_view kBlank = " \t\r\f\v";
  for (std::size_t at = line_.find_first_not_of(kBlank); at != std::string_view::npos;) {
    const std::size_t stop = std::min(line_.find_first_of(kBlank, at), line_.size());
    words_.push_back(line_.substr(at, stop - at));
    at = line_.find_first_not_of(kBlank, stop);
  }
  return true;
}

void TextLines::need(std::string_view expected) {
  while (next())
    if (!words_.empty()) return;
  fail(expected, "the end of the file");
}

void TextLines::fail(std::string_view expected, std::string_view got) const {
  meshing::fail(path_ + ":" + std::to_string(number_), expected, got);
}

double TextLines::number(std::size_t index, std::string_view expected) const {
  if (index >= words_.size()) fail(expected, "the end of the line");
  std::string_view word = words_[index];
  if (word.size() > 1 && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size() || !std::isfinite(value) ||
      (error == std::errc::result_out_of_range && std::abs(value) > 1.0))
    fail(expected, quoted(words_[index]));
  return value;
}

long long TextLines::integer(std::string_view word, std::string_view expected) const {
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) fail(expected, quoted(word));
  return value;
}

Vec3 TextLines::vec3(std::size_t first, std::string_view expected) const {
  const double x = number(first, expected), y = number(first + 1, expected), z = number(first + 2, expected);
  return {x, y, z};
}

}  // namespace outcrop::meshing
