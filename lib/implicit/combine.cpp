#include "outcrop/implicit/combine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "outcrop/core/error.h"
#include "outcrop/implicit/polytope_union.h"
#include "unary.h"

namespace outcrop {
namespace {

constexpr std::size_t kBlock = 128;  // Points a block: buffers on the stack, one virtual call a child and block.

enum class Side { Smallest, Largest };

/// The fold of smax over some fields, in their order; of smin for Side::Smallest. Radius 0 is the sharp maximum or
/// minimum.
class FoldField final : public Field {
 public:
  /// @param material  Whose labels hold; null: those of the field that decides.
  FoldField(Side side, double radius, std::vector<FieldPtr> fields, FieldPtr material)
      : sign_(side == Side::Largest ? 1.0 : -1.0),
        radius_(radius),
        fields_(std::move(fields)),
        material_(std::move(material)) {
    // A fold grows with each argument, and by t when all arguments do: it changes by no more than the largest change.
    for (const FieldPtr& field : fields_) {
      lipschitz_ = std::max(lipschitz_, field->lipschitz());
      const Modulus modulus = field->modulus();
      modulus_ = {std::max(modulus_.slope, modulus.slope), std::max(modulus_.slack, modulus.slack)};
    }
  }

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    if (is_union()) {
      fields_[0]->values(points, values, gradients);
      for (std::size_t k = 1; k < fields_.size(); ++k) fields_[k]->between(points, {}, values, gradients);
      return;
    }
    std::array<double, kBlock> other;
    std::array<Vec3, kBlock> other_gradients;
    for (std::size_t first = 0; first < points.size(); first += kBlock) {
      const std::size_t n = std::min(kBlock, points.size() - first);
      const Points block = points.subspan(first, n);
      const std::span<double> v = values.subspan(first, n);
      const std::span<Vec3> g = gradients.empty() ? gradients : gradients.subspan(first, n);
      fields_[0]->values(block, v, g);
      for (std::size_t k = 1; k < fields_.size(); ++k) {
        const std::span<Vec3> next_gradients{other_gradients.data(), g.size()};
        fields_[k]->values(block, {other.data(), n}, next_gradients);
        for (std::size_t i = 0; i < n; ++i) {
          const Blend blend = blended(sign_ * v[i], sign_ * other[i]);
          v[i] = sign_ * blend.value;
          if (!g.empty()) g[i] = (1.0 - blend.weight) * g[i] + blend.weight * next_gradients[i];
        }
      }
    }
  }

  void between(const Points& points, std::span<const double> floors, std::span<double> values,
               std::span<Vec3> gradients) const noexcept override {
    if (!is_union()) return Field::between(points, floors, values, gradients);
    for (const FieldPtr& field : fields_) field->between(points, floors, values, gradients);
  }

  [[nodiscard]] double lipschitz() const noexcept override { return lipschitz_; }
  [[nodiscard]] Modulus modulus() const noexcept override { return modulus_; }

  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    Interval fold = oriented(fields_[0]->bound(box));
    for (std::size_t k = 1; k < fields_.size(); ++k) fold = folded(fold, oriented(fields_[k]->bound(box)));
    const double slack = radius_ > 0.0 ? rounding(fold) : 0.0;
    return oriented({fold.lo - slack, fold.hi + slack});
  }

  [[nodiscard]] FieldPtr narrow(const Box& box) const override {
    std::vector<FieldPtr> kept = relevant(box);
    bool changed = kept.size() < fields_.size();
    FieldPtr material =
        material_ && !std::count(kept.begin(), kept.end(), material_) ? material_->narrow(box) : nullptr;
    for (FieldPtr& field : kept) {
      FieldPtr narrowed = field->narrow(box);
      if (field == material_) material = narrowed;
      changed = changed || narrowed != field;
      field = std::move(narrowed);
    }
    if (kept.size() == 1 && (!material_ || material == kept[0])) return kept[0];
    if (!changed) return shared_from_this();
    const Side side = sign_ > 0.0 ? Side::Largest : Side::Smallest;
    return std::make_shared<FoldField>(side, radius_, std::move(kept), std::move(material));
  }

  [[nodiscard]] std::optional<Box> support() const noexcept override {
    std::optional<Box> result;
    for (const FieldPtr& field : fields_) {
      const std::optional<Box> box = field->support();
      if (sign_ > 0.0) {
        if (box) result = result ? intersection(*result, *box) : *box;
      } else {
        // A smooth union bulges beyond its fields' supports by an amount that their values alone do not bound.
        if (!box || radius_ > 0.0) return std::nullopt;
        result = result ? hull(*result, *box) : *box;
      }
    }
    return result;
  }

