#include "outcrop/core/json.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "outcrop/core/error.h"
#include "outcrop/core/file.h"

namespace outcrop {

namespace {

constexpr std::size_t kMaxDepth = 200;   // Of nested arrays and objects: destroying a Json recurses.
constexpr std::size_t kMaxExcerpt = 40;  // Characters of the input that a message repeats.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// In quotes, on one line, and not too long.
std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool inside_a_character = (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
    if (i >= kMaxExcerpt && !inside_a_character) {
      result += "…";
      break;
    }
    result += static_cast<unsigned char>(text[i]) < 0x20 ? ' ' : text[i];
  }
  return result + '"';
}

// Six digits of a bound that was computed: 0.739645 rather than 0.7396449704142012.
std::string bound_text(double bound) {
  const std::string exact = shortest(bound);
  if (exact.size() <= 10) return exact;
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", bound);
  return text;
}

std::string numbers_in(const Bounds& bounds, std::string_view what) {
  const std::string name(what), lo = bound_text(bounds.lo), hi = bound_text(bounds.hi);
  const bool below = std::isfinite(bounds.hi);
  if (std::isfinite(bounds.lo)) {
    if (below) return name + (bounds.open_lo ? " in (" : " in [") + lo + ", " + hi + "]";
    return name + (bounds.open_lo ? " > " : " >= ") + lo;
  }
  return below ? name + " <= " + hi : name;
}

bool within(double v, const Bounds& bounds) {
  return (bounds.open_lo ? v > bounds.lo : v >= bounds.lo) && v <= bounds.hi;
}

// Follows the tokenizer through the text with a cursor of its own: between two of its events stand only white space,
// commas and colons, so the next token starts where those end. The tokenizer's own positions point behind a token.
class Builder {
 public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  Builder(std::string_view text, std::string_view name)
      : text_(text), file_(std::make_shared<const std::string>(name)) {
    if (text_.starts_with(kByteOrderMark)) cursor_ = kByteOrderMark.size();
  }

  bool null() {
    enter_token();
    skip_word();
    return add({});
  }
  bool boolean(bool v) {
    enter_token();
    skip_word();
    return add({.type = Json::Type::Boolean, .boolean = v});
  }
  bool number_integer(number_integer_t v) { return number(static_cast<double>(v)); }
  bool number_unsigned(number_unsigned_t v) { return number(static_cast<double>(v)); }
  bool number_float(number_float_t v, const string_t&) { return number(v); }
  bool string(string_t& v) {
    enter_token();
    skip_string();
    return add({.type = Json::Type::String, .string = v});
  }
  bool binary(binary_t&) { return false; }  // JSON text has none
  bool start_object(std::size_t) { return open(Json::Type::Object); }
  bool start_array(std::size_t) { return open(Json::Type::Array); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(string_t& name) {
    enter_token();
    Frame& frame = open_.back();
    frame.key = name;
    frame.key_line = token_line_;
    frame.key_column = token_column_;
    if (!frame.keys.insert(name).second) {
      const auto same = std::find_if(frame.value.members.begin(), frame.value.members.end(),
                                     [&](const auto& member) { return member.first == name; });
      fail_at_token("expected every key once, got " + in_quotes(name) + " again; it stands in line " +
                    std::to_string(same->second.line) + " already");
    }
    skip_string();
    state_ = State::AfterKey;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& e) {
    explain(position, e.id);
    return false;
  }

  [[nodiscard]] Json take() { return std::move(root_); }

 private:
  enum class State { BeforeValue, AfterKey, BeforeFirst, AfterValue };

  struct Frame {
    Json value;
    std::string key{};
    int key_line = 0;
    int key_column = 0;
    std::unordered_set<std::string> keys{};
  };

  static bool in_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '+' || c == '-' || c == '.' || c == '_';
  }
  [[nodiscard]] bool at_end() const { return cursor_ >= text_.size(); }
  [[nodiscard]] char here() const { return at_end() ? '\0' : text_[cursor_]; }

