#include "race_model.h"

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <ostream>

#include "outcrop/core/error.h"
#include "outcrop/implicit/combine.h"

namespace outcrop::race {
namespace {

/// Numbers the lines of an expression.
class Expression {
 public:
  explicit Expression(std::ostream& out) : out_(out) { out_.precision(17); }

  using Node = std::size_t;
  Node constant(double value) {
    out_ << '_' << next_ << " const " << value << '\n';
    return next_++;
  }
  Node operator()(const char* operation, std::initializer_list<Node> arguments = {}) {
    out_ << '_' << next_ << ' ' << operation;
    for (const Node argument : arguments) out_ << " _" << argument;
    out_ << '\n';
    return next_++;
  }

 private:
  std::ostream& out_;
  Node next_ = 0;
};

}  // namespace

Model read_model(const std::string& path) {
  std::ifstream file(path);
  Model model;
  std::size_t blocks = 0;
  file >> blocks >> model.rounding;
  for (std::size_t b = 0; file && b < blocks; ++b) {
    std::size_t count = 0;
    file >> count;
    std::vector<Plane>& planes = model.blocks.emplace_back();
    for (std::size_t i = 0; file && i < count; ++i) {
      Plane& plane = planes.emplace_back();
      file >> plane.normal.x >> plane.normal.y >> plane.normal.z >> plane.offset;
      plane.normal = glm::normalize(plane.normal);
    }
  }
  if (!file || model.blocks.empty()) throw InputError(path + ": expected a model: N R, then planes by block");
  return model;
}

Model make_model(Seed seed) {
  constexpr int kBlocks = 100, kPlanes = 20, kSeedsAcross = 5;
  const double golden_angle = std::acos(-1.0) * (3.0 - std::sqrt(5.0));
  Model model;
  for (int b = 0; b < kBlocks; ++b) {
    Rng rng(seed, "race block", b);
    const Vec3 cell(b % kSeedsAcross, b / kSeedsAcross % kSeedsAcross, b / kSeedsAcross / kSeedsAcross);
    const Vec3 centre = 4.8 * (cell - 2.0) + 0.2 * rng.direction();
    std::vector<Plane>& planes = model.blocks.emplace_back();
    for (int i = 0; i < kPlanes; ++i) {
      // Spread over the sphere, so that no block has a corner far out.
      const double z = 1.0 - (2.0 * i + 1.0) / kPlanes, r = std::sqrt(1.0 - z * z);
      const Vec3 spread(r * std::cos(golden_angle * i), r * std::sin(golden_angle * i), z);
      const Vec3 normal = glm::normalize(spread + 0.25 * rng.direction());
      const double distance = rng.uniform(1.85, 2.35);
      planes.push_back({normal, -glm::dot(normal, centre) - distance});
    }
  }
  return model;
}

FieldPtr field_of(const Model& model) {
  std::vector<FieldPtr> blocks;
  for (const std::vector<Plane>& planes : model.blocks)
    blocks.push_back(std::make_shared<RoundedPolytope>(planes, Vec3(0.0), model.rounding));
  return union_of(std::move(blocks));
}

void write_expression(std::ostream& out, const Model& model) {
  Expression e(out);
  const double rounding = model.rounding / kHalf;
  const auto x = e("var-x"), y = e("var-y"), z = e("var-z"), zero = e.constant(0.0), reach = e.constant(rounding),
             weight = e.constant(1.0 / (6.0 * rounding * rounding));
  const auto smax = [&](auto a, auto b) {
    const auto near = e("max", {e("sub", {reach, e("abs", {e("sub", {a, b})})}), zero});
    return e("add", {e("max", {a, b}), e("mul", {e("mul", {e("square", {near}), near}), weight})});
  };
  std::vector<Expression::Node> fields;
  for (const std::vector<Plane>& planes : model.blocks) {
    for (const Plane& plane : planes) {
      const auto along = [&](double n, auto axis) { return e("mul", {e.constant(n), axis}); };
      const auto xy = e("add", {along(plane.normal.x, x), along(plane.normal.y, y)});
      const auto xyz = e("add", {xy, along(plane.normal.z, z)});
      const auto distance = e("add", {xyz, e.constant(plane.offset / kHalf)});
      if (&plane == &planes.front())
        fields.push_back(distance);
      else
        fields.back() = smax(fields.back(), distance);
    }
  }
  while (fields.size() > 1) {
    std::vector<Expression::Node> halved;
    for (std::size_t i = 0; i < fields.size(); i += 2)
      halved.push_back(i + 1 < fields.size() ? e("min", {fields[i], fields[i + 1]}) : fields[i]);
    fields = std::move(halved);
  }
}

}  // namespace outcrop::race
