/// What a PNG decoder needs of a file, and a check of it: libpng prints its complaints, and nothing here may print.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace outcrop::png {

/// Whether the file starts as a PNG does.
[[nodiscard]] bool is_png(std::string_view bytes) noexcept;

/// The file with only the chunks that decide its pixels: IHDR, PLTE, tRNS, IDAT, IEND, each with a right checksum.
/// Colour profiles and texts go: broken ones are common and libpng warns of each.
/// @return The reduced file; or none, and in `problem` what is wrong.
struct Reduced {
  std::optional<std::string> bytes;
  std::string problem;
};
[[nodiscard]] Reduced reduced(std::string_view bytes);

}  // namespace outcrop::png
