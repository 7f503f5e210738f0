#include "outcrop/terrain/terrain_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace outcrop {
namespace {

constexpr double kRoundingSlack = 1e-12;  // Relative: z − h and the Lipschitz constant are rounded too.

// |∇f|² = 1 + |∇h|²; the hole distance has Lipschitz constant 1 and never adds to it.
double lipschitz_of(double slope) noexcept { return std::sqrt(1.0 + slope * slope) * (1.0 + kRoundingSlack); }

Interval outward(const Interval& i) noexcept {
  return {i.lo - kRoundingSlack * std::abs(i.lo), i.hi + kRoundingSlack * std::abs(i.hi)};
}

Interval ground_bound(const Heightfield& heightfield, const Box& box) noexcept {
  const Interval h = heightfield.height_bound({box.lo.x, box.lo.y}, {box.hi.x, box.hi.y});
  return outward({box.lo.z - h.hi, box.hi.z - h.lo});
}

Interval hole_bound(const Heightfield& heightfield, const Box& box) noexcept {
  return heightfield.hole_bound({box.lo.x, box.lo.y}, {box.hi.x, box.hi.y});
}

constexpr std::size_t kRemembered = 256;  // Samples kept within a batch: more than a layer of a mesher's brick.

/// The distance in the batch at which its first position returns with another z; 0 when that is not soon.
std::size_t column_stride(const Points& points) noexcept {
  const std::size_t last = std::min(points.size(), kRemembered);
  for (std::size_t i = 1; i < last; ++i) {
    if (points.x[i] == points.x[0] && points.y[i] == points.y[0]) return i;
  }
  return 0;
}

/// Calls `use(i, sample_at(x, y))` for every point. Meshers ask for lattices, whose layers repeat the same positions at
/// other z: there the surface is evaluated once a position. What is remembered is what would be computed, so that
/// results do not depend on the batch.
template <class SampleAt, class Use>
void each_sample(const Points& points, SampleAt&& sample_at, Use&& use) noexcept {
  const std::size_t stride = column_stride(points);
  std::array<Heightfield::Sample, kRemembered> samples;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Heightfield::Sample& sample = samples[i % kRemembered];
    const bool again =
        stride > 0 && i >= stride && points.x[i] == points.x[i - stride] && points.y[i] == points.y[i - stride];
    sample = again ? samples[(i - stride) % kRemembered] : sample_at(points.x[i], points.y[i]);
    use(i, sample);
  }
}

}  // namespace

TerrainField::TerrainField(Heightfield heightfield, NodataPolicy nodata)
    : heightfield_(std::move(heightfield)),
      holes_(nodata == NodataPolicy::Hole && heightfield_.has_holes()),
      lipschitz_(lipschitz_of(heightfield_.slope_bound(heightfield_.lo(), heightfield_.hi()))) {}

void TerrainField::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  const auto ground_at = [&](double x, double y) { return heightfield_.at(x, y); };
  each_sample(points, ground_at, [&](std::size_t i, const Heightfield::Sample& ground) {
    values[i] = points.z[i] - ground.h;
    if (!gradients.empty()) gradients[i] = {-ground.hx, -ground.hy, 1.0};
  });
  if (!holes_) return;
  const auto hole_at = [&](double x, double y) { return heightfield_.hole_at(x, y); };
  each_sample(points, hole_at, [&](std::size_t i, const Heightfield::Sample& hole) {
    if (hole.h <= values[i]) return;
    values[i] = hole.h;
    if (!gradients.empty()) gradients[i] = {hole.hx, hole.hy, 0.0};
  });
}

double TerrainField::lipschitz() const noexcept { return lipschitz_; }

Interval TerrainField::bound(const Box& box) const noexcept {
  const Interval ground = ground_bound(heightfield_, box);
  return holes_ ? max(ground, hole_bound(heightfield_, box)) : ground;
}

FieldPtr TerrainField::narrow(const Box& box) const {
  auto narrowed = std::make_shared<TerrainField>(*this);
  narrowed->holes_ = holes_ && hole_bound(heightfield_, box).hi >= ground_bound(heightfield_, box).lo;
  narrowed->lipschitz_ = lipschitz_of(heightfield_.slope_bound({box.lo.x, box.lo.y}, {box.hi.x, box.hi.y}));
  return narrowed;
}

}  // namespace outcrop
