#include "outcrop/core/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <system_error>
#include <type_traits>

#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "png_chunks.h"

namespace outcrop {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxValues = std::size_t{1} << 31;
constexpr int kRowsAtOnce = 64;  // So that a truncated file that claims to be huge fails before it has cost its memory.

// OpenImageIO's complaints may run over several lines and end in full stops.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

template <class T>
void to_floats(const std::vector<std::byte>& bytes, std::size_t count, std::size_t stride, float* to) {
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    to[i * stride] = static_cast<float>(value);
  }
}

struct Native {
  void (*convert)(const std::vector<std::byte>&, std::size_t, std::size_t, float*);
  OIIO::TypeDesc type;  ///< As which the samples are read: that of the file, except that half is widened.
  double full_scale;
};

template <class T>
Native native(OIIO::TypeDesc type) {
  return {to_floats<T>, type, std::is_floating_point_v<T> ? 1.0 : static_cast<double>(std::numeric_limits<T>::max())};
}

Native native_of(OIIO::TypeDesc type) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return native<std::uint8_t>(type);
    case OIIO::TypeDesc::INT8:
      return native<std::int8_t>(type);
    case OIIO::TypeDesc::UINT16:
      return native<std::uint16_t>(type);
    case OIIO::TypeDesc::INT16:
      return native<std::int16_t>(type);
    case OIIO::TypeDesc::UINT32:
      return native<std::uint32_t>(type);
    case OIIO::TypeDesc::INT32:
      return native<std::int32_t>(type);
    case OIIO::TypeDesc::DOUBLE:
      return native<double>(type);
    default:
      return native<float>(OIIO::TypeDesc::FLOAT);
  }
}

class Reader {
 public:
  explicit Reader(const fs::path& path) : path_(path) {
    std::error_code error;
    const fs::file_status found = fs::status(path, error);
    if (found.type() == fs::file_type::not_found) fail("none");
    if (fs::is_directory(found)) fail("a folder");
    if (fs::is_regular_file(found) && fs::file_size(path, error) == 0 && !error) fail("an empty file");
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);  // heights must not be multiplied by an alpha channel
    open_png(hints);
    if (!input_) input_ = OIIO::ImageInput::open(path.string(), &hints);
    if (!input_) fail(one_line(OIIO::geterror()));
    input_->threads(1);
  }

  [[nodiscard]] Image read() {
    const OIIO::ImageSpec& spec = input_->spec();
    if (spec.deep) fail("a deep image");
    if (spec.depth > 1) fail("a volume of " + std::to_string(spec.depth) + " slices");
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) fail(extent(spec) + ", which has no pixels");
    const std::size_t values = static_cast<std::size_t>(spec.width) * spec.height * spec.nchannels;
    if (static_cast<double>(spec.width) * spec.height * spec.nchannels > static_cast<double>(kMaxValues)) {
      fail(extent(spec) + ", which is more than 2^31 values");
    }
    Image image;
    image.width = spec.width;
    image.height = spec.height;
    image.channels = spec.nchannels;
    image.full_scale = native_of(spec.channelformat(0)).full_scale;
    for (int c = 0; c < spec.nchannels; ++c) image.channel_names.push_back(spec.channel_name(c));
    image.pixels.reserve(values);
    const int rows_at_once = spec.tile_width ? spec.tile_height : kRowsAtOnce;
    for (int row = 0; row < spec.height; row += rows_at_once) {
      const int rows = std::min(rows_at_once, spec.height - row);
      image.pixels.resize(static_cast<std::size_t>(row + rows) * spec.width * spec.nchannels);
      read_rows(image, row, rows);
    }
    return image;
  }

 private:
  [[noreturn]] void fail(const std::string& got) const {
    throw InputError(path_.string() + ": expected a readable image, got " + got);
  }

  // Where the file is a PNG: from memory, without what makes libpng print.
  void open_png(const OIIO::ImageSpec& hints) {
    char head[8] = {};
    std::ifstream(path_, std::ios::binary).read(head, sizeof head);
    if (!png::is_png({head, sizeof head})) return;
    const png::Reduced file = png::reduced(read_text(path_));
    if (!file.bytes) fail("a damaged one (" + file.problem + ")");
    png_ = *file.bytes;
    memory_ = std::make_unique<OIIO::Filesystem::IOMemReader>(png_.data(), png_.size());
    input_ = OIIO::ImageInput::open("from-memory.png", &hints, memory_.get());
  }

  static std::string extent(const OIIO::ImageSpec& spec) {
    return std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels of " +
           std::to_string(spec.nchannels) + " channels";
  }

  // Channels of one type are read together; files that mix types give each in its own, so that integers stay whole.
  void read_rows(Image& image, int row, int rows) {
    const OIIO::ImageSpec& spec = input_->spec();
    const bool mixed = !spec.channelformats.empty();
    const std::size_t first = static_cast<std::size_t>(row) * spec.width * spec.nchannels;
    const std::size_t pixels = static_cast<std::size_t>(rows) * spec.width;
    for (int c = 0; c < spec.nchannels; c += mixed ? 1 : spec.nchannels) {
      const int channels = mixed ? 1 : spec.nchannels;
      const Native kind = native_of(spec.channelformat(c));
      bytes_.resize(pixels * channels * kind.type.size());
      const int y0 = spec.y + row;
      const int y1 = y0 + rows;
      const bool read = spec.tile_width
                            ? input_->read_tiles(0, 0, spec.x, spec.x + spec.width, y0, y1, spec.z, spec.z + 1, c,
                                                 c + channels, kind.type, bytes_.data())
                            : input_->read_scanlines(0, 0, y0, y1, spec.z, c, c + channels, kind.type, bytes_.data());
      if (!read || input_->has_error()) {
        fail("a damaged one (rows " + std::to_string(row) + " to " + std::to_string(row + rows - 1) + " of " +
             std::to_string(spec.height) + ": " + one_line(input_->geterror()) + ")");
      }
      kind.convert(bytes_, pixels * channels, mixed ? spec.nchannels : 1, image.pixels.data() + first + c);
    }
  }

  fs::path path_;
  std::string png_;
  std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;
  std::unique_ptr<OIIO::ImageInput> input_;
  std::vector<std::byte> bytes_;
};

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::vector<std::uint8_t> as_bytes(const std::vector<float>& pixels) {
  std::vector<std::uint8_t> bytes(pixels.size());
  std::transform(pixels.begin(), pixels.end(), bytes.begin(), [](float v) {
    return v > 0.0f ? static_cast<std::uint8_t>(std::min(v, 1.0f) * 255.0f + 0.5f) : std::uint8_t{0};  // NaN is 0 too
  });
  return bytes;
}

}  // namespace

