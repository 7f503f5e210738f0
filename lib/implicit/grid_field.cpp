// The only file that includes OpenVDB.
#include "outcrop/implicit/grid_field.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <ios>
#include <limits>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "outcrop/core/error.h"
#include "outcrop/core/file.h"
#include "outcrop/core/parallel.h"
#include "outcrop/implicit/primitives.h"

namespace outcrop {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatGrid;
using openvdb::FloatTree;

constexpr int kLeaf = FloatTree::LeafNodeType::DIM;  // 8: the grid stores cubes of 8³ voxels, and tiles of one value.

/// Smallest and largest of some stored values.
struct Range {
  float lo = std::numeric_limits<float>::infinity();
  float hi = -std::numeric_limits<float>::infinity();
  void include(float v) {
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  void include(const Range& r) {
    lo = std::min(lo, r.lo);
    hi = std::max(hi, r.hi);
  }
};

/// Ranges of the stored values in cubes of 2ⁿ voxels, in levels of doubling cubes.
class RangePyramid {
 public:
  RangePyramid() = default;
  /// @param voxels  Where values differ from the background; outside of it all do not.
  RangePyramid(const FloatGrid& grid, const CoordBBox& voxels, const Task& task) {
    constexpr std::size_t kMostCubes = std::size_t{1} << 22;
    int log2 = 3;
    Level base = shape(voxels, log2);
    while (base.ranges.size() > kMostCubes) base = shape(voxels, ++log2);
    const int leaves = 1 << (log2 - 3);  // Along a cube's edge.
    const auto slab = static_cast<std::size_t>(base.size[0]) * base.size[1];
    parallel_for(
        base.size[2],
        [&](std::size_t k) {
          const auto accessor = grid.getConstUnsafeAccessor();
          for (std::size_t cube = k * slab; cube < (k + 1) * slab; ++cube) {
            const Coord first = base.cube(cube);
            for (int leaf = 0; leaf < leaves * leaves * leaves; ++leaf) {
              const Coord at(leaf % leaves, leaf / leaves % leaves, leaf / leaves / leaves);
              const Coord corner((first.x() << log2) + kLeaf * at.x(), (first.y() << log2) + kLeaf * at.y(),
                                 (first.z() << log2) + kLeaf * at.z());
              if (const auto* const node = accessor.probeConstLeaf(corner)) {
                for (openvdb::Index i = 0; i < FloatTree::LeafNodeType::SIZE; ++i)
                  base.ranges[cube].include(node->getValue(i));
              } else {
                base.ranges[cube].include(accessor.getValue(corner));
              }
            }
          }
        },
        task);
    levels_.push_back(std::move(base));
    // Two cubes along an axis may stay two for ever: those on both sides of index 0.
    while (levels_.back().ranges.size() > 8) levels_.push_back(coarser(levels_.back()));
  }

  /// Of the values at the voxels lo … hi, which lie within the pyramid; cubes that stick out of that box count whole.
  [[nodiscard]] Range range(const Coord& lo, const Coord& hi) const {
    constexpr int kMostCubesAcross = 4;
    const Level* level = &levels_.front();
    while (level != &levels_.back() && ((hi - lo)[(hi - lo).maxIndex()] >> level->log2) >= kMostCubesAcross) ++level;
    const Coord first = lo >> level->log2, last = hi >> level->log2;
    Range result;
    for (int k = first.z(); k <= last.z(); ++k)
      for (int j = first.y(); j <= last.y(); ++j)
        for (int i = first.x(); i <= last.x(); ++i) result.include(level->ranges[level->index({i, j, k})]);
    return result;
  }

 private:
  struct Level {
    int log2 = 3;
    Coord origin, size;  ///< In cubes.
    std::vector<Range> ranges;

    [[nodiscard]] std::size_t index(const Coord& cube) const {
      const Coord at = cube - origin;
      return (static_cast<std::size_t>(at.z()) * size.y() + at.y()) * size.x() + at.x();
    }
    [[nodiscard]] Coord cube(std::size_t index) const {
      const std::size_t across = size.x(), up = size.y();
      return origin + Coord(static_cast<int>(index % across), static_cast<int>(index / across % up),
                            static_cast<int>(index / across / up));
    }
  };