  void labels(const Points& points, std::span<Label> labels) const noexcept override {
    if (material_ || fields_.size() == 1) return (material_ ? material_ : fields_[0])->labels(points, labels);
    std::array<double, kBlock> best, other;
    std::array<std::size_t, kBlock> deciding;
    std::array<Label, kBlock> own;
    for (std::size_t first = 0; first < points.size(); first += kBlock) {
      const std::size_t n = std::min(kBlock, points.size() - first);
      const Points block = points.subspan(first, n);
      fields_[0]->values(block, {best.data(), n}, {});
      deciding.fill(0);
      for (std::size_t k = 1; k < fields_.size(); ++k) {
        fields_[k]->values(block, {other.data(), n}, {});
        for (std::size_t i = 0; i < n; ++i)
          if (sign_ * other[i] > sign_ * best[i]) {
            best[i] = other[i];
            deciding[i] = k;
          }
      }
      for (std::size_t k = 0; k < fields_.size(); ++k) {
        if (std::find(deciding.begin(), deciding.begin() + n, k) == deciding.begin() + n) continue;
        fields_[k]->labels(block, {own.data(), n});
        for (std::size_t i = 0; i < n; ++i)
          if (deciding[i] == k) labels[first + i] = own[i];
      }
    }
  }

 private:
  [[nodiscard]] bool is_union() const noexcept { return sign_ < 0.0 && radius_ == 0.0; }

  struct Blend {
    double value;
    double weight;  ///< Of the second argument's gradient.
  };
  [[nodiscard]] Blend blended(double a, double b) const noexcept {
    const double near = radius_ > 0.0 ? std::max(1.0 - std::abs(a - b) / radius_, 0.0) : 0.0;
    const double half = 0.5 * near * near;
    return {std::max(a, b) + radius_ / 6.0 * near * near * near, b > a ? 1.0 - half : half};
  }
  /// As an interval of the values whose maximum is taken.
  [[nodiscard]] Interval oriented(const Interval& i) const noexcept { return sign_ > 0.0 ? i : Interval{-i.hi, -i.lo}; }
  /// smax grows with both arguments.
  [[nodiscard]] Interval folded(const Interval& a, const Interval& b) const noexcept {
    return {blended(a.lo, b.lo).value, blended(a.hi, b.hi).value};
  }
  [[nodiscard]] double rounding(const Interval& i) const noexcept {
    return 1e-12 * (radius_ + std::max(std::abs(i.lo), std::abs(i.hi)));
  }

  /// Without the fields that cannot matter in the box.
  [[nodiscard]] std::vector<FieldPtr> relevant(const Box& box) const {
    std::vector<Interval> bounds(fields_.size());
    for (std::size_t k = 0; k < fields_.size(); ++k) bounds[k] = oriented(fields_[k]->bound(box));
    std::vector<FieldPtr> kept;
    if (radius_ == 0.0) {
      double least = bounds[0].lo;
      for (const Interval& b : bounds) least = std::max(least, b.lo);
      for (std::size_t k = 0; k < fields_.size(); ++k)
        if (bounds[k].hi >= least) kept.push_back(fields_[k]);
      return kept;
    }
    // A field further than the radius below what was folded before it adds nothing, to the bit; one further above it
    // replaces it. A field between may not be dropped for what comes later: it has moved the fold until then.
    Interval fold = bounds[0];
    kept.push_back(fields_[0]);
    for (std::size_t k = 1; k < fields_.size(); ++k) {
      const double apart = radius_ + rounding(fold) + rounding(bounds[k]);
      if (bounds[k].hi <= fold.lo - apart) continue;
      if (bounds[k].lo >= fold.hi + apart) {
        kept.clear();
        fold = bounds[k];
      } else {
        fold = folded(fold, bounds[k]);
      }
      kept.push_back(fields_[k]);
    }
    return kept;
  }

  double sign_;
  double radius_;
  double lipschitz_ = 0.0;
  Modulus modulus_{0.0, 0.0};
  std::vector<FieldPtr> fields_;
  FieldPtr material_;
};

/// −f: air and rock exchanged.
class Complement final : public UnaryField {
 public:
  using UnaryField::UnaryField;
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    field().values(points, values, gradients);
    for (double& v : values) v = -v;
    for (Vec3& g : gradients) g = -g;
  }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval b = field().bound(box);
    return {-b.hi, -b.lo};
  }

 private:
  [[nodiscard]] FieldPtr with(FieldPtr field) const override { return std::make_shared<Complement>(std::move(field)); }
};