Image read_image(const fs::path& path) { return Reader(path).read(); }

void write_image(const fs::path& path, const Image& image) {
  const std::string extension = lower_extension(path);
  const bool png = extension == ".png";
  require(png || extension == ".exr", path.string(), "the extension .png or .exr",
          extension.empty() ? "none" : extension);
  const std::string size = std::to_string(image.width) + " x " + std::to_string(image.height) + " x " +
                           std::to_string(image.channels) + " with " + std::to_string(image.pixels.size()) + " values";
  require(image.width > 0 && image.height > 0 && image.channels > 0 &&
              image.pixels.size() == static_cast<std::size_t>(image.width) * image.height * image.channels,
          "image", "width x height x channels > 0, and as many values", size);
  require(!png || image.channels <= 4, "image", "1 to 4 channels in a .png", size);

  OutputFile file(path);
  OIIO::ImageSpec spec(image.width, image.height, image.channels, png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
  if (image.channel_names.size() == static_cast<std::size_t>(image.channels)) spec.channelnames = image.channel_names;
  if (png) {
    spec.attribute("oiio:UnassociatedAlpha", 1);
  } else {
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else the time of writing: the same picture must be the same bytes
  }
  const auto expect = [&](bool holds, const std::string& why) {
    if (!holds) throw SystemError(path.string() + ": cannot be written: " + one_line(why) + "; what was there before is unchanged");
  };
  const std::string temporary = file.temporary_path().string();
  const auto output = OIIO::ImageOutput::create(temporary);
  expect(output != nullptr, OIIO::geterror());
  expect(output->open(temporary, spec), output->geterror());
  const bool written = png ? output->write_image(OIIO::TypeDesc::UINT8, as_bytes(image.pixels).data())
                           : output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data());
  expect(written, output->geterror());
  expect(output->close(), output->geterror());
  file.commit();
}

}  // namespace outcrop