  void step() {
    const unsigned char passed = static_cast<unsigned char>(text_[cursor_++]);
    if (passed == '\n') {
      ++line_;
      column_ = 1;
    } else if ((passed & 0xC0) != 0x80) {
      ++column_;  // characters, not bytes
    }
  }
  void skip(std::string_view which) {
    while (!at_end() && which.find(text_[cursor_]) != which.npos) step();
  }
  void skip_word() {
    while (!at_end() && std::isalpha(static_cast<unsigned char>(here()))) step();
  }
  void skip_number() {
    skip("-");
    if (here() == '0') {
      step();  // nothing may follow it but a fraction or an exponent
    } else {
      skip("0123456789");
    }
    if (here() == '.') {
      step();
      skip("0123456789");
    }
    if (here() == 'e' || here() == 'E') {
      step();
      skip("+-");
      skip("0123456789");
    }
  }
  void skip_string() {
    step();
    while (here() != '"') {
      if (here() == '\\') step();
      step();
    }
    step();
  }
  void mark_token() {
    token_line_ = line_;
    token_column_ = column_;
  }
  void enter_token() {
    skip(" \t\r\n,:");
    mark_token();
  }

  [[noreturn]] void fail_at_token(const std::string& message) const {
    throw InputError(*file_ + ":" + std::to_string(token_line_) + ":" + std::to_string(token_column_) + ": " + message);
  }

  void place(Json& value) const {
    const bool member = !open_.empty() && open_.back().value.type == Json::Type::Object;
    value.file = file_;
    value.line = member ? open_.back().key_line : token_line_;
    value.column = member ? open_.back().key_column : token_column_;
  }
  bool store(Json value) {
    state_ = State::AfterValue;
    if (open_.empty()) {
      root_ = std::move(value);
    } else if (open_.back().value.type == Json::Type::Object) {
      open_.back().value.members.emplace_back(std::move(open_.back().key), std::move(value));
    } else {
      open_.back().value.items.push_back(std::move(value));
    }
    return true;
  }
  bool add(Json value) {
    place(value);
    return store(std::move(value));
  }
  bool number(double v) {
    enter_token();
    skip_number();
    return add({.type = Json::Type::Number, .number = v});
  }
  bool open(Json::Type type) {
    enter_token();
    if (open_.size() >= kMaxDepth) {
      fail_at_token("expected at most " + std::to_string(kMaxDepth) + " nested arrays and objects, got more");
    }
    Frame frame{.value = {.type = type}};
    place(frame.value);
    step();
    open_.push_back(std::move(frame));
    state_ = State::BeforeFirst;
    return true;
  }
  bool close() {
    enter_token();
    step();
    Json value = std::move(open_.back().value);
    open_.pop_back();
    return store(std::move(value));
  }

  // The tokenizer gave up somewhere behind the cursor. What may follow there is known, so is what does.
  [[noreturn]] void explain(std::size_t position, int id) {
    const bool in_object = !open_.empty() && open_.back().value.type == Json::Type::Object;
    const auto skip_one = [&](char separator) {
      skip(" \t\r\n");
      if (here() != separator || at_end()) return false;
      step();
      skip(" \t\r\n");
      return true;
    };
    std::string expected;
    bool key_next = false;
    skip(" \t\r\n");
    if (state_ == State::AfterKey) {
      expected = skip_one(':') ? "a value" : "':' after the key " + in_quotes(open_.back().key);
    } else if (state_ == State::AfterValue && open_.empty()) {
      expected = "the end of the file";
    } else if (state_ == State::AfterValue && !skip_one(',')) {
      expected = in_object ? "',' or '}'" : "',' or ']'";
    } else if (in_object) {
      key_next = true;
      expected = state_ == State::BeforeFirst ? "a key in quotes or '}'" : "a key in quotes";
    } else {
      expected = state_ == State::BeforeFirst && !open_.empty() ? "a value or ']'" : "a value";
    }
    // A key may be whole and only its colon missing: the tokenizer reads both before it tells.
    mark_token();
    if (here() == '"' && (key_next || expected.starts_with("a value"))) explain_string(position);
    if (id == kOverflow) expected = "a number that a double can hold";
    fail_at_token("expected " + expected + ", got " + rest());
  }

