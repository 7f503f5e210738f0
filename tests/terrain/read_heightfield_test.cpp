#include "outcrop/terrain/read_heightfield.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "outcrop/core/error.h"
#include "outcrop/core/image.h"

namespace outcrop {
namespace {

namespace fs = std::filesystem;

/// A folder that a test owns.
class ReadHeightfield : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("outcrop_" + std::string(test->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

/// Expects the one-line InputError `path: expected …, got …` and gives its text.
std::string refusal(const fs::path& path, const HeightfieldOptions& options = {}) {
  try {
    (void)read_heightfield(path, options);
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind(path.string() + ": expected ", 0), 0u) << text;
    EXPECT_NE(text.find(", got "), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  ADD_FAILURE() << path << " was read";
  return {};
}

bool has_note(const HeightfieldFile& file, const std::string& part) {
  return std::any_of(file.notes.begin(), file.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

void write_bytes(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string read_bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Writes pixels of any type through OpenImageIO.
template <class T>
void write_picture(const fs::path& path, int width, int height, int channels, const std::vector<T>& pixels,
                   OIIO::TypeDesc type) {
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out);
  OIIO::ImageSpec spec(width, height, channels, type);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  ASSERT_TRUE(out->open(path.string(), spec));
  ASSERT_TRUE(out->write_image(type, pixels.data()));
  ASSERT_TRUE(out->close());
}

/// What a small GeoTIFF of floats says about itself.
struct Tags {
  std::vector<double> scale, tie_point, transformation;
  std::vector<std::uint16_t> keys;  ///< key, value pairs.
  std::string nodata;
};

const TIFFFieldInfo kFields[] = {
    {33550, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelPixelScale")},
    {33922, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelTiepoint")},
    {34264, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, const_cast<char*>("ModelTransformation")},
    {34735, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, const_cast<char*>("GeoKeyDirectory")},
    {42113, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, const_cast<char*>("GdalNodata")},
};

void write_geotiff(const fs::path& path, int width, int height, const std::vector<float>& samples, const Tags& tags) {
  TIFF* const tiff = TIFFOpen(path.c_str(), "w");
  ASSERT_TRUE(tiff);
  TIFFMergeFieldInfo(tiff, kFields, std::size(kFields));
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 1);
  const auto doubles = [&](std::uint32_t tag, const std::vector<double>& v) {
    if (!v.empty()) TIFFSetField(tiff, tag, static_cast<int>(v.size()), v.data());
  };
  doubles(33550, tags.scale);
  doubles(33922, tags.tie_point);
  doubles(34264, tags.transformation);
  std::vector<std::uint16_t> directory{1, 1, 0, static_cast<std::uint16_t>(tags.keys.size() / 2)};
  for (std::size_t i = 0; i + 1 < tags.keys.size(); i += 2) {
    for (const int v : {int{tags.keys[i]}, 0, 1, int{tags.keys[i + 1]}})
      directory.push_back(static_cast<std::uint16_t>(v));
  }
  if (!tags.keys.empty()) TIFFSetField(tiff, 34735, static_cast<int>(directory.size()), directory.data());
  if (!tags.nodata.empty()) TIFFSetField(tiff, 42113, tags.nodata.c_str());
  std::vector<float> row(static_cast<std::size_t>(width));
  for (int r = 0; r < height; ++r) {
    std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(r) * width, width, row.begin());
    ASSERT_EQ(TIFFWriteScanline(tiff, row.data(), static_cast<std::uint32_t>(r), 0), 1);
  }
  TIFFClose(tiff);
}

const std::vector<float> kSamples{1, 2, 3, 4, 5, 6};  // 3 x 2, rows from the north.

constexpr std::uint16_t kModelType = 1024, kRasterType = 1025, kLinearUnit = 3076, kVerticalUnit = 4099;

TEST_F(ReadHeightfield, ExrKeepsMetresAndNorthRowFirst) {
  write_image(file("h.exr"), {.width = 3, .height = 2, .channels = 1, .pixels = {1.5f, 2, 3, 4, -5, 1e5f}});
  const HeightfieldFile read = read_heightfield(file("h.exr"));
  EXPECT_EQ(read.grid.width, 3);
  EXPECT_EQ(read.grid.height, 2);
  EXPECT_EQ(read.grid.elevations, (std::vector<float>{1.5f, 2, 3, 4, -5, 1e5f}));
  EXPECT_EQ(read.grid.cell_x, 1.0);
  EXPECT_FALSE(read.grid.georeferenced);
  EXPECT_TRUE(has_note(read, "no cell size in the file: took 1 m"));
}

TEST_F(ReadHeightfield, SixteenBitPngKeepsItsUnits) {
  write_picture<std::uint16_t>(file("h.png"), 3, 2, 1, {0, 1, 1200, 40000, 65535, 9999}, OIIO::TypeDesc::UINT16);
  EXPECT_EQ(read_heightfield(file("h.png")).grid.elevations, (std::vector<float>{0, 1, 1200, 40000, 65535, 9999}));
}

TEST_F(ReadHeightfield, SignedTiffKeepsItsUnits) {
  write_picture<std::int16_t>(file("h.tif"), 3, 2, 1, {-400, 0, 1200, 32767, -32768, 5}, OIIO::TypeDesc::INT16);
  const HeightfieldFile read = read_heightfield(file("h.tif"));
  EXPECT_EQ(read.grid.at(0, 0), -400.0f);
  EXPECT_EQ(read.grid.at(0, 1), 32767.0f);
  EXPECT_TRUE(std::isnan(read.grid.at(1, 1)));
  EXPECT_TRUE(has_note(read, "1 samples of -32768"));
}

TEST_F(ReadHeightfield, EightBitColourTakesTheFirstChannelAndSaysSo) {
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < 6; ++i) {
    for (const int v : {10 * i, 77, 99}) pixels.push_back(static_cast<std::uint8_t>(v));
  }
  write_picture(file("h.png"), 3, 2, 3, pixels, OIIO::TypeDesc::UINT8);
  const HeightfieldFile read = read_heightfield(file("h.png"));
  EXPECT_EQ(read.grid.elevations, (std::vector<float>{0, 10, 20, 30, 40, 50}));
  EXPECT_TRUE(has_note(read, "3 channels: took the first, R"));
  EXPECT_TRUE(has_note(read, "8 bits"));
}

TEST_F(ReadHeightfield, AlphaDoesNotScaleHeights) {
  write_picture<std::uint16_t>(file("h.png"), 2, 2, 4,
                               {100, 0, 0, 6000, 200, 0, 0, 6000, 300, 0, 0, 0, 400, 0, 0, 65535},
                               OIIO::TypeDesc::UINT16);
  EXPECT_EQ(read_heightfield(file("h.png")).grid.elevations, (std::vector<float>{100, 200, 300, 400}));
}

TEST_F(ReadHeightfield, ScaleAndOffsetAndCellSizeAreTheCallers) {
  write_geotiff(file("h.tif"), 3, 2, kSamples, {.scale = {5, 5, 0}, .tie_point = {0, 0, 0, 100, 200, 0}});
  const HeightfieldFile read =
      read_heightfield(file("h.tif"), {.cell_size = 2.5, .height_scale = -2.0, .height_offset = 100.0});
  EXPECT_EQ(read.grid.elevations, (std::vector<float>{98, 96, 94, 92, 90, 88}));
  EXPECT_EQ(read.grid.cell_x, 2.5);
  EXPECT_EQ(read.grid.cell_y, 2.5);
}

TEST_F(ReadHeightfield, GeotiffCornerBecomesTheSouthWestSample) {
  // An area's tie point is its north-western corner: half a cell from the sample. A point's is the sample.
  const Tags area{.scale = {5, 4, 0}, .tie_point = {0, 0, 0, 1000, 2000, 0}, .keys = {kModelType, 1, kRasterType, 1}};
  write_geotiff(file("area.tif"), 3, 2, kSamples, area);
  Tags point = area;
  point.keys = {kModelType, 1, kRasterType, 2};
  write_geotiff(file("point.tif"), 3, 2, kSamples, point);
  const ElevationGrid of_area = read_heightfield(file("area.tif")).grid;
  EXPECT_EQ(of_area.cell_x, 5.0);
  EXPECT_EQ(of_area.cell_y, 4.0);
  EXPECT_EQ(of_area.origin, Vec2(1002.5, 1994.0));
  EXPECT_TRUE(of_area.georeferenced);
  EXPECT_EQ(read_heightfield(file("point.tif")).grid.origin, Vec2(1000.0, 1996.0));
}

TEST_F(ReadHeightfield, GeotiffTransformationWorksLikeScaleAndTiePoint) {
  write_geotiff(file("h.tif"), 3, 2, kSamples,
                {.transformation = {5, 0, 0, 1000, 0, -4, 0, 2000, 0, 0, 0, 0, 0, 0, 0, 1}});
  const ElevationGrid grid = read_heightfield(file("h.tif")).grid;
  EXPECT_EQ(grid.origin, Vec2(1002.5, 1994.0));
  EXPECT_EQ(grid.cell_y, 4.0);
  EXPECT_EQ(grid.elevations, kSamples);
}

TEST_F(ReadHeightfield, SouthUpAndMirroredRastersAreTurned) {
  write_geotiff(file("h.tif"), 3, 2, kSamples,
                {.transformation = {-5, 0, 0, 1000, 0, 4, 0, 2000, 0, 0, 0, 0, 0, 0, 0, 1}});
  const ElevationGrid grid = read_heightfield(file("h.tif")).grid;
  EXPECT_EQ(grid.elevations, (std::vector<float>{6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(grid.origin, Vec2(1000.0 - 12.5, 2002.0));
}

TEST_F(ReadHeightfield, TurnedAndSkewedRastersAreRefused) {
  const auto refused = [&](double a, double b, double c, double d) {
    write_geotiff(file("h.tif"), 3, 2, kSamples, {.transformation = {a, b, 0, 10, c, d, 0, 20, 0, 0, 0, 0, 0, 0, 0, 1}});
    return refusal(file("h.tif"));
  };
  EXPECT_EQ(refused(3, 4, 4, -3), file("h.tif").string() +
                                      ": expected a raster along its map's axes, got rows that run 53.13 degrees from the "
                                      "map's x axis, columns -53.13 from its y axis; gdalwarp makes one that lies straight");
  refused(5, 1, 0, -5);
  refused(0, 5, -5, 0);
}

// The numbers from here to the matrix are those of GDAL 3.10 on the same tags.
TEST_F(ReadHeightfield, ANegativeVerticalScaleMeansNorthUpAsInGdal) {
  write_geotiff(file("h.tif"), 3, 2, kSamples, {.scale = {5, -4, 0}, .tie_point = {0, 0, 0, 1000, 2000, 0}});
  const HeightfieldFile read = read_heightfield(file("h.tif"));
  EXPECT_EQ(read.grid.elevations, kSamples);
  EXPECT_EQ(read.grid.origin, Vec2(1002.5, 1994.0));
  EXPECT_EQ(read.grid.cell_y, 4.0);
  EXPECT_TRUE(has_note(read, "negative"));
}

TEST_F(ReadHeightfield, TiePointsMayStandAnywhereInTheRaster) {
  for (const std::uint16_t kind : {1, 2}) {
    Tags tags{.scale = {5, 4, 0}, .tie_point = {1.5, 2.5, 0, 1000, 2000, 0}, .keys = {kModelType, 1, kRasterType, kind}};
    write_geotiff(file("h.tif"), 3, 2, kSamples, tags);
    const double half = kind == 1 ? 0.5 : 0.0;
    EXPECT_EQ(read_heightfield(file("h.tif")).grid.origin, Vec2(1000 + (half - 1.5) * 5, 2000 + (2.5 - half - 1) * 4));
    // A second tie point changes nothing.
    tags.tie_point.insert(tags.tie_point.end(), {2, 2, 0, 7, 7, 7});
    write_geotiff(file("two.tif"), 3, 2, kSamples, tags);
    EXPECT_EQ(read_heightfield(file("two.tif")).grid.origin, read_heightfield(file("h.tif")).grid.origin);
  }
}

TEST_F(ReadHeightfield, TheMatrixOfAPixelThatIsAPointGivesItsCentre) {
  const std::vector<double> matrix{5, 0, 0, 1000, 0, -4, 0, 2000, 0, 0, 0, 0, 0, 0, 0, 1};
  write_geotiff(file("h.tif"), 3, 2, kSamples, {.transformation = matrix, .keys = {kModelType, 1, kRasterType, 2}});
  EXPECT_EQ(read_heightfield(file("h.tif")).grid.origin, Vec2(1000, 1996));
  // Where both stand, scale and tie point count.
  write_geotiff(file("both.tif"), 3, 2, kSamples,
                {.scale = {2, 2, 0}, .tie_point = {0, 0, 0, 10, 20, 0}, .transformation = matrix});
  EXPECT_EQ(read_heightfield(file("both.tif")).grid.origin, Vec2(11, 17));
}

TEST_F(ReadHeightfield, DegreesBecomeMetresAtTheMiddleLatitude) {
  // WGS 84 at 60 degrees: 55 800 m a degree of longitude, 111 412 m of latitude.
  write_geotiff(file("h.tif"), 3, 2, kSamples,
                {.scale = {0.01, 0.01, 0}, .tie_point = {0, 0, 0, 10, 60.01, 0}, .keys = {kModelType, 2}});
  const HeightfieldFile read = read_heightfield(file("h.tif"));
  EXPECT_NEAR(read.grid.cell_x, 558.0, 0.1);
  EXPECT_NEAR(read.grid.cell_y, 1114.12, 0.1);
  EXPECT_NEAR(read.grid.origin.x / read.grid.cell_x, 1000.5, 1e-6);
  EXPECT_TRUE(has_note(read, "degrees"));
}

TEST_F(ReadHeightfield, FeetBecomeMetres) {
  write_geotiff(file("h.tif"), 3, 2, kSamples,
                {.scale = {10, 10, 0},
                 .tie_point = {0, 0, 0, 0, 0, 0},
                 .keys = {kModelType, 1, kLinearUnit, 9002, kVerticalUnit, 9003}});
  const HeightfieldFile read = read_heightfield(file("h.tif"));
  EXPECT_DOUBLE_EQ(read.grid.cell_x, 3.048);
  EXPECT_FLOAT_EQ(read.grid.at(2, 1), static_cast<float>(6.0 * 1200.0 / 3937.0));
  EXPECT_TRUE(has_note(read, "feet"));
}

TEST_F(ReadHeightfield, NodataTagsAndCustomsBecomeNan) {
  const float lowest = -3.4028234663852886e38f;
  for (const std::string tag : {"-3.4028234663852886e+38", "-3.40282346638529e+38", " -1.7976931348623157e+308 "}) {
    write_geotiff(file("h.tif"), 3, 2, {lowest, 2, -9999, INFINITY, NAN, 6}, {.nodata = tag});
    const HeightfieldFile read = read_heightfield(file("h.tif"));
    for (const int i : {0, 2, 3, 4}) EXPECT_TRUE(std::isnan(read.grid.elevations[static_cast<std::size_t>(i)])) << i;
    EXPECT_EQ(read.grid.at(1, 0), 2.0f);
    EXPECT_TRUE(has_note(read, "1 samples of -9999"));
    EXPECT_TRUE(has_note(read, "infinity"));
  }
  write_geotiff(file("zero.tif"), 3, 2, {0, 2, 3, 4, 5, 0}, {.nodata = "0"});
  EXPECT_TRUE(std::isnan(read_heightfield(file("zero.tif")).grid.at(0, 0)));
  write_geotiff(file("odd.tif"), 3, 2, kSamples, {.nodata = "none"});
  EXPECT_TRUE(has_note(read_heightfield(file("odd.tif")), "nodata tag is no number"));
}

TEST_F(ReadHeightfield, UselessGeotiffTagsAreIgnored) {
  for (const Tags& tags :
       {Tags{.scale = {0, 0, 0}, .tie_point = {0, 0, 0, 0, 0, 0}}, Tags{.scale = {5}},
        Tags{.scale = {NAN, 1, 0}, .tie_point = {0, 0, 0, 0, 0, 0}}, Tags{.tie_point = {0, 0, 0, 5, 5, 0}}}) {
    write_geotiff(file("h.tif"), 3, 2, kSamples, tags);
    const HeightfieldFile read = read_heightfield(file("h.tif"));
    EXPECT_EQ(read.grid.cell_x, 1.0);
    EXPECT_FALSE(read.grid.georeferenced);
  }
}

std::string hgt_bytes(const std::vector<int>& samples) {
  std::string bytes;
  for (const int v : samples) {
    bytes += static_cast<char>((v >> 8) & 0xFF);
    bytes += static_cast<char>(v & 0xFF);
  }
  return bytes;
}

TEST_F(ReadHeightfield, HgtTilesTakeTheirPlaceFromTheirName) {
  write_bytes(file("S37W120.hgt"), hgt_bytes({1, 2, 300, -4, -32768, 6, 7, 8, 9000}));
  const HeightfieldFile read = read_heightfield(file("S37W120.hgt"));
  EXPECT_EQ(read.grid.at(2, 0), 300.0f);
  EXPECT_EQ(read.grid.at(0, 1), -4.0f);
  EXPECT_TRUE(std::isnan(read.grid.at(1, 1)));
  EXPECT_NEAR(read.grid.cell_y, 110976.0 / 2.0, 10.0);  // WGS 84 at 36.5 degrees.
  EXPECT_NEAR(read.grid.cell_x, 89594.0 / 2.0, 30.0);
  EXPECT_NEAR(read.grid.origin.x / read.grid.cell_x, -240.0, 1e-9);
  EXPECT_NEAR(read.grid.origin.y / read.grid.cell_y, -74.0, 1e-9);
  EXPECT_TRUE(read.grid.georeferenced);

  write_bytes(file("tile.HGT"), hgt_bytes({1, 2, 3, 4}));
  const HeightfieldFile nameless = read_heightfield(file("tile.HGT"));
  EXPECT_FALSE(nameless.grid.georeferenced);
  EXPECT_TRUE(has_note(nameless, "no corner"));
  write_bytes(file("N00E000.hgt"), hgt_bytes({1, 2, 3, 4, 5, 6}));
  EXPECT_NE(refusal(file("N00E000.hgt")).find("12 bytes"), std::string::npos);
  write_bytes(file("N00E001.hgt"), "");
  refusal(file("N00E001.hgt"));
}

TEST_F(ReadHeightfield, UnusableFilesAreRefusedInOneLine) {
  refusal(file("missing.exr"));
  refusal(file("missing.hgt"));
  fs::create_directories(file("folder.tif"));
  refusal(file("folder.tif"));
  write_bytes(file("empty.tif"), "");
  refusal(file("empty.tif"));
  write_bytes(file("text.png"), "no picture at all, but text");
  refusal(file("text.png"));
  write_bytes(file("grid.asc"), "ncols 2\nnrows 2\n1 2\n3 4\n");
  EXPECT_EQ(refusal(file("grid.asc")),
            file("grid.asc").string() + ": expected elevations as .exr, .tif, .png or .hgt, got .asc");

  write_geotiff(file("whole.tif"), 3, 200, std::vector<float>(600, 1.0f), {});
  write_bytes(file("half.tif"), read_bytes(file("whole.tif")).substr(0, 1000));
  refusal(file("half.tif"));
  Image large{.width = 100, .height = 100, .channels = 1};
  for (int i = 0; i < 10000; ++i) large.pixels.push_back(static_cast<float>(std::sin(i) * 1e3));
  write_image(file("whole.exr"), large);
  const std::string exr = read_bytes(file("whole.exr"));
  write_bytes(file("half.exr"), exr.substr(0, exr.size() / 2));
  refusal(file("half.exr"));

  write_image(file("dot.exr"), {.width = 1, .height = 1, .channels = 1, .pixels = {5}});
  EXPECT_NE(refusal(file("dot.exr")).find("1 x 1"), std::string::npos);
  write_geotiff(file("nothing.tif"), 3, 2, std::vector<float>(6, NAN), {});
  EXPECT_NE(refusal(file("nothing.tif")).find("no data in every sample"), std::string::npos);
  write_geotiff(file("huge.tif"), 3, 2, {1, 2, 3, 4, 1e20f, 6}, {});
  EXPECT_NE(refusal(file("huge.tif")).find("column 1, row 1"), std::string::npos);
}

TEST_F(ReadHeightfield, OptionsOutOfBoundsAreNamed) {
  write_geotiff(file("h.tif"), 3, 2, kSamples, {});
  const auto message = [&](const HeightfieldOptions& options) -> std::string {
    try {
      (void)read_heightfield(file("h.tif"), options);
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "read";
  };
  EXPECT_EQ(message({.cell_size = 0.0}), "cell_size: expected 0.0001 to 1e6 m, got 0");
  EXPECT_EQ(message({.cell_size = -2.0}), "cell_size: expected 0.0001 to 1e6 m, got -2");
  EXPECT_NE(message({.cell_size = NAN}), "read");
  EXPECT_NE(message({.cell_size = INFINITY}), "read");
  write_geotiff(file("tiny.tif"), 3, 2, kSamples, {.scale = {1e-9, 1e-9, 0}, .tie_point = {0, 0, 0, 0, 0, 0}});
  EXPECT_NE(refusal(file("tiny.tif")).find("cells of 0.0001 to 1e6 m, got 1e-09 m"), std::string::npos);
  EXPECT_EQ(message({.height_scale = 0.0}), "height_scale: expected a finite number other than 0, got 0");
  EXPECT_NE(message({.height_scale = INFINITY}), "read");
  EXPECT_NE(message({.height_offset = NAN}), "read");
}

TEST_F(ReadHeightfield, AMisnamedPictureIsReadByItsContent) {
  write_picture<std::uint16_t>(file("h.png"), 2, 2, 1, {1, 2, 3, 4}, OIIO::TypeDesc::UINT16);
  fs::rename(file("h.png"), file("h.tif"));
  EXPECT_EQ(read_heightfield(file("h.tif")).grid.elevations, (std::vector<float>{1, 2, 3, 4}));
}

}  // namespace
}  // namespace outcrop
