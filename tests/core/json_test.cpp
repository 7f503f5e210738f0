#include "outcrop/core/json.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/scratch.h"
#include "outcrop/core/error.h"
#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

using test::message_of;

std::string parse_failure(std::string_view text) {
  return message_of<InputError>([&] { (void)parse_json(text, "f"); });
}

TEST(ParseJson, KeepsValuesTheirOrderAndWhereTheyStand) {
  const Json json =
      parse_json("\xEF\xBB\xBF{\n  \"é\": [1, -2.5e1 ,\"a\\\"]\\u00e9\"],\n  \"b\" : {\"c\": true, \"d\": null}}", "f");
  ASSERT_EQ(json.members.size(), 2u);
  EXPECT_EQ(json.place(), "f:1:1");
  const Json& list = json.members[0].second;
  EXPECT_EQ(json.members[0].first, "é");
  EXPECT_EQ(list.place(), "f:2:3");
  ASSERT_EQ(list.items.size(), 3u);
  EXPECT_EQ(list.items[0].number, 1.0);
  EXPECT_EQ(list.items[1].number, -25.0);
  EXPECT_EQ(list.items[1].place(), "f:2:12");  // columns count characters, not bytes
  EXPECT_EQ(list.items[2].string, "a\"]é");
  EXPECT_EQ(list.items[2].place(), "f:2:20");
  const Json& object = json.members[1].second;
  EXPECT_EQ(object.place(), "f:3:3");
  EXPECT_EQ(object.members[0].second.place(), "f:3:10");
  EXPECT_TRUE(object.members[0].second.boolean);
  EXPECT_EQ(object.members[1].second.type, Json::Type::Null);
}

TEST(ParseJson, SaysWhereAndWhatWasExpected) {
  EXPECT_EQ(parse_failure(""), "f:1:1: expected a value, got an empty file");
  EXPECT_EQ(parse_failure(" \n "), "f:2:2: expected a value, got an empty file");
  EXPECT_EQ(parse_failure("{\n  \"a\": 1\n  \"b\": 2}"), "f:3:3: expected ',' or '}', got the string \"b\"");
  EXPECT_EQ(parse_failure("[1 2]"), "f:1:4: expected ',' or ']', got '2'");
  EXPECT_EQ(parse_failure("{\"a\" 1}"), "f:1:6: expected ':' after the key \"a\", got '1'");
  EXPECT_EQ(parse_failure("{\"a\": }"), "f:1:7: expected a value, got '}'");
  EXPECT_EQ(parse_failure("{\"a\": 1,}"), "f:1:9: expected a key in quotes, got '}'");
  EXPECT_EQ(parse_failure("[1,]"), "f:1:4: expected a value, got ']'");
  EXPECT_EQ(parse_failure("[1"), "f:1:3: expected ',' or ']', got the end of the file");
  EXPECT_EQ(parse_failure("{a: 1}"), "f:1:2: expected a key in quotes or '}', got 'a'");
  EXPECT_EQ(parse_failure("{} x"), "f:1:4: expected the end of the file, got 'x'");
  EXPECT_EQ(parse_failure("{\"a\": nan}"), "f:1:7: expected a value, got 'nan'");
  EXPECT_EQ(parse_failure("{\"a\": 01}"), "f:1:8: expected ',' or '}', got '1'");
  EXPECT_EQ(parse_failure("{\"a\": .5}"), "f:1:7: expected a value, got '.5'");
  EXPECT_EQ(parse_failure("{\"a\": 1e999}"), "f:1:7: expected a number that a double can hold, got '1e999'");
  EXPECT_EQ(parse_failure("// no\n{}"), "f:1:1: expected a value, got '/'");
  EXPECT_EQ(parse_failure("{\"a\": \"b\n\"}"), "f:1:9: expected the string's closing quote, got the end of the line");
  EXPECT_EQ(parse_failure("{\"a\": \"b"), "f:1:9: expected the string's closing quote, got the end of the file");
  EXPECT_EQ(parse_failure("[\"a\\qb\"]"), "f:1:5: expected a valid escape such as \\n or \\u00e9, got 'qb'");
  EXPECT_EQ(parse_failure("[\"a\xFF\"]"), "f:1:4: expected UTF-8 text, got other bytes");
  EXPECT_EQ(parse_failure("{\"a\": 1, \"b\": 2,\n \"a\": 3}"),
            "f:2:2: expected every key once, got \"a\" again; it stands in line 1 already");
}

TEST(ParseJson, RefusesDeepNestingWithoutExhaustingTheStack) {
  EXPECT_NO_THROW((void)parse_json(std::string(200, '[') + std::string(200, ']'), "f"));
  EXPECT_EQ(parse_failure(std::string(1'000'000, '[')),
            "f:1:201: expected at most 200 nested arrays and objects, got more");
}