  [[nodiscard]] static Level shape(const CoordBBox& voxels, int log2) {
    Level level;
    level.log2 = log2;
    level.origin = voxels.min() >> log2;
    level.size = (voxels.max() >> log2) - level.origin + Coord(1);
    level.ranges.resize(static_cast<std::size_t>(level.size.x()) * level.size.y() * level.size.z());
    return level;
  }
  [[nodiscard]] static Level coarser(const Level& fine) {
    Level level;
    level.log2 = fine.log2 + 1;
    level.origin = fine.origin >> 1;
    level.size = ((fine.origin + fine.size - Coord(1)) >> 1) - level.origin + Coord(1);
    level.ranges.resize(static_cast<std::size_t>(level.size.x()) * level.size.y() * level.size.z());
    for (std::size_t i = 0; i < fine.ranges.size(); ++i)
      level.ranges[level.index(fine.cube(i) >> 1)].include(fine.ranges[i]);
    return level;
  }

  std::vector<Level> levels_;
};

/// The box of all voxels whose value is not the background's, with one more on each side.
[[nodiscard]] CoordBBox differing_voxels(const FloatGrid& grid) {
  CoordBBox box;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) box.expand(leaf->getNodeBoundingBox());
  auto tile = grid.tree().cbeginValueAll();
  tile.setMaxDepth(FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (*tile != grid.background()) box.expand(tile.getBoundingBox());
  if (!box.empty()) box.expand(1);
  return box;
}

/// The largest step between tiles that touch: none in a sane level set, where leaves lie between them.
[[nodiscard]] double largest_tile_step(const FloatGrid& grid) {
  const auto accessor = grid.getConstUnsafeAccessor();
  double most = 0.0;
  auto tile = grid.tree().cbeginValueAll();
  tile.setMaxDepth(FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (*tile == grid.background()) continue;
    const CoordBBox box = tile.getBoundingBox();
    for (int axis = 0; axis < 3; ++axis)
      for (const int beyond : {box.min()[axis] - 1, box.max()[axis] + 1})
        for (int i = 0; i < box.dim()[(axis + 1) % 3]; i += kLeaf)
          for (int j = 0; j < box.dim()[(axis + 2) % 3]; j += kLeaf) {
            Coord at = box.min();
            at[axis] = beyond;
            at[(axis + 1) % 3] += i;
            at[(axis + 2) % 3] += j;
            if (!accessor.probeConstLeaf(at)) most = std::max<double>(most, std::abs(accessor.getValue(at) - *tile));
          }
  }
  return most;
}

/// The largest |∇| of the trilinear interpolant, a voxel: in each cell no longer than the largest differences along its
/// edges, taken together.
[[nodiscard]] double steepest(const FloatGrid& grid, const Task& task) {
  const double tiles = std::sqrt(3.0) * largest_tile_step(grid);
  std::vector<Coord> corners;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) corners.push_back(leaf->origin());
  constexpr std::size_t kChunk = 256;
  const std::size_t chunks = (corners.size() + kChunk - 1) / kChunk;
  const std::vector<double> steepest_of = parallel_map(
      chunks,
      [&](std::size_t chunk) {
        constexpr int n = kLeaf + 2;
        const auto accessor = grid.getConstUnsafeAccessor();
        std::array<float, n * n * n> v;
        const auto at = [](int i, int j, int k) { return (k * n + j) * n + i; };
        double most = 0.0;
        for (std::size_t c = chunk * kChunk; c < std::min(corners.size(), (chunk + 1) * kChunk); ++c) {
          for (int k = 0; k < n; ++k)
            for (int j = 0; j < n; ++j)
              for (int i = 0; i < n; ++i) v[at(i, j, k)] = accessor.getValue(corners[c].offsetBy(i - 1, j - 1, k - 1));
          for (int k = 0; k + 1 < n; ++k)
            for (int j = 0; j + 1 < n; ++j)
              for (int i = 0; i + 1 < n; ++i) {
                float x = 0.0f, y = 0.0f, z = 0.0f;
                for (int a = 0; a < 2; ++a)
                  for (int b = 0; b < 2; ++b) {
                    x = std::max(x, std::abs(v[at(i + 1, j + a, k + b)] - v[at(i, j + a, k + b)]));
                    y = std::max(y, std::abs(v[at(i + a, j + 1, k + b)] - v[at(i + a, j, k + b)]));
                    z = std::max(z, std::abs(v[at(i + a, j + b, k + 1)] - v[at(i + a, j + b, k)]));
                  }
                most = std::max(most, std::sqrt(double{x} * x + double{y} * y + double{z} * z));
              }
        }
        return most;
      },
      task);
  return std::accumulate(steepest_of.begin(), steepest_of.end(), tiles,
                         [](double a, double b) { return std::max(a, b); });
}

/// A float grid, interpolated trilinearly; its background outside of what it stores.
class GridField final : public Field {
 public:
  /// @throws ParameterError when the grid is empty, not finite, or mapped to the world by more than an affine
  /// transform.
  explicit GridField(FloatGrid::ConstPtr grid, const Task& task = {})
      : grid_(std::move(grid)), voxels_(differing_voxels(*grid_)) {
    require(!voxels_.empty(), "grid", "at least one voxel that differs from the background", "none");
    require(grid_->transform().isLinear(), "grid", "a linear transform", grid_->transform().mapType());
    require(std::isfinite(grid_->background()), "grid", "a finite background", grid_->background());
    const openvdb::Vec3d zero = grid_->worldToIndex({0, 0, 0});
    offset_ = {zero.x(), zero.y(), zero.z()};
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Vec3d unit(0, 0, 0);
      unit[axis] = 1.0;
      const openvdb::Vec3d column = grid_->transform().baseMap()->applyInverseJacobian(unit);
      index_from_world_[axis] = {column.x(), column.y(), column.z()};
    }
    pyramid_ = RangePyramid(*grid_, voxels_, task);
    whole_ = pyramid_.range(voxels_.min(), voxels_.max());
    whole_.include(grid_->background());
    require(std::isfinite(whole_.lo) && std::isfinite(whole_.hi), "grid", "finite values", "NaN or infinity");
    lipschitz_ = steepest(*grid_, task) * stretch() * (1.0 + 1e-9);
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    const auto accessor = grid_->getConstUnsafeAccessor();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 index = inside_range(index_from_world_ * points[i] + offset_);
      const Vec3 base = glm::floor(index);
      const Vec3 f = index - base;
      const Coord corner(static_cast<int>(base.x), static_cast<int>(base.y), static_cast<int>(base.z));
      double v[2][2][2];
      for (int z = 0; z < 2; ++z)
        for (int y = 0; y < 2; ++y)
          for (int x = 0; x < 2; ++x) v[z][y][x] = accessor.getValue(corner.offsetBy(x, y, z));
      double row[2][2], slope[2][2];
      for (int z = 0; z < 2; ++z)
        for (int y = 0; y < 2; ++y) {
          row[z][y] = (1.0 - f.x) * v[z][y][0] + f.x * v[z][y][1];
          slope[z][y] = v[z][y][1] - v[z][y][0];
        }
      const double low = (1.0 - f.y) * row[0][0] + f.y * row[0][1], high = (1.0 - f.y) * row[1][0] + f.y * row[1][1];
      values[i] = (1.0 - f.z) * low + f.z * high;
      if (gradients.empty()) continue;
      const Vec3 by_index{(1.0 - f.z) * ((1.0 - f.y) * slope[0][0] + f.y * slope[0][1]) +
                              f.z * ((1.0 - f.y) * slope[1][0] + f.y * slope[1][1]),
                          (1.0 - f.z) * (row[0][1] - row[0][0]) + f.z * (row[1][1] - row[1][0]), high - low};
      gradients[i] = by_index * index_from_world_;
    }
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Vec3 centre = index_from_world_ * box.centre() + offset_;
    const Vec3 half = 0.5 * box.size();
    Vec3 reach(0.0);
    for (int axis = 0; axis < 3; ++axis) reach += glm::abs(index_from_world_[axis]) * half[axis];
    const double slack = 1e-9 * (1.0 + glm::length(centre) + glm::length(reach));
    const Vec3 lo = glm::floor(centre - reach - Vec3(slack)), hi = glm::floor(centre + reach + Vec3(slack)) + Vec3(1.0);
    const Vec3 first = inside_range(lo), last = inside_range(hi);
    Range range = pyramid_.range(Coord(static_cast<int>(first.x), static_cast<int>(first.y), static_cast<int>(first.z)),
                                 Coord(static_cast<int>(last.x), static_cast<int>(last.y), static_cast<int>(last.z)));
    if (first != lo || last != hi) range.include(grid_->background());
    const double rounding = 1e-9 * std::max(std::abs(whole_.lo), std::abs(whole_.hi));
    return intersection(Interval{range.lo - rounding, range.hi + rounding}, Field::bound(box));
  }

  [[nodiscard]] std::optional<Box> support() const noexcept override {
    if (!(grid_->background() > 0.0f)) return std::nullopt;
    Box box;
    for (int corner = 0; corner < 8; ++corner) {
      const openvdb::Vec3d p = grid_->indexToWorld(openvdb::Vec3d(corner & 1 ? voxels_.max().x() : voxels_.min().x(),
                                                                  corner & 2 ? voxels_.max().y() : voxels_.min().y(),
                                                                  corner & 4 ? voxels_.max().z() : voxels_.min().z()));
      box.include({p.x(), p.y(), p.z()});
    }
    return box;
  }

 private:
  /// Beyond the voxels that differ there is background alone, so the nearest of them stands for what lies beyond;
  /// indices of far points would not fit an int.
  [[nodiscard]] Vec3 inside_range(const Vec3& index) const noexcept {
    return glm::clamp(index, Vec3(voxels_.min().x(), voxels_.min().y(), voxels_.min().z()),
                      Vec3(voxels_.max().x(), voxels_.max().y(), voxels_.max().z()));
  }

  /// Bounds the norm of index_from_world: exact for scaled rotations.
  [[nodiscard]] double stretch() const noexcept {
    const Mat3 square = glm::transpose(index_from_world_) * index_from_world_;
    double most = 0.0;
    for (int row = 0; row < 3; ++row)
      most = std::max(most, std::abs(square[0][row]) + std::abs(square[1][row]) + std::abs(square[2][row]));
    return std::sqrt(most);
  }

  FloatGrid::ConstPtr grid_;
  CoordBBox voxels_;
  Mat3 index_from_world_{1.0};
  Vec3 offset_{0.0};
  RangePyramid pyramid_;
  Range whole_;
  double lipschitz_ = 1.0;
};

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& expected, const std::string& got) {
  throw InputError(path.string() + ": expected " + expected + ", got " + got);
}

