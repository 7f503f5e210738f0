/// What fields made of one other field have in common.
#pragma once

#include <utility>

#include "outcrop/implicit/field.h"

namespace outcrop {

/// A field made of one other: labels, the Lipschitz constant and the modulus pass through, narrowing narrows the inner field.
class UnaryField : public Field {
 public:
  explicit UnaryField(FieldPtr field) : field_(std::move(field)) {}
  [[nodiscard]] double lipschitz() const noexcept override { return field_->lipschitz(); }
  [[nodiscard]] Modulus modulus() const noexcept override { return field_->modulus(); }
  [[nodiscard]] FieldPtr narrow(const Box& box) const override { return narrowed(box); }
  void labels(const Points& points, std::span<Label> labels) const noexcept override { field_->labels(points, labels); }

 protected:
  [[nodiscard]] const Field& field() const noexcept { return *field_; }
  /// The same node over another inner field.
  [[nodiscard]] virtual FieldPtr with(FieldPtr field) const = 0;
  /// This node over the inner field narrowed to `inner_box`, in the inner field's frame.
  [[nodiscard]] FieldPtr narrowed(const Box& inner_box) const {
    FieldPtr inner = field_->narrow(inner_box);
    return inner == field_ ? shared_from_this() : with(std::move(inner));
  }

 private:
  FieldPtr field_;
};

}  // namespace outcrop
