#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "outcrop/core/json.h"
#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

TEST(JsonWriter, WritesOneValueALineAndListsOfNumbersOnOne) {
  JsonWriter writer;
  writer.begin_object().value("count", 100'000.0).value("name", "a \"b\"\n").boolean("yes", true);
  writer.begin_array("list").item(1.0).item(0.1).item("x").end_array();
  writer.begin_array("rows").begin_object().value("i", 1.0).end_object().begin_object().end_object().end_array();
  writer.begin_object("nothing").end_object().value("nan", std::nan("")).end_object();
  EXPECT_EQ(writer.text(), R"({
  "count": 100000,
  "name": "a \"b\"\u000a",
  "yes": true,
  "list": [1, 0.1, "x"],
  "rows": [
    {
      "i": 1
    },
    {}
  ],
  "nothing": {},
  "nan": null
}
)");
}

TEST(JsonWriter, WritesNumbersThatReadBackTheSame) {
  JsonWriter writer;
  writer.begin_array();
  std::vector<double> numbers{0.0, -0.0, 1e300, 5e-324, 9007199254740993.0, 1e22, -1.5};
  Rng rng(1, "numbers");
  for (int i = 0; i < 1000; ++i)
    numbers.push_back(std::ldexp(rng.uniform(-1.0, 1.0), static_cast<int>(rng.below(600)) - 300));
  for (const double v : numbers) writer.item(v);
  writer.end_array();
  const Json json = parse_json(writer.text(), "numbers");
  ASSERT_EQ(json.items.size(), numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(json.items[i].number, numbers[i]);
}

}  // namespace
}  // namespace outcrop