[[nodiscard]] FloatGrid::Ptr first_float_grid(const std::filesystem::path& path) {
  // A stream that throws, read to its end: io::File takes a file that lacks its last bytes for whole.
  std::ifstream file(path, std::ios::binary);
  file.exceptions(std::ios::failbit | std::ios::badbit);
  openvdb::io::Stream stream(file, false);
  const openvdb::GridPtrVecPtr grids = stream.getGrids();
  std::string types;
  for (const openvdb::GridBase::Ptr& grid : *grids) {
    if (FloatGrid::Ptr found = openvdb::gridPtrCast<FloatGrid>(grid)) return found;
    types += (types.empty() ? "" : ", ") + grid->valueType();
  }
  refuse(path, "a grid of floats", types.empty() ? "a file without grids" : "grids of " + types);
}

/// One cube of 8³ voxels on its way into a grid, or (without values) a cube of `size` voxels all inside.
struct Brick {
  Coord origin;
  int size = kLeaf;
  std::vector<float> values;
};

/// Finds the bricks of a narrow band: what `bound` cannot exclude.
class BandSampler {
 public:
  BandSampler(const Box& region, double voxel, const Vec3& origin, double band)
      : clip_(box_solid(region)), voxel_(voxel), origin_(origin), band_(band) {}

