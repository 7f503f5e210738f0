/// Text of an SVG picture, element by element.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "outcrop/core/vec.h"

namespace outcrop {

/// A number for SVG and tables: `digits` significant ones, no trailing zeros, no exponent between 1e-3 and 1e6.
[[nodiscard]] std::string short_number(double value, int digits = 3);
/// With &, <, > and " as entities.
[[nodiscard]] std::string escaped(std::string_view text);

struct Paint {
  std::string_view fill = "none";
  std::string_view stroke = "none";
  double width = 1.0;  ///< Of the stroke, px.
  double opacity = 1.0;
  std::string_view dash = "";
};

struct TextStyle {
  double size = 12.0;                 ///< px.
  std::string_view anchor = "start";  ///< start, middle, end.
  std::string_view fill = "#222";
  bool bold = false;
  double turn_deg = 0.0;  ///< Clockwise.
};

/// Elements in pixels, x to the right, y down, in the order in which they are drawn.
class Svg {
 public:
  void line(const Vec2& a, const Vec2& b, const Paint& paint);
  void polyline(std::span<const Vec2> points, const Paint& paint);
  void polygon(std::span<const Vec2> points, const Paint& paint);
  void circle(const Vec2& centre, double radius, const Paint& paint);
  void rect(const Vec2& corner, const Vec2& size, const Paint& paint);
  void text(const Vec2& at, std::string_view words, const TextStyle& style = {});

  /// Everything so far as one document.
  [[nodiscard]] std::string document(const Vec2& size, std::string_view title) const;

 private:
  void points(std::string_view element, std::span<const Vec2> points, const Paint& paint);
  void paint(const Paint& paint);

  std::string body_;
};

}  // namespace outcrop