class Offset final : public UnaryField {
 public:
  Offset(FieldPtr field, double thickness) : UnaryField(std::move(field)), thickness_(thickness) {}
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    field().values(points, values, gradients);
    for (double& v : values) v -= thickness_;
  }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval b = field().bound(box);
    return {b.lo - thickness_, b.hi - thickness_};
  }
  [[nodiscard]] std::optional<Box> support() const noexcept override {
    return thickness_ <= 0.0 ? field().support() : std::nullopt;
  }

 private:
  [[nodiscard]] FieldPtr with(FieldPtr field) const override {
    return std::make_shared<Offset>(std::move(field), thickness_);
  }
  double thickness_;
};

class Shell final : public UnaryField {
 public:
  Shell(FieldPtr field, double thickness) : UnaryField(std::move(field)), thickness_(thickness) {}
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    field().values(points, values, gradients);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!gradients.empty() && values[i] < 0.0) gradients[i] = -gradients[i];
      values[i] = std::abs(values[i]) - 0.5 * thickness_;
    }
  }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval b = field().bound(box);
    const double least = b.contains(0.0) ? 0.0 : std::min(std::abs(b.lo), std::abs(b.hi));
    return {least - 0.5 * thickness_, std::max(std::abs(b.lo), std::abs(b.hi)) - 0.5 * thickness_};
  }

 private:
  [[nodiscard]] FieldPtr with(FieldPtr field) const override {
    return std::make_shared<Shell>(std::move(field), thickness_);
  }
  double thickness_;
};

class Labelled final : public UnaryField {
 public:
  Labelled(FieldPtr field, Label label) : UnaryField(std::move(field)), label_(label) {}
  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    field().values(points, values, gradients);
  }
  void between(const Points& points, std::span<const double> floors, std::span<double> values,
               std::span<Vec3> gradients) const noexcept override {
    field().between(points, floors, values, gradients);
  }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override { return field().bound(box); }
  [[nodiscard]] std::optional<Box> support() const noexcept override { return field().support(); }
  void labels(const Points&, std::span<Label> labels) const noexcept override {
    std::fill(labels.begin(), labels.end(), label_);
  }

 private:
  [[nodiscard]] FieldPtr with(FieldPtr field) const override {
    return std::make_shared<Labelled>(std::move(field), label_);
  }
  Label label_;
};

class Transformed final : public UnaryField {
 public:
  Transformed(FieldPtr field, const Mat3& rotation, double scale, const Vec3& translation)
      : UnaryField(std::move(field)), world_from_local_(rotation), scale_(scale), translation_(translation) {}

  void values(const Points& points, std::span<double> values, std::span<Vec3> gradients) const noexcept override {
    for_each_block(points, [&](std::size_t first, const Points& local) {
      const std::size_t n = local.size();
      field().values(local, values.subspan(first, n), gradients.empty() ? gradients : gradients.subspan(first, n));
    });
    for (double& v : values) v *= scale_;
    for (Vec3& g : gradients) g = world_from_local_ * g;
  }
  [[nodiscard]] Modulus modulus() const noexcept override {
    const Modulus inner = field().modulus();
    return {inner.slope, scale_ * inner.slack};
  }
  void labels(const Points& points, std::span<Label> labels) const noexcept override {
    for_each_block(points, [&](std::size_t first, const Points& local) {
      field().labels(local, labels.subspan(first, local.size()));
    });
  }
  [[nodiscard]] Interval bound(const Box& box) const noexcept override {
    const Interval b = field().bound(local_box(box));
    return {scale_ * b.lo, scale_ * b.hi};
  }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override { return narrowed(local_box(box)); }
  [[nodiscard]] std::optional<Box> support() const noexcept override {
    const std::optional<Box> local = field().support();
    if (!local) return std::nullopt;
    const Vec3 centre = world_from_local_ * (scale_ * local->centre()) + translation_;
    return around(centre, scale_ * (absolute(world_from_local_) * (0.5 * local->size())), translation_);
  }

 private:
  [[nodiscard]] FieldPtr with(FieldPtr field) const override {
    return std::make_shared<Transformed>(std::move(field), world_from_local_, scale_, translation_);
  }

  template <class F>
  void for_each_block(const Points& points, F&& visit) const noexcept {
    std::array<double, kBlock> x, y, z;
    for (std::size_t first = 0; first < points.size(); first += kBlock) {
      const std::size_t n = std::min(kBlock, points.size() - first);
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3 local = local_point(points[first + i]);
        x[i] = local.x;
        y[i] = local.y;
        z[i] = local.z;
      }
      visit(first, Points{{x.data(), n}, {y.data(), n}, {z.data(), n}});
    }
  }

  [[nodiscard]] Vec3 local_point(const Vec3& p) const noexcept {
    return (p - translation_) * world_from_local_ / scale_;
  }
  [[nodiscard]] Box local_box(const Box& box) const noexcept {
    const Vec3 reach = absolute(glm::transpose(world_from_local_)) * (0.5 * box.size()) / scale_;
    return around(local_point(box.centre()), reach, (glm::abs(box.centre()) + glm::abs(translation_)) / scale_);
  }
  /// The box around `centre`, and a little more: transformed points are rounded at the size of `largest`.
  [[nodiscard]] static Box around(const Vec3& centre, const Vec3& reach, const Vec3& largest) noexcept {
    const Vec3 size = glm::abs(centre) + reach + glm::abs(largest);
    return Box{centre - reach, centre + reach}.grown(1e-14 * (size.x + size.y + size.z));
  }
  [[nodiscard]] static Mat3 absolute(const Mat3& m) noexcept {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
  }

  Mat3 world_from_local_;  ///< The rotation; scale and translation follow.
  double scale_;
  Vec3 translation_;
};