  void sample(const Field& field, const Coord& corner, int size, std::vector<Brick>& bricks) const {
    const Vec3 lo = world(corner), hi = world(corner + Coord(size - 1));
    const Box box{lo, hi};
    const Interval bound = max(field.bound(box), clip_->bound(box));
    if (bound.lo >= band_) return;
    if (bound.hi <= -band_) {
      bricks.push_back({corner, size, {}});
      return;
    }
    const FieldPtr narrowed = field.narrow(box);
    if (size == kLeaf) return evaluate(*narrowed, corner, bricks);
    const int half = size / 2;
    for (int child = 0; child < 8; ++child)
      sample(*narrowed, corner.offsetBy(half * (child & 1), half * (child >> 1 & 1), half * (child >> 2)), half,
             bricks);
  }

 private:
  [[nodiscard]] Vec3 world(const Coord& c) const { return Vec3(c.x(), c.y(), c.z()) * voxel_ + origin_; }

  void evaluate(const Field& field, const Coord& corner, std::vector<Brick>& bricks) const {
    constexpr std::size_t kCount = FloatTree::LeafNodeType::SIZE;
    std::array<double, kCount> x, y, z, value, clip;
    for (openvdb::Index i = 0; i < kCount; ++i) {
      const Vec3 p = world(corner + FloatTree::LeafNodeType::offsetToLocalCoord(i));
      x[i] = p.x;
      y[i] = p.y;
      z[i] = p.z;
    }
    field.values({x, y, z}, value, {});
    clip_->values({x, y, z}, clip, {});
    Brick brick{corner, kLeaf, std::vector<float>(kCount)};
    Range range;
    for (std::size_t i = 0; i < kCount; ++i) {
      brick.values[i] = static_cast<float>(std::clamp(std::max(value[i], clip[i]), -band_, band_));
      range.include(brick.values[i]);
    }
    if (range.lo >= static_cast<float>(band_)) return;
    if (range.hi <= static_cast<float>(-band_)) brick.values.clear();
    bricks.push_back(std::move(brick));
  }