  // The string at the cursor is not well-formed: says why, and where.
  [[noreturn]] void explain_string(std::size_t position) {
    const std::size_t limit = std::min(text_.size(), position == 0 ? text_.size() : position - 1);
    step();
    while (cursor_ < limit && here() != '\n') step();
    mark_token();
    if (at_end()) fail_at_token("expected the string's closing quote, got the end of the file");
    if (here() == '\n' || here() == '\r') fail_at_token("expected the string's closing quote, got the end of the line");
    if (static_cast<unsigned char>(here()) < 0x20) fail_at_token("expected characters in a string, got a control code");
    if (static_cast<unsigned char>(here()) >= 0x80) fail_at_token("expected UTF-8 text, got other bytes");
    fail_at_token("expected a valid escape such as \\n or \\u00e9, got " + rest());
  }

  // What stands at the cursor, for a message.
  [[nodiscard]] std::string rest() const {
    if (at_end()) return text_.find_first_not_of(" \t\r\n") == text_.npos ? "an empty file" : "the end of the file";
    std::size_t end = cursor_ + 1;
    if (in_word(here())) {
      while (end < text_.size() && in_word(text_[end])) ++end;
    } else if (here() == '"') {
      while (end < text_.size() && text_[end] != '"' && text_[end] != '\n') ++end;
      return "the string " + in_quotes(text_.substr(cursor_ + 1, end - cursor_ - 1));
    } else if (static_cast<unsigned char>(here()) < 0x20 || static_cast<unsigned char>(here()) >= 0x80) {
      return "what is no JSON text";
    }
    const std::string word = in_quotes(text_.substr(cursor_, end - cursor_));
    return "'" + word.substr(1, word.size() - 2) + "'";
  }

  static constexpr int kOverflow = 406;  // nlohmann's number for it

  std::string_view text_;
  std::shared_ptr<const std::string> file_;
  std::size_t cursor_ = 0;
  int line_ = 1;
  int column_ = 1;
  int token_line_ = 1;
  int token_column_ = 1;
  State state_ = State::BeforeValue;
  std::vector<Frame> open_;
  Json root_;
};

[[noreturn]] void fail_member(const Json& at, std::string_view key, const std::string& expected,
                              const std::string& got) {
  throw InputError(at.place() + ": \"" + std::string(key) + "\": expected " + expected + ", got " + got);
}

// `"a", "b", "c"`
std::string listed(const std::vector<std::string_view>& names) {
  std::string text;
  for (const std::string_view name : names) text.append(text.empty() ? "\"" : ", \"").append(name).append("\"");
  return text;
}

std::string meant(std::string_view name, const std::vector<std::string_view>& known) {
  const std::string_view nearest = nearest_name(name, known.data(), known.size());
  return nearest.empty() ? "" : "; did you mean \"" + std::string(nearest) + "\"?";
}

}  // namespace

std::string Json::place() const {
  return (file ? *file : std::string()) + ":" + std::to_string(line) + ":" + std::to_string(column);
}

void Json::fail(std::string_view expected) const { fail(expected, describe()); }

void Json::fail(std::string_view expected, std::string_view got) const {
  throw InputError(place().append(": expected ").append(expected).append(", got ").append(got));
}

std::string Json::describe() const {
  switch (type) {
    case Type::Null:
      return "null";
    case Type::Boolean:
      return boolean ? "true" : "false";
    case Type::Number:
      return "number " + shortest(number);
    case Type::String:
      return "string " + in_quotes(string);
    case Type::Array:
      return "array";
    case Type::Object:
      return "object";
  }
  return "";
}

