#include "tile_figure_svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace outcrop {
namespace {

std::string pixels(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", v + 0.0);
  std::string result(text);
  while (result.back() == '0') result.pop_back();
  if (result.back() == '.') result.pop_back();
  return result == "-0" ? "0" : result;
}

std::string attribute(std::string_view name, double v) { return " " + std::string(name) + "=\"" + pixels(v) + "\""; }

std::string attribute(std::string_view name, std::string_view v) {
  return " " + std::string(name) + "=\"" + std::string(v) + "\"";
}

}  // namespace

std::string short_number(double value, int digits) {
  if (!std::isfinite(value)) return "∞";
  char text[48];
  const double size = std::abs(value);
  if (value != 0.0 && (size < 1e-3 || size >= 1e6)) {
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
  }
  const int whole = size < 1.0 ? 0 : static_cast<int>(std::floor(std::log10(size))) + 1;
  const int lead = size > 0.0 && size < 1.0 ? static_cast<int>(-std::floor(std::log10(size))) - 1 : 0;
  std::snprintf(text, sizeof text, "%.*f", std::max(0, digits - whole + lead), value);
  std::string result(text);
  if (result.find('.') != std::string::npos) {
    while (result.back() == '0') result.pop_back();
    if (result.back() == '.') result.pop_back();
  }
  return result;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else if (static_cast<unsigned char>(c) >= 0x20)  // XML knows no control characters
      result += c;
  }
  return result;
}

void Svg::paint(const Paint& paint) {
  body_ += attribute("fill", paint.fill);
  if (paint.stroke != "none") body_ += attribute("stroke", paint.stroke) + attribute("stroke-width", paint.width);
  if (paint.opacity < 1.0) body_ += attribute("opacity", paint.opacity);
  if (!paint.dash.empty()) body_ += attribute("stroke-dasharray", paint.dash);
  body_ += "/>\n";
}

void Svg::points(std::string_view element, std::span<const Vec2> points, const Paint& style) {
  body_ += "<" + std::string(element) + " points=\"";
  for (const Vec2& p : points) body_ += pixels(p.x) + "," + pixels(p.y) + " ";
  body_ += "\" stroke-linejoin=\"round\"";
  paint(style);
}

void Svg::line(const Vec2& a, const Vec2& b, const Paint& style) {
  body_ += "<line" + attribute("x1", a.x) + attribute("y1", a.y) + attribute("x2", b.x) + attribute("y2", b.y);
  paint(style);
}

void Svg::polyline(std::span<const Vec2> p, const Paint& style) { points("polyline", p, style); }

void Svg::polygon(std::span<const Vec2> p, const Paint& style) { points("polygon", p, style); }

void Svg::circle(const Vec2& centre, double radius, const Paint& style) {
  body_ += "<circle" + attribute("cx", centre.x) + attribute("cy", centre.y) + attribute("r", radius);
  paint(style);
}

void Svg::rect(const Vec2& corner, const Vec2& size, const Paint& style) {
  body_ += "<rect" + attribute("x", corner.x) + attribute("y", corner.y) + attribute("width", size.x) +
           attribute("height", size.y);
  paint(style);
}

void Svg::text(const Vec2& at, std::string_view words, const TextStyle& style) {
  body_ += "<text" + attribute("x", at.x) + attribute("y", at.y) + attribute("font-size", style.size) +
           attribute("fill", style.fill);
  if (style.anchor != "start") body_ += attribute("text-anchor", style.anchor);
  if (style.bold) body_ += attribute("font-weight", "bold");
  if (style.turn_deg != 0.0)
    body_ += attribute("transform", "rotate(" + pixels(style.turn_deg) + " " + pixels(at.x) + " " + pixels(at.y) + ")");
  body_ += ">" + escaped(words) + "</text>\n";
}

std::string Svg::document(const Vec2& size, std::string_view title) const {
  const std::string w = pixels(size.x);
  const std::string h = pixels(size.y);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + w + " " + h + "\" width=\"" + w + "\" height=\"" +
         h + "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n<title>" + escaped(title) +
         "</title>\n<rect width=\"" + w + "\" height=\"" + h + "\" fill=\"#fff\"/>\n" + body_ + "</svg>\n";
}

}  // namespace outcrop
