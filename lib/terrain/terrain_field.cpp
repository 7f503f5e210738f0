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

constexpr std::size_t kChunk = 768;  // Points at a time: a mesher's brick of 9³.

}  // namespace

TerrainField::TerrainField(Heightfield heightfield, NodataPolicy nodata)
    : heightfield_(std::move(heightfield)),
      holes_(nodata == NodataPolicy::Hole && heightfield_.has_holes()),
      lipschitz_(lipschitz_of(heightfield_.slope_bound(heightfield_.lo(), heightfield_.hi()))) {}

void TerrainField::values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept {
  heightfield_.heights(points.x, points.y, values);
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = points.z[i] - values[i];
  std::array<Heightfield::Sample, kChunk> samples;
  for (std::size_t first = 0; first < gradients.size(); first += kChunk) {
    const std::size_t n = std::min(kChunk, points.size() - first);
    heightfield_.at(points.x.subspan(first, n), points.y.subspan(first, n), std::span(samples).first(n));
    for (std::size_t i = 0; i < n; ++i) gradients[first + i] = {-samples[i].hx, -samples[i].hy, 1.0};
  }
  if (!holes_) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Heightfield::Sample hole = heightfield_.hole_at(points.x[i], points.y[i]);
    if (hole.h <= values[i]) continue;
    values[i] = hole.h;
    if (!gradients.empty()) gradients[i] = {hole.hx, hole.hy, 0.0};
  }
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