  FieldPtr clip_;
  double voxel_;
  Vec3 origin_;
  double band_;
};

/// Reaches the protected writer of an archive with grid offsets, so that readers can seek, into any stream.
class StreamArchive final : public openvdb::io::Archive {
 public:
  [[nodiscard]] std::string bytes(const FloatGrid::Ptr& grid) const {
    std::ostringstream stream(std::ios::binary);
    write(stream, openvdb::GridCPtrVec{grid}, true);
    std::string result = std::move(stream).str();
    // OpenVDB tags each file with a random UUID. The same grid shall give the same bytes: put a hash of the rest there.
    const std::string tag = getUniqueTag();
    const std::size_t at = result.find(tag);
    if (at == std::string::npos) return result;
    result.replace(at, tag.size(), std::string(tag.size(), '0'));
    std::uint64_t hash = 0xCBF29CE484222325ull;  // FNV-1a
    for (const char c : result) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
    constexpr char kDigits[] = "0123456789abcdef";
    for (std::size_t i = 0; i < tag.size(); ++i) {
      if (tag[i] == '-')
        result[at + i] = '-';
      else
        result[at + i] = kDigits[hash >> (4 * (i % 16)) & 15];
    }
    return result;
  }
};

}  // namespace

FieldPtr read_vdb(const std::filesystem::path& path, const Task& task) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) refuse(path, "an OpenVDB file", "no such file");
  if (std::filesystem::is_directory(path, error)) refuse(path, "an OpenVDB file", "a folder");
  openvdb::initialize();
  try {
    return std::make_shared<GridField>(first_float_grid(path), task);
  } catch (const openvdb::Exception& e) {
    std::string reason = e.what();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    refuse(path, "an OpenVDB file", "one that cannot be read (" + reason + ")");
  } catch (const std::ios_base::failure&) {
    refuse(path, "an OpenVDB file", "one that ends too early");
  } catch (const ParameterError& e) {
    throw InputError(path.string() + ": " + e.what());
  }
}

