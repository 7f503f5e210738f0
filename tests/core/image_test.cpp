#include "outcrop/core/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/scratch.h"
#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/core/rng.h"

namespace outcrop {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::Scratch;

Image noise(int width, int height, int channels, Seed seed = 1) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = channels;
  Rng rng(seed, "image");
  for (int i = 0; i < width * height * channels; ++i)
    image.pixels.push_back(static_cast<float>(rng.uniform(-0.2, 1.2)));
  return image;
}

void put(const fs::path& path, std::string_view bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string refusal(const fs::path& path) {
  const std::string message = message_of<InputError>([&] { (void)read_image(path); });
  EXPECT_EQ(message.find('\n'), message.npos) << message;
  EXPECT_TRUE(message.starts_with(path.string() + ": expected a readable image, got ")) << message;
  return message;
}

// Little-endian, one strip, no compression: the plainest TIFF there is.
class Tiff {
 public:
  Tiff(int width, int height, int bits, int sample_format, std::string pixels) {
    const auto u16 = [](unsigned v) { return std::string{static_cast<char>(v), static_cast<char>(v >> 8)}; };
    const auto u32 = [&](unsigned v) { return u16(v & 0xFFFF) + u16(v >> 16); };
    const auto entry = [&](unsigned tag, unsigned value) { return u16(tag) + u16(4) + u32(1) + u32(value); };
    const unsigned w = width, h = height;
    bytes = "II" + u16(42) + u32(8) + u16(10) + entry(256, w) + entry(257, h) + entry(258, bits) + entry(259, 1) +
            entry(262, 1) + entry(273, 8 + 2 + 10 * 12 + 4) + entry(277, 1) + entry(278, h) +
            entry(279, w * h * bits / 8) + entry(339, sample_format) + u32(0) + pixels;
  }
  std::string bytes;
};

template <class T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

TEST(ReadImage, KeepsNativeIntegerValues) {
  const Scratch folder;
  const fs::path path = folder / "a.tif";
  const auto reads = [&](int bits, int format, const std::string& pixels, double full_scale,
                         std::vector<float> expected) {
    put(path, Tiff(2, 2, bits, format, pixels).bytes);
    const Image image = read_image(path);
    EXPECT_EQ(image.width * 10 + image.height, 22);
    EXPECT_EQ(image.full_scale, full_scale);
    EXPECT_EQ(image.pixels, expected) << bits << " bits, format " << format;
  };
  reads(8, 1, raw<std::uint8_t>({0, 1, 200, 255}), 255.0, {0, 1, 200, 255});
  reads(16, 1, raw<std::uint16_t>({0, 1200, 40000, 65535}), 65535.0, {0, 1200, 40000, 65535});
  reads(16, 2, raw<std::int16_t>({-32768, -1, 1200, 32767}), 32767.0, {-32768, -1, 1200, 32767});
  reads(32, 1, raw<std::uint32_t>({0, 1, 70000, 1u << 31}), 4294967295.0, {0, 1, 70000, 2147483648.0f});
  reads(32, 2, raw<std::int32_t>({-70000, -1, 0, 70000}), 2147483647.0, {-70000, -1, 0, 70000});
  reads(32, 3, raw<float>({-1.5f, 0.0f, 1234.5f, 1e9f}), 1.0, {-1.5f, 0.0f, 1234.5f, 1e9f});
  reads(64, 3, raw<double>({-1.5, 0.0, 1234.5, 1e9}), 1.0, {-1.5f, 0.0f, 1234.5f, 1e9f});
}

TEST(WriteImage, KeepsFloatsAndChannelNamesInExr) {
  const Scratch folder;
  Image image = noise(33, 70, 3);
  image.channel_names = {"depth.Z", "normal.X", "normal.Y"};
  image.at(3, 4, 1) = -1e30f;
  write_image(folder / "a.exr", image);
  const Image back = read_image(folder / "a.exr");
  EXPECT_EQ(back.channel_names, image.channel_names);
  EXPECT_EQ(back.pixels, image.pixels);
  EXPECT_EQ(back.full_scale, 1.0);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteImage, RoundsAndClampsInPngWhateverTheAlpha) {
  const Scratch folder;
  for (int channels = 1; channels <= 4; ++channels) {
    Image image = noise(31, 17, channels);
    image.pixels.front() = std::nanf("");
    write_image(folder / "a.PNG", image);
    const Image back = read_image(folder / "a.PNG");
    ASSERT_EQ(back.channels, channels);
    EXPECT_EQ(back.full_scale, 255.0);
    EXPECT_EQ(back.pixels.front(), 0.0f);
    for (std::size_t i = 1; i < image.pixels.size(); ++i) {
      ASSERT_NEAR(back.pixels[i], 255.0f * std::clamp(image.pixels[i], 0.0f, 1.0f), 0.501f);
    }
  }
}

TEST(WriteImage, GivesTheSameBytesTwice) {
  const Scratch folder;
  for (const char* name : {"a.png", "a.exr"}) {
    write_image(folder / name, noise(40, 30, 3));
    const std::string first = read_text(folder / name);
    ::sleep(1);  // a time stamp would show
    write_image(folder / name, noise(40, 30, 3));
    EXPECT_TRUE(read_text(folder / name) == first) << name;
  }
}

TEST(WriteImage, RefusesWhatItCannotWrite) {
  const Scratch folder;
  const Image image = noise(4, 4, 1);
  EXPECT_EQ(message_of<ParameterError>([&] { write_image(folder / "a.jpg", image); }),
            (folder / "a.jpg").string() + ": expected the extension .png or .exr, got .jpg");
  EXPECT_THROW(write_image(folder / "a.png", Image{}), ParameterError);
  EXPECT_THROW(write_image(folder / "a.png", noise(4, 4, 5)), ParameterError);
  EXPECT_THROW(write_image(folder / "none/a.png", image), ParameterError);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(ReadImage, RefusesWhatIsNoImage) {
  const Scratch folder;
  const auto ends = [](const std::string& text, std::string_view end) { return text.ends_with(end); };
  EXPECT_TRUE(ends(refusal(folder / "none.exr"), "got none"));
  EXPECT_TRUE(ends(refusal(folder.path()), "got a folder"));
  put(folder / "empty.tif", "");
  EXPECT_TRUE(ends(refusal(folder / "empty.tif"), "got an empty file"));
  for (const char* name : {"text.png", "text.exr", "text.tif", "text.jpg", "text.hdr", "text"}) {
    put(folder / name, "this is no picture\n");
    EXPECT_NE(refusal(folder / name), "");
  }
}

TEST(ReadImage, ReadsAFileWhoseExtensionIsWrong) {
  const Scratch folder;
  const Image image = noise(5, 6, 1);
  write_image(folder / "a.exr", image);
  fs::rename(folder / "a.exr", folder / "a.png");
  EXPECT_EQ(read_image(folder / "a.png").pixels, image.pixels);
}

TEST(ReadImage, RefusesTruncatedFilesWhereverTheyEnd) {
  const Scratch folder;
  write_image(folder / "a.exr", noise(64, 200, 1));
  write_image(folder / "a.png", noise(64, 200, 1));
  put(folder / "a.tif", Tiff(64, 200, 32, 3, raw(noise(64, 200, 1).pixels)).bytes);
  for (const char* name : {"a.exr", "a.png", "a.tif"}) {
    const std::string whole = read_text(folder / name);
    for (std::uint64_t i = 0; i < 40; ++i) {
      // From the header alone to all but a fortieth; half the cuts fall into the pixels' second half.
      const std::size_t length = 1 + (whole.size() * i) / 41;
      put(folder / name, std::string_view(whole).substr(0, length));
      EXPECT_NE(refusal(folder / name), "") << name << " cut to " << length << " of " << whole.size();
    }
  }
}

TEST(ReadImage, RefusesSizesThatNoFileHolds) {
  const Scratch folder;
  put(folder / "zero.tif", Tiff(0, 0, 8, 1, "").bytes);
  EXPECT_NE(refusal(folder / "zero.tif"), "");
  put(folder / "vast.tif", Tiff(60'000, 60'000, 8, 1, "x").bytes);
  EXPECT_NE(refusal(folder / "vast.tif"), "");
  put(folder / "big.tif", Tiff(40'000, 40'000, 8, 1, "x").bytes);
  EXPECT_NE(refusal(folder / "big.tif"), "");
}

TEST(ReadImage, ReadsOnePixel) {
  const Scratch folder;
  write_image(folder / "a.exr", noise(1, 1, 1));
  EXPECT_EQ(read_image(folder / "a.exr").pixels, noise(1, 1, 1).pixels);
}

TEST(ReadImage, SurvivesDamagedBytes) {
  const Scratch folder;
  write_image(folder / "a.exr", noise(20, 40, 2));
  write_image(folder / "a.png", noise(20, 40, 2));
  put(folder / "a.tif", Tiff(20, 40, 32, 3, raw(noise(20, 40, 1).pixels)).bytes);
  for (const char* name : {"a.exr", "a.png", "a.tif"}) {
    const std::string whole = read_text(folder / name);
    for (std::uint64_t i = 0; i < 100; ++i) {
      Rng rng(2, name, i);
      std::string damaged = whole;
      const std::size_t range = i % 2 ? damaged.size() : std::min<std::size_t>(damaged.size(), 200);
      damaged[rng.below(range)] = static_cast<char>(rng.below(256));
      put(folder / name, damaged);
      try {
        const Image image = read_image(folder / name);
        EXPECT_EQ(image.pixels.size(), static_cast<std::size_t>(image.width) * image.height * image.channels);
      } catch (const InputError& e) {
        EXPECT_EQ(std::string_view(e.what()).find('\n'), std::string_view::npos) << e.what();
      }
    }
  }
}

}  // namespace
}  // namespace outcrop
