// The only file of the race that includes OpenVDB.
#include "race_openvdb.h"

#include <openvdb/version.h>
#undef OPENVDB_USE_EXPLICIT_INSTANTIATION  // volumeToMesh with our flags: faster than the one in Debian's library.
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <array>
#include <cmath>
#include <vector>

#include "race_clock.h"

namespace outcrop::race {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;

constexpr int kLeaf = Leaf::DIM;

/// Fills the leaves that the surface may touch, from a field narrowed on the way down as the polygonizer does.
class Filler {
 public:
  Filler(FloatGrid& grid, const Box& region, double resolution, int band)
      : accessor_(grid.getAccessor()), origin_(region.lo), resolution_(resolution), band_(band) {}

  /// @param size  Edge of the cube of voxels at `first`: kLeaf · 2ⁿ.
  void fill(const Field& field, const Coord& first, int size) {
    // With one voxel more on each side both ends of every edge that crosses the surface hold true values.
    const Vec3 lo = origin_ + resolution_ * Vec3(first.x(), first.y(), first.z());
    const Box box = Box{lo, lo + resolution_ * Vec3(size - 1)}.grown(resolution_ * band_);
    const Interval bound = field.bound(box);
    if (bound.lo > 0.0 || bound.hi < 0.0) return;
    const FieldPtr narrowed = field.narrow(box);
    if (size == kLeaf) return fill_leaf(*narrowed, first);
    const int half = size / 2;
    for (int child = 0; child < 8; ++child)
      fill(*narrowed, first.offsetBy(half * (child & 1), half * (child >> 1 & 1), half * (child >> 2)), half);
  }

 private:
  void fill_leaf(const Field& field, const Coord& first) {
    for (int i = 0; i < static_cast<int>(Leaf::SIZE); ++i) {  // A leaf stores z fastest.
      x_[i] = origin_.x + resolution_ * (first.x() + i / (kLeaf * kLeaf));
      y_[i] = origin_.y + resolution_ * (first.y() + i / kLeaf % kLeaf);
      z_[i] = origin_.z + resolution_ * (first.z() + i % kLeaf);
    }
    field.values({x_, y_, z_}, values_, {});
    Leaf& leaf = *accessor_.touchLeaf(first);
    float* const stored = leaf.buffer().data();
    for (int i = 0; i < static_cast<int>(Leaf::SIZE); ++i) stored[i] = static_cast<float>(values_[i]);
    leaf.setValuesOn();
  }

  FloatGrid::Accessor accessor_;
  Vec3 origin_;
  double resolution_;
  double band_;
  std::array<double, Leaf::SIZE> x_, y_, z_, values_;
};

}  // namespace

OpenVdbRun mesh_by_openvdb(const Field& field, const Box& region, double resolution, int band) {
  openvdb::initialize();
  OpenVdbRun run;
  const CpuClock fill_clock;
  const auto grid = FloatGrid::create(static_cast<float>(band * resolution));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(resolution));
  const int size = static_cast<int>(std::lround(region.size().x / resolution));
  Filler(*grid, region, resolution, band).fill(field, Coord(0), size);
  openvdb::tools::signedFloodFill(grid->tree());
  run.fill_seconds = fill_clock.seconds();

  const CpuClock mesh_clock;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads, 0.0);
  run.mesh_seconds = mesh_clock.seconds();

  run.mesh.origin = region.lo;
  for (const openvdb::Vec3s& p : points) run.mesh.positions.push_back({p.x(), p.y(), p.z()});
  for (const openvdb::Vec4I& q : quads) {  // Clockwise seen from the air.
    run.mesh.triangles.push_back({q[0], q[2], q[1]});
    run.mesh.triangles.push_back({q[0], q[3], q[2]});
  }
  return run;
}

std::string openvdb_version() { return OPENVDB_LIBRARY_VERSION_STRING; }

}  // namespace outcrop::race
