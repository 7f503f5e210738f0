#include "outcrop/core/error.h"

#include <gtest/gtest.h>

#include <array>

#include "core/scratch.h"

namespace outcrop {
namespace {

TEST(Require, NamesParameterBoundAndValue) {
  EXPECT_EQ(test::message_of<ParameterError>([] { require(false, "radius", "> 0", -0.1); }),
            "radius: expected > 0, got -0.1");
  EXPECT_NO_THROW(require(true, "radius", "> 0", 1.0));
}

TEST(NearestName, FindsSlipsAndRefusesGuesses) {
  constexpr std::array<std::string_view, 4> known{"slope", "slope_fade", "distance", "cell_size"};
  const auto nearest = [&](std::string_view name) { return nearest_name(name, known.data(), known.size()); };
  EXPECT_EQ(nearest("slop"), "slope");
  EXPECT_EQ(nearest("solpe"), "slope");
  EXPECT_EQ(nearest("slopefade"), "slope_fade");
  EXPECT_EQ(nearest("cell-size"), "cell_size");
  EXPECT_EQ(nearest("distnace"), "distance");
  EXPECT_EQ(nearest("colour"), "");
  EXPECT_EQ(nearest("x"), "");
  EXPECT_EQ(nearest(""), "");
}

}  // namespace
}  // namespace outcrop