/// One node over all polytopes is much faster than a fold of nodes; null when some field is none.
[[nodiscard]] FieldPtr union_of_polytopes(const std::vector<FieldPtr>& fields) {
  std::vector<PolytopeKernel> kernels;
  std::vector<Vec3> positions;
  for (const FieldPtr& field : fields) {
    const auto* const polytope = dynamic_cast<const RoundedPolytope*>(field.get());
    if (!polytope) return nullptr;
    kernels.push_back(polytope->kernel());
    positions.push_back(polytope->centre());
  }
  return std::make_shared<PolytopeUnion>(std::move(kernels), positions);
}

[[nodiscard]] FieldPtr fold_of(Side side, double radius, std::vector<FieldPtr> fields) {
  require(!fields.empty(), "fields", "at least 1", 0.0);
  for (const FieldPtr& field : fields) require(field != nullptr, "fields", "no null", "null");
  require(radius >= 0.0 && std::isfinite(radius), "radius", ">= 0 and finite", radius);
  if (fields.size() == 1) return fields[0];
  if (side == Side::Smallest && radius == 0.0)
    if (FieldPtr polytopes = union_of_polytopes(fields)) return polytopes;
  FieldPtr material = side == Side::Largest ? fields[0] : nullptr;
  return std::make_shared<FoldField>(side, radius, std::move(fields), std::move(material));
}

[[nodiscard]] FieldPtr complement(FieldPtr field) {
  require(field != nullptr, "field", "a field", "null");
  return std::make_shared<Complement>(std::move(field));
}

}  // namespace

FieldPtr union_of(std::vector<FieldPtr> fields) { return fold_of(Side::Smallest, 0.0, std::move(fields)); }
FieldPtr intersection_of(std::vector<FieldPtr> fields) { return fold_of(Side::Largest, 0.0, std::move(fields)); }
FieldPtr difference_of(FieldPtr a, FieldPtr b) { return smooth_difference_of(std::move(a), std::move(b), 0.0); }
FieldPtr smooth_union_of(std::vector<FieldPtr> fields, double radius) {
  return fold_of(Side::Smallest, radius, std::move(fields));
}
FieldPtr smooth_intersection_of(std::vector<FieldPtr> fields, double radius) {
  return fold_of(Side::Largest, radius, std::move(fields));
}
FieldPtr smooth_difference_of(FieldPtr a, FieldPtr b, double radius) {
  return fold_of(Side::Largest, radius, {std::move(a), complement(std::move(b))});
}

FieldPtr transformed(FieldPtr field, const Mat3& rotation, double scale, const Vec3& translation) {
  constexpr double kTolerance = 1e-6;
  require(field != nullptr, "field", "a field", "null");
  require(scale > 0.0 && std::isfinite(scale), "scale", "> 0 and finite", scale);
  for (int axis = 0; axis < 3; ++axis) {
    require(std::isfinite(translation[axis]), "translation", "finite", translation[axis]);
    for (int other = 0; other < 3; ++other) {
      const double product = glm::dot(rotation[axis], rotation[other]);
      require(std::abs(product - (axis == other ? 1.0 : 0.0)) < kTolerance, "rotation", "orthonormal columns", product);
    }
  }
  return std::make_shared<Transformed>(std::move(field), rotation, scale, translation);
}

FieldPtr offset(FieldPtr field, double thickness) {
  require(field != nullptr, "field", "a field", "null");
  require(std::isfinite(thickness), "thickness", "finite", thickness);
  return std::make_shared<Offset>(std::move(field), thickness);
}

FieldPtr shell(FieldPtr field, double thickness) {
  require(field != nullptr, "field", "a field", "null");
  require(thickness > 0.0 && std::isfinite(thickness), "thickness", "> 0 and finite", thickness);
  return std::make_shared<Shell>(std::move(field), thickness);
}

FieldPtr labelled(FieldPtr field, Label label) {
  require(field != nullptr, "field", "a field", "null");
  return std::make_shared<Labelled>(std::move(field), label);
}

}  // namespace outcrop