TEST(ParseJson, AnswersDamagedTextWithOneLineOrAValue) {
  const std::string good = R"({"materials": [{"name": "é\n", "κ": 12.5e-1}, null, true, []], "t": {"a": -3}})";
  int refused = 0;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    Rng rng(1, "damage", i);
    std::string text = good;
    const auto changes = 1 + rng.below(3);
    for (std::uint64_t k = 0; k < changes; ++k) {
      const auto at = rng.below(text.size());
      switch (rng.below(4)) {
        case 0:
          text[at] = static_cast<char>(rng.below(256));
          break;
        case 1:
          text.erase(at, 1 + rng.below(4));
          break;
        case 2:
          text.insert(at, 1, "{}[],:\"\\0e- \n"[rng.below(13)]);
          break;
        default:
          text.resize(at + 1);
      }
    }
    const std::string message = parse_failure(text);
    if (message.empty()) continue;
    ++refused;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    EXPECT_NE(message.find(": expected "), message.npos) << message;
    EXPECT_NE(message.find(", got "), message.npos) << message;
  }
  EXPECT_GT(refused, 10'000);
}

TEST(ParseJson, TakesTimeLinearInTheText) {
  std::string text = "{";
  for (int i = 0; i < 200'000; ++i) text += (i ? ",\"k" : "\"k") + std::to_string(i) + "\":[" + std::to_string(i) + "]";
  EXPECT_EQ(parse_json(text + "}", "f").members.size(), 200'000u);  // one line: a quadratic reader never ends here
}

TEST(ReadJson, NamesTheFile) {
  const test::Scratch folder;
  std::ofstream(folder / "a.json") << "{\"a\": [}";
  EXPECT_EQ(message_of<InputError>([&] { (void)read_json(folder / "a.json"); }),
            (folder / "a.json").string() + ":1:8: expected a value or ']', got '}'");
}

TEST(JsonReader, GivesValuesOrTheirDefaults) {
  const Json json =
      parse_json(R"({"n": 2.5, "i": 3, "b": true, "s": "x", "c": "two", "v": [1, 2, 3], "a": [{}]})", "f");
  JsonReader reader(json);
  EXPECT_EQ(reader.number("n", 0.0), 2.5);
  EXPECT_EQ(reader.number("none", 7.0, {0.0, 1.0}), 7.0);
  EXPECT_EQ(reader.integer("i", 0, 0, 10), 3);
  EXPECT_TRUE(reader.boolean("b", false));
  EXPECT_EQ(reader.string("s", ""), "x");
  EXPECT_EQ(reader.string("t", "y"), "y");
  EXPECT_EQ(reader.choice("c", 0, {"one", "two"}), 1u);
  EXPECT_EQ(reader.numbers("v", {}, 3), (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(reader.array("a").size(), 1u);
  EXPECT_TRUE(reader.array("no").empty());
  EXPECT_EQ(reader.child("nobody"), nullptr);
  EXPECT_FALSE(reader.has("nothing"));
  EXPECT_NO_THROW(reader.finish());
}

TEST(JsonReader, NamesKeyBoundAndValue) {
  const Json json =
      parse_json(R"({"slope": 120, "k": "x", "i": 2.5, "zero": 0, "v": [1, -2], "c": "tow", "l": {}})", "f");
  JsonReader reader(json);
  const auto failure = [](auto&& call) { return message_of<InputError>(call); };
  EXPECT_EQ(failure([&] {
              (void)reader.number("slope", 0.0, {0.0, 90.0});
            }),
            "f:1:2: \"slope\": expected a number in [0, 90], got 120");
  EXPECT_EQ(failure([&] { (void)reader.number("k", 0.0); }), "f:1:16: \"k\": expected a number, got string \"x\"");
  EXPECT_EQ(failure([&] { (void)reader.number("zero", 1.0, {.lo = 0.0, .open_lo = true}); }),
            "f:1:36: \"zero\": expected a number > 0, got 0");
  EXPECT_EQ(failure([&] { (void)reader.integer("i", 0, 0, 9); }),
            "f:1:26: \"i\": expected an integer in [0, 9], got 2.5");
  EXPECT_EQ(failure([&] { (void)reader.numbers("v", {}, 2, {.lo = 0.0}); }),
            "f:1:56: \"v\": expected 2 numbers >= 0, got -2");
  EXPECT_EQ(failure([&] { (void)reader.numbers("v", {}, 3); }), "f:1:47: \"v\": expected 3 numbers, got 2");
  EXPECT_EQ(failure([&] {
              (void)reader.choice("c", 0, {"one", "two"});
            }),
            "f:1:61: \"c\": expected one of \"one\", \"two\", got \"tow\"; did you mean \"two\"?");
  EXPECT_EQ(failure([&] { (void)reader.array("l"); }), "f:1:73: \"l\": expected an array, got object");
  EXPECT_EQ(failure([&] { (void)reader.boolean("l", true); }), "f:1:73: \"l\": expected true or false, got object");
  EXPECT_EQ(failure([&] { JsonReader(json.members[4].second); }), "f:1:47: expected an object, got array");
}

TEST(JsonReader, RefusesKeysThatNobodyAskedFor) {
  const Json json = parse_json("{\"slope\": 1,\n \"slop\": 2}", "f");
  JsonReader reader(json);
  EXPECT_EQ(reader.number("slope", 0.0), 1.0);
  EXPECT_EQ(message_of<InputError>([&] { reader.finish(); }), "f:2:2: key \"slop\": unknown; did you mean \"slope\"?");
  JsonReader other(json);
  (void)other.has("colour");
  EXPECT_EQ(message_of<InputError>([&] { other.finish(); }), "f:1:2: key \"slope\": unknown; known are \"colour\"");
}

}  // namespace
}  // namespace outcrop
