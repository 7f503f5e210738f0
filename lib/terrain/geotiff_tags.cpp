#include "geotiff_tags.h"

#include <tiffio.h>

#include <cstdint>
#include <memory>
#include <type_traits>

namespace outcrop::terrain {
namespace {

constexpr std::uint32_t kModelPixelScale = 33550;
constexpr std::uint32_t kModelTiepoint = 33922;
constexpr std::uint32_t kModelTransformation = 34264;
constexpr std::uint32_t kGeoKeyDirectory = 34735;
constexpr std::uint32_t kGdalNodata = 42113;

constexpr int kModelTypeKey = 1024;
constexpr int kRasterTypeKey = 1025;
constexpr int kLinearUnitKey = 3076;
constexpr int kVerticalUnitKey = 4099;

/// libtiff calls this instead of its default handlers, which print.
int stay_silent(TIFF*, void*, const char*, const char*, va_list) { return 1; }

template <class T>
constexpr TIFFDataType data_type() {
  if constexpr (std::is_same_v<T, double>) return TIFF_DOUBLE;
  if constexpr (std::is_same_v<T, std::uint16_t>) return TIFF_SHORT;
  if constexpr (std::is_same_v<T, char>) return TIFF_ASCII;
}

/// The values of a tag that libtiff itself does not know: it then keeps whatever type stands in the file, so that the
/// type has to be looked at before the memory is.
template <class T>
std::vector<T> tag_values(TIFF* tiff, std::uint32_t tag) {
  const TIFFField* const field = TIFFFindField(tiff, tag, TIFF_ANY);
  if (!field || TIFFFieldDataType(field) != data_type<T>() || !TIFFFieldPassCount(field)) return {};
  const void* values = nullptr;
  std::uint32_t count = 0;
  if (TIFFFieldReadCount(field) == TIFF_VARIABLE2) {
    if (!TIFFGetField(tiff, tag, &count, &values)) return {};
  } else {  // Another library of the program may have described the tag with a short count.
    std::uint16_t short_count = 0;
    if (!TIFFGetField(tiff, tag, &short_count, &values)) return {};
    count = short_count;
  }
  const T* const first = static_cast<const T*>(values);
  return first ? std::vector<T>(first, first + count) : std::vector<T>{};
}

/// A key whose value is a short in the directory itself: entries of key, tag (0 for "here"), count, value.
std::optional<int> short_key(const std::vector<std::uint16_t>& directory, int key) {
  for (std::size_t i = 4; i + 3 < directory.size(); i += 4) {
    if (directory[i] == key && directory[i + 1] == 0) return directory[i + 3];
  }
  return std::nullopt;
}

}  // namespace

std::optional<GeotiffTags> read_geotiff_tags(const std::filesystem::path& path) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 &TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), stay_silent, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), stay_silent, nullptr);
  const std::unique_ptr<TIFF, decltype(&TIFFClose)> file(TIFFOpenExt(path.c_str(), "r", options.get()), &TIFFClose);
  if (!file) return std::nullopt;

  GeotiffTags tags;
  tags.pixel_scale = tag_values<double>(file.get(), kModelPixelScale);
  tags.tie_points = tag_values<double>(file.get(), kModelTiepoint);
  tags.transformation = tag_values<double>(file.get(), kModelTransformation);
  if (const auto text = tag_values<char>(file.get(), kGdalNodata); !text.empty()) {
    const std::string whole(text.begin(), text.end());
    tags.nodata = whole.substr(0, whole.find('\0'));
  }
  const auto directory = tag_values<std::uint16_t>(file.get(), kGeoKeyDirectory);
  tags.model_type = short_key(directory, kModelTypeKey);
  tags.raster_type = short_key(directory, kRasterTypeKey);
  tags.linear_unit = short_key(directory, kLinearUnitKey);
  tags.vertical_unit = short_key(directory, kVerticalUnitKey);
  return tags;
}

}  // namespace outcrop::terrain
