/// The one idea of this library: a field that can be narrowed.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "outcrop/core/box.h"
#include "outcrop/core/vec.h"

namespace outcrop {

/// A batch of positions, structure of arrays, world metres. x, y and z have the same size; the caller owns them.
struct Points {
  std::span<const double> x;
  std::span<const double> y;
  std::span<const double> z;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] Vec3 operator[](std::size_t i) const noexcept { return {x[i], y[i], z[i]}; }
  [[nodiscard]] Points subspan(std::size_t first, std::size_t count) const noexcept {
    return {x.subspan(first, count), y.subspan(first, count), z.subspan(first, count)};
  }
};

class Field;
using FieldPtr = std::shared_ptr<const Field>;

/// Which material stands at a point: an index into the scene's list of materials; 0 where nobody says otherwise.
using Label = std::uint16_t;

/// |f(p) − f(q)| ≤ slope · |p − q| + slack: how fast a field changes, but for detail no larger than the slack.
///
/// A block with a relief is a gentle fold displaced by at most the relief's amplitude, but its Lipschitz constant is that of
/// the relief's steepest flank: far from the surface the modulus knows much more.
struct Modulus {
  double slope, slack;

  /// How far around a place with the value f all is on the same side of the surface.
  [[nodiscard]] double reach(double f) const noexcept { return (std::abs(f) - slack) / slope; }
};

/// False where all values of the interval are rock, or all air; f = 0 is air.
[[nodiscard]] inline bool may_change_sign(const Interval& values) noexcept { return values.lo < 0.0 && values.hi >= 0.0; }

/// A scalar function of space: negative in rock, positive in air, metres.
///
/// A heightfield, one block, ten million replicated blocks and a voxel grid are all Fields to the code above them. A
/// field is immutable and shared as FieldPtr; make one with std::make_shared. Every field passes the contract of
/// tests/implicit/field_contract.h: finite everywhere, 1-to-L Lipschitz, `bound` contains, `narrow` equals to the bit
/// inside its box, a batch equals its single points to the bit.
///
/// A node of your own needs `values` and `lipschitz`; the rest has defaults.
class Field : public std::enable_shared_from_this<Field> {
 public:
  virtual ~Field() = default;

  /// values[i] = f(points[i]) and, unless `gradients` is empty, gradients[i] = ∇f(points[i]) (one-sided at creases).
  ///
  /// `values` has points.size() elements, `gradients` as many or none. Thread-safe.
  virtual void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept = 0;

  /// values[i] = max(floors[i], min(values[i], f(points[i]))), with no floors where `floors` is empty; unless `gradients`
  /// is empty, gradients[i] = ∇f(points[i]) where f is below the value given, and unspecified where the floor holds.
  ///
  /// For who knows what matters of f, such as a union that knows another part's value or a mesher that looks for signs:
  /// many fields are sure to be above or below it at a fraction of the cost of a value. Default: asks `values`.
  virtual void between(const Points& points, std::span<const double> floors, std::span<double> values,
                       std::span<Vec3> gradients) const noexcept;

  /// L with |f(p) − f(q)| ≤ L |p − q| for all p, q where the field is used (of a narrowed field: in its box).
  [[nodiscard]] virtual double lipschitz() const noexcept = 0;

  /// Holds for all points where the field is used (of a narrowed field: in its box). Default: {lipschitz(), 0}.
  [[nodiscard]] virtual Modulus modulus() const noexcept { return {lipschitz(), 0.0}; }

  /// An interval that contains every value in the box. Default: f(centre) ± L · half diagonal.
  [[nodiscard]] virtual Interval bound(const Box& box) const noexcept;

  /// A cheaper field that equals this one, to the bit, at every point of the box. Default: this field.
  ///
  /// The result keeps what it needs alive; it may answer anything outside the box.
  [[nodiscard]] virtual FieldPtr narrow(const Box& box) const;

  /// narrow(box), or null where bound(box) says that the surface is not in it: one look where `bound` and `narrow` would
  /// take the same steps twice. Default: asks both.
  [[nodiscard]] virtual FieldPtr narrow_to_surface(const Box& box) const;

  /// A box outside of which f > 0, where one is known: lets a mesher choose its region.
  [[nodiscard]] virtual std::optional<Box> support() const noexcept;

  /// labels[i] = the material at points[i]. Default: all 0.
  virtual void labels(const Points& points, std::span<Label> labels) const noexcept;

  /// f at one point: a batch of one.
  [[nodiscard]] double value(const Vec3& p) const noexcept;
  /// ∇f at one point: a batch of one.
  [[nodiscard]] Vec3 gradient(const Vec3& p) const noexcept;
};

/// A field written one point at a time: override `at`, get batches and (by central differences, unless `gradient_at` is
/// overridden) gradients. For prototypes and user nodes; a hot node overrides Field::values instead.
class PointField : public Field {
 public:
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept final;

 protected:
  [[nodiscard]] virtual double at(const Vec3& p) const noexcept = 0;
  [[nodiscard]] virtual Vec3 gradient_at(const Vec3& p) const noexcept;
};

}  // namespace outcrop
