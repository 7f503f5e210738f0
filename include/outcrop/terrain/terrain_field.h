/// Heightfields as Fields.
#pragma once

#include "outcrop/implicit/field.h"
#include "outcrop/terrain/heightfield.h"

namespace outcrop {

/// f(p) = p.z − h(p.x, p.y); with NodataPolicy::Hole and holes in the data, max(f, hole distance).
///
/// f is a vertical distance: divide by |∇f| for an estimate of the distance.
class TerrainField final : public Field {
 public:
  explicit TerrainField(Heightfield heightfield, NodataPolicy nodata = NodataPolicy::Hole);

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override;
  [[nodiscard]] double lipschitz() const noexcept override;
  [[nodiscard]] Interval bound(const Box& box) const noexcept override;
  [[nodiscard]] FieldPtr narrow(const Box& box) const override;
  [[nodiscard]] const Heightfield& heightfield() const noexcept { return heightfield_; }

 private:
  Heightfield heightfield_;
  bool holes_;  ///< The hole distance may matter here.
  double lipschitz_;
};

}  // namespace outcrop
