#include "png_chunks.h"

#include <array>
#include <cctype>
#include <cstdint>

namespace outcrop::png {

namespace {

// PNG specification, third edition (W3C 2025): 5.2 signature, 5.3 chunk layout, 5.5 checksum.
constexpr std::string_view kSignature = "\x89PNG\r\n\x1A\n";
constexpr std::size_t kChunkFrame = 12;  // length, name, checksum: four bytes each
constexpr std::uint32_t kPolynomial = 0xEDB88320u;

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t v = 0;
  for (const char c : bytes.substr(0, 4)) v = v << 8 | static_cast<unsigned char>(c);
  return v;
}

std::uint32_t checksum(std::string_view bytes) {
  static constexpr auto kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int bit = 0; bit < 8; ++bit) c = c & 1 ? kPolynomial ^ c >> 1 : c >> 1;
      table[n] = c;
    }
    return table;
  }();
  std::uint32_t c = 0xFFFFFFFFu;
  for (const char byte : bytes) c = kTable[(c ^ static_cast<unsigned char>(byte)) & 0xFF] ^ c >> 8;
  return ~c;
}

bool decides_pixels(std::string_view name) {
  return name == "IHDR" || name == "PLTE" || name == "tRNS" || name == "IDAT" || name == "IEND";
}

/// What libpng would refuse in an IHDR's 13 bytes, or "". PNG specification, third edition, section 11.2.1.
std::string header_problem(std::string_view data) {
  if (data.size() != 13) return "a header of " + std::to_string(data.size()) + " bytes";
  const std::uint32_t width = big_endian(data), height = big_endian(data.substr(4));
  constexpr std::uint32_t kLargest = 1'000'000;  // libpng's own limit.
  if (width == 0 || height == 0 || width > kLargest || height > kLargest)
    return std::to_string(width) + " x " + std::to_string(height) + " pixels";
  const int depth = static_cast<unsigned char>(data[8]), colour = static_cast<unsigned char>(data[9]);
  const bool grey = colour == 0, palette = colour == 3, rgb_or_alpha = colour == 2 || colour == 4 || colour == 6;
  const bool low = depth == 1 || depth == 2 || depth == 4;
  const bool fits = depth == 8 || (depth == 16 && !palette) || (low && !rgb_or_alpha);
  if (!(grey || palette || rgb_or_alpha) || !fits)
    return "colour type " + std::to_string(colour) + " with " + std::to_string(depth) + " bits";
  if (data[10] != 0 || data[11] != 0 || static_cast<unsigned char>(data[12]) > 1) return "an unknown way of packing";
  return {};
}

}  // namespace

bool is_png(std::string_view bytes) noexcept { return bytes.starts_with(kSignature); }

Reduced reduced(std::string_view bytes) {
  std::string result(kSignature);
  for (std::size_t at = kSignature.size(); at < bytes.size();) {
    const std::string place = " at byte " + std::to_string(at);
    if (bytes.size() - at < kChunkFrame) return {{}, "it ends inside a chunk's header" + place};
    const std::size_t length = big_endian(bytes.substr(at));
    const std::string_view name = bytes.substr(at + 4, 4);
    for (const char c : name) {
      if (!std::isalpha(static_cast<unsigned char>(c))) return {{}, "no chunk's name" + place};
    }
    const std::string chunk = "chunk " + std::string(name);
    if (length > bytes.size() - at - kChunkFrame) return {{}, "it ends inside " + chunk + place};
    const std::string_view whole = bytes.substr(at, length + kChunkFrame);
    if (decides_pixels(name)) {
      if (checksum(whole.substr(4, length + 4)) != big_endian(whole.substr(length + 8))) {
        return {{}, "wrong checksum of " + chunk + place};
      }
      if (name == "IHDR")
        if (const std::string problem = header_problem(whole.substr(8, length)); !problem.empty()) return {{}, problem};
      result += whole;
    }
    if (name == "IEND") return {std::move(result), {}};
    at += whole.size();
  }
  return {{}, "it ends before its last chunk"};
}

}  // namespace outcrop::png
