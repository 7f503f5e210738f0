#include "outcrop/fracture/classify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "outcrop/core/error.h"
#include "outcrop/fracture/orientations.h"
#include "rock_cells.h"

namespace outcrop {
namespace {

constexpr double kConeCosine = 0.9396926207859084;    // 20°: twice the scatter of a set of κ = 60.
constexpr double kAcrossCosine = 0.3420201433256687;  // 20° from across.
constexpr std::size_t kMostFaces = 2000;              // More do not tell more.
constexpr std::size_t kMostCones = 5;

// Thresholds between the types; the figures of the types are in docs/decisions/rock_statistics.md.
constexpr double kSets = 0.645;        // Least set_share of rock with joint sets.
constexpr double kColumnSets = 0.79;   // Most of columns, whose sides have many directions.
constexpr double kPrism = 0.9;         // Least prism_share of columns.
constexpr double kColumnLength = 2.0;  // Least elongation of columns.
constexpr double kTabular = 2.0;       // Least fabric_flatness.
constexpr double kPrismatic = 1.6;     // Least fabric_elongation.
constexpr double kSquare = 0.8;        // Least square_share, of the set_share, of sets at right angles.

/// Face normals with their areas, which sum to 1.
struct Faces {
  std::vector<Vec3> normals;
  std::vector<double> areas;

  /// The area within a cone about an axis, of the faces that `is_left`.
  [[nodiscard]] double within(const Vec3& axis, const std::vector<bool>& is_left) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < normals.size(); ++i)
      if (is_left[i] && std::abs(glm::dot(axis, normals[i])) >= kConeCosine) sum += areas[i];
    return sum;
  }
};

Faces faces_of(const RockCells& rock) {
  std::size_t count = 0;
  for (const RockCells::Cell& cell : rock.cells()) count += cell.shape.faces.size();  // walls of a box among them
  const std::size_t step = count / kMostFaces + 1;
  Faces faces;
  std::size_t i = 0;
  for (const RockCells::Cell& cell : rock.cells())
    for (const Polytope::Face& face : cell.shape.faces)
      if (i++ % step == 0 && face.joint != kWall) {
        const FaceMeasure m = measure(cell.shape, face);
        faces.normals.push_back(m.normal);
        faces.areas.push_back(m.area);
      }
  const double sum = std::accumulate(faces.areas.begin(), faces.areas.end(), 0.0);
  for (double& area : faces.areas) area /= sum;
  return faces;
}

struct Cone {
  Vec3 axis{0.0};
  double area = 0.0;
};

// The directions that hold most face area, one after the other, the faces of those before being left out.
std::vector<Cone> heaviest_cones(const Faces& faces) {
  std::vector<bool> is_left(faces.normals.size(), true);
  std::vector<Cone> cones;
  while (cones.size() < kMostCones) {
    Cone best;
    for (std::size_t i = 0; i < faces.normals.size(); ++i)
      if (is_left[i])
        if (const double area = faces.within(faces.normals[i], is_left); area > best.area)
          best = {faces.normals[i], area};
    if (best.area <= 0.0) break;
    std::vector<Vec3> normals;
    std::vector<double> areas;
    for (std::size_t i = 0; i < faces.normals.size(); ++i)
      if (is_left[i] && std::abs(glm::dot(best.axis, faces.normals[i])) >= kConeCosine) {
        is_left[i] = false;
        normals.push_back(faces.normals[i]);
        areas.push_back(faces.areas[i]);
      }
    best.axis = axis_statistics(normals, areas).mean;
    cones.push_back(best);
  }
  return cones;
}

// The square frame along two of the cones that holds most face area.
std::array<Vec3, 3> square_frame(const Faces& faces, const std::vector<Cone>& cones, double& share) {
  const std::vector<bool> all(faces.normals.size(), true);
  std::array<Vec3, 3> best{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  share = -1.0;
  for (const Cone& first : cones)
    for (const Cone& second : cones) {
      const Vec3 across = second.axis - glm::dot(second.axis, first.axis) * first.axis;
      if (glm::length(across) < kAcrossCosine) continue;
      const Vec3 v = glm::normalize(across);
      const std::array<Vec3, 3> frame{first.axis, v, glm::cross(first.axis, v)};
      double area = 0.0;
      for (const Vec3& axis : frame) area += faces.within(axis, all);
      if (area > share) {
        share = area;
        best = frame;
      }
    }
  share = std::clamp(share, 0.0, 1.0);
  return best;
}

double prism_share(const Faces& faces, const std::vector<Cone>& cones) {
  double best = 0.0;
  const auto share = [&](const Vec3& axis) {
    double sum = 0.0;
    for (std::size_t i = 0; i < faces.normals.size(); ++i) {
      const double c = std::abs(glm::dot(axis, faces.normals[i]));
      if (c <= kAcrossCosine || c >= kConeCosine) sum += faces.areas[i];
    }
    return sum;
  };
  for (std::size_t i = 0; i < cones.size(); ++i) {
    best = std::max(best, share(cones[i].axis));
    for (std::size_t j = 0; j < i; ++j)  // an axis along two directions may have no faces across it
      if (const Vec3 axis = glm::cross(cones[i].axis, cones[j].axis); glm::length(axis) > 0.5)
        best = std::max(best, share(glm::normalize(axis)));
  }
  return best;
}

}  // namespace

Classification classify(const Tile& tile) {
  require(!tile.blocks.empty(), "tile", "at least one block", 0.0);
  const RockCells rock(tile);
  const Faces faces = faces_of(rock);
  const std::vector<Cone> cones = heaviest_cones(faces);
  Classification result;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, cones.size()); ++i) result.set_share += cones[i].area;
  result.set_share = std::min(1.0, result.set_share);
  const std::array<Vec3, 3> frame = square_frame(faces, cones, result.square_share);
  result.prism_share = std::min(1.0, prism_share(faces, cones));

  const auto n = static_cast<double>(tile.blocks.size());
  std::array<double, 3> extents{};  // logarithms
  for (const RockCells::Cell& cell : rock.cells())
    for (std::size_t axis = 0; axis < 3; ++axis)
      extents[axis] += std::log(cell.shape.distances({frame[axis], 0.0}).width()) / n;
  std::sort(extents.begin(), extents.end());
  result.fabric_elongation = std::exp(extents[2] - extents[1]);
  result.fabric_flatness = std::exp(extents[1] - extents[0]);
  double elongation = 0.0;
  for (const Block& block : tile.blocks) {
    const auto size = principal_sizes(block.hull);
    elongation += std::log(size[0] / size[1]) / n;
  }
  result.elongation = std::exp(elongation);

  const bool is_column = result.prism_share >= kPrism && result.elongation >= kColumnLength;
  if (result.set_share < kColumnSets && is_column)
    result.type = BlockType::Columnar;
  else if (result.set_share < kSets)
    result.type = BlockType::Polyhedral;
  else if (result.square_share < kSquare * result.set_share)
    result.type = BlockType::Rhombohedral;
  else if (result.fabric_flatness >= kTabular)
    result.type = BlockType::Tabular;
  else if (result.fabric_elongation >= kPrismatic)
    result.type = BlockType::Prismatic;
  else
    result.type = BlockType::Equidimensional;
  return result;
}

}  // namespace outcrop