Json parse_json(std::string_view text, std::string_view name) {
  Builder builder(text, name);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

Json read_json(const std::filesystem::path& path) { return parse_json(read_text(path), path.string()); }

JsonReader::JsonReader(const Json& json) : json_(&json) {
  if (json.type != Json::Type::Object) json.fail("an object");
}

const Json* JsonReader::child(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  for (const auto& [name, value] : json_->members) {
    if (name == key) return &value;
  }
  return nullptr;
}

bool JsonReader::has(std::string_view key) { return child(key) != nullptr; }

double JsonReader::number(std::string_view key, double fallback, Bounds bounds) {
  const Json* const value = child(key);
  if (!value) return fallback;
  const std::string expected = numbers_in(bounds, "a number");
  if (value->type != Json::Type::Number) fail_member(*value, key, expected, value->describe());
  if (!within(value->number, bounds)) fail_member(*value, key, expected, shortest(value->number));
  return value->number;
}

int JsonReader::integer(std::string_view key, int fallback, int lo, int hi) {
  const Json* const value = child(key);
  if (!value) return fallback;
  const std::string expected = "an integer in [" + std::to_string(lo) + ", " + std::to_string(hi) + "]";
  if (value->type != Json::Type::Number) fail_member(*value, key, expected, value->describe());
  if (value->number < lo || value->number > hi || value->number != std::trunc(value->number)) {
    fail_member(*value, key, expected, shortest(value->number));
  }
  return static_cast<int>(value->number);
}

bool JsonReader::boolean(std::string_view key, bool fallback) {
  const Json* const value = child(key);
  if (!value) return fallback;
  if (value->type != Json::Type::Boolean) fail_member(*value, key, "true or false", value->describe());
  return value->boolean;
}

std::string JsonReader::string(std::string_view key, std::string_view fallback) {
  const Json* const value = child(key);
  if (!value) return std::string(fallback);
  if (value->type != Json::Type::String) fail_member(*value, key, "a string", value->describe());
  return value->string;
}

std::size_t JsonReader::choice(std::string_view key, std::size_t fallback,
                               const std::vector<std::string_view>& choices) {
  const Json* const value = child(key);
  if (!value) return fallback;
  const std::string expected = "one of " + listed(choices);
  if (value->type != Json::Type::String) fail_member(*value, key, expected, value->describe());
  const auto found = std::find(choices.begin(), choices.end(), value->string);
  if (found == choices.end()) {
    fail_member(*value, key, expected, in_quotes(value->string) + meant(value->string, choices));
  }
  return static_cast<std::size_t>(found - choices.begin());
}

std::vector<double> JsonReader::numbers(std::string_view key, std::vector<double> fallback, std::size_t count,
                                        Bounds bounds) {
  const Json* const value = child(key);
  if (!value) return fallback;
  const std::string expected = numbers_in(bounds, std::to_string(count) + " numbers");
  if (value->type != Json::Type::Array) fail_member(*value, key, expected, value->describe());
  if (value->items.size() != count) fail_member(*value, key, expected, std::to_string(value->items.size()));
  std::vector<double> result;
  for (const Json& item : value->items) {
    if (item.type != Json::Type::Number) fail_member(item, key, expected, item.describe());
    if (!within(item.number, bounds)) fail_member(item, key, expected, shortest(item.number));
    result.push_back(item.number);
  }
  return result;
}

const std::vector<Json>& JsonReader::array(std::string_view key) {
  static const std::vector<Json> kNone;
  const Json* const value = child(key);
  if (!value) return kNone;
  if (value->type != Json::Type::Array) fail_member(*value, key, "an array", value->describe());
  return value->items;
}

void JsonReader::finish() const {
  for (const auto& [name, value] : json_->members) {
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    std::vector<std::string_view> known(known_.begin(), known_.end());
    std::string hint = meant(name, known);
    if (hint.empty()) {
      std::sort(known.begin(), known.end());
      hint = known.empty() ? "; no key is known here" : "; known are " + listed(known);
    }
    throw InputError(value.place() + ": key " + in_quotes(name) + ": unknown" + hint);
  }
}

}  // namespace outcrop