FieldPtr mesh_distance(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
                       double voxel, double half_width, const Task& task) {
  require(voxel > 0.0 && std::isfinite(voxel), "voxel", "> 0 and finite", voxel);
  require(half_width >= 1.0 && half_width <= 1000.0, "half_width", "1 to 1000 voxels", half_width);
  require(!vertices.empty() && !triangles.empty(), "mesh", "at least one triangle", "none");
  Box box;
  for (const Vec3& v : vertices) {
    for (int axis = 0; axis < 3; ++axis) require(std::isfinite(v[axis]), "mesh", "finite vertices", v[axis]);
    box.include(v);
  }
  for (const auto& triangle : triangles)
    for (const std::uint32_t v : triangle) require(v < vertices.size(), "mesh", "triangles of its own vertices", v);
  openvdb::initialize();
  // Around the box's centre, where floats resolve fractions of a voxel also in world coordinates of millions of metres;
  // on whole voxels, so that write_vdb with the same voxel samples the nodes and smooths nothing.
  const Vec3 centre = glm::round(box.centre() / voxel) * voxel;
  std::vector<openvdb::Vec3s> points;
  for (const Vec3& v : vertices) {
    const Vec3 local = (v - centre) / voxel;
    points.emplace_back(static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z));
  }
  std::vector<openvdb::Vec3I> faces;
  for (const auto& triangle : triangles) faces.emplace_back(triangle[0], triangle[1], triangle[2]);
  const openvdb::math::Transform::Ptr transform = openvdb::math::Transform::createLinearTransform(voxel);
  transform->postTranslate({centre.x, centre.y, centre.z});
  task.check();
  task.begin("mesh distance");
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, faces);
  const auto width = static_cast<float>(half_width);
  const FloatGrid::Ptr grid = openvdb::tools::meshToVolume<FloatGrid>(mesh, *transform, width, width);
  task.check();
  return std::make_shared<GridField>(grid, task);
}

void write_vdb(const std::filesystem::path& path, const Field& field, const Box& region, double voxel,
               const Vec3& origin, double half_width, const Task& task) {
  require(voxel > 0.0 && std::isfinite(voxel), "voxel", "> 0 and finite", voxel);
  require(half_width >= 1.0 && half_width <= 1000.0, "half_width", "1 to 1000 voxels", half_width);
  OutputFile file(path);
  openvdb::initialize();
  const double band = half_width * voxel;
  const BandSampler sampler(region, voxel, origin, band);

  constexpr int kBlock = 64;
  const Vec3 lo = glm::floor((region.lo - origin - Vec3(band)) / (kBlock * voxel));
  const Vec3 count = glm::floor((region.hi - origin + Vec3(band)) / (kBlock * voxel)) - lo + Vec3(1.0);
  require(count.x * count.y * count.z < 1e8, "voxel",
          "large enough for a region of fewer than 1e8 blocks of 64^3 voxels", voxel);
  const auto nx = static_cast<std::size_t>(count.x), ny = static_cast<std::size_t>(count.y);
  const std::size_t blocks = nx * ny * static_cast<std::size_t>(count.z);
  task.begin("sampling the level set", blocks);
  const std::vector<std::vector<Brick>> found = parallel_map(
      blocks,
      [&](std::size_t block) {
        const Vec3 at = (lo + Vec3(block % nx, block / nx % ny, block / nx / ny)) * double{kBlock};
        std::vector<Brick> bricks;
        sampler.sample(field, Coord(static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z)), kBlock,
                       bricks);
        task.advance();
        return bricks;
      },
      task);

  const auto background = static_cast<float>(band);
  const FloatGrid::Ptr grid = FloatGrid::create(background);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  for (const std::vector<Brick>& bricks : found)
    for (const Brick& brick : bricks) {
      if (brick.values.empty()) {
        grid->tree().fill(CoordBBox::createCube(brick.origin, brick.size), -background, false);
        continue;
      }
      auto* const leaf = grid->tree().touchLeaf(brick.origin);
      for (openvdb::Index i = 0; i < brick.values.size(); ++i) {
        const float v = brick.values[i];
        if (std::abs(v) < background)
          leaf->setValueOn(i, v);
        else
          leaf->setValueOff(i, v);
      }
    }
  task.check();
  file.write(StreamArchive().bytes(grid));
  file.commit();
}

}  // namespace outcrop
