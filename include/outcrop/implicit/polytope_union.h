/// Many rounded polytopes at once: what a pile of rock is.
#pragma once

#include <span>
#include <vector>

#include "outcrop/implicit/field.h"
#include "outcrop/implicit/rounded_polytope.h"

namespace outcrop {

/// A polytope, borrowed, and where its centre stands.
struct PlacedKernel {
  const PolytopeKernel* kernel;
  Vec3 position;
};

/// Field::between of the union of b_k(p − position_k) − growth over the polytopes k; the gradient is that of the first
/// polytope that is as low.
///
/// `growth` has points.size() elements ≥ 0, or none. Equal to the bit to asking each polytope alone. Cost: the folds of
/// all polytopes at all points, and the relief only of those that can be the lowest and above the floor: a fold bounds
/// its carved value from both sides.
void between_union(std::span<const PlacedKernel> polytopes, const Points& points, std::span<const double> growth,
                   std::span<const double> floors, std::span<double> values, std::span<Vec3> gradients) noexcept;

/// The union of rounded polytopes, as union_of makes it where all its fields are RoundedPolytopes.
class PolytopeUnion final : public Field {
 public:
  /// @param kernels, positions  As many of each, at least 1.
  PolytopeUnion(std::vector<PolytopeKernel> kernels, std::span<const Vec3> positions);

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override;
  void between(const Points& points, std::span<const double> floors, std::span<double> values,
               std::span<Vec3> gradients) const noexcept override;
  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Modulus modulus() const noexcept override { return {1.0, depth_}; }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override;
  [[nodiscard]] FieldPtr narrow(const Box& box) const override;
  [[nodiscard]] FieldPtr narrow_to_surface(const Box& box) const override;
  [[nodiscard]] std::optional<Box> support() const noexcept override;

 private:
  template <class Wanted>
  [[nodiscard]] FieldPtr narrow_where(const Box& box, Wanted&& wanted) const;

  std::vector<PolytopeKernel> kernels_;
  std::vector<PlacedKernel> polytopes_;
  double lipschitz_ = 1.0;
  double depth_ = 0.0;  ///< The largest of the polytopes'.
};

}  // namespace outcrop
