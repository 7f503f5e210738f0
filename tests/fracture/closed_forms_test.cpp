// Rock whose measures are known in closed form: persistent joints in a box, columns, and what sets are drawn by.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "outcrop/core/error.h"
#include "outcrop/fracture/clusters.h"

namespace outcrop {
namespace {

constexpr int kSeeds = 50;
constexpr double kErrors = 4.0;     // Standard errors that a mean may be off.
constexpr double kParallel = 1e20;  // A Fisher concentration without scatter.

JointSet planes(const Vec3& normal, double spacing, SpacingLaw law = SpacingLaw::Exponential) {
  return {.normal = glm::normalize(normal),
          .kappa = kParallel,
          .spacing = spacing,
          .spacing_law = law,
          .radius_law = RadiusLaw::Persistent};
}

// Cells cut by geometry alone: no chip, blade or length stops a joint.
Clusters cells(const JointPattern& pattern, double side, Seed seed, Domain domain = Domain::Box) {
  const ClusterOptions options{.side = side,
                               .min_samples = 0,
                               .min_inradius = 0.0,
                               .least_angle = 0.0,
                               .longest = 100.0 * side,
                               .columns = pattern.columns,
                               .sets = pattern.sets,
                               .domain = domain};
  return split_samples({}, Graph{{0}, {}}, draw_discs(pattern, side, seed, domain), options, seed);
}

bool touches_wall(const Polytope& shape) {
  return std::any_of(shape.faces.begin(), shape.faces.end(),
                     [](const Polytope::Face& face) { return face.joint == kWall; });
}

struct Cell {
  double weight, volume, faces, edges, vertices;
};

// The cells that lie in the box. Larger ones do so less often: each counts for as many as there are positions of the
// box, over those in which it lies within (minus-sampling, weights after Horvitz and Thompson).
std::vector<Cell> inner_cells(const Clusters& clusters, double side) {
  std::vector<Cell> result;
  for (const Cluster& cluster : clusters.list) {
    const Polytope& shape = cluster.shape;
    if (touches_wall(shape)) continue;
    const Vec3 room = 1.0 - shape.bounds().size() / side;
    double corners = 0.0;
    for (const Polytope::Face& face : shape.faces) corners += static_cast<double>(face.loop.size());
    result.push_back({1.0 / (room.x * room.y * room.z), shape.volume(), static_cast<double>(shape.faces.size()),
                      0.5 * corners, static_cast<double>(shape.vertices.size())});
  }
  return result;
}

// A mean over all cells of all seeds, and its standard error from what differs between seeds.
class RatioMean {
 public:
  void add_seed(const std::vector<Cell>& cells, double (*value)(const Cell&), double (*weight)(const Cell&)) {
    double above = 0.0;
    double below = 0.0;
    for (const Cell& cell : cells) {
      above += weight(cell) * value(cell);
      below += weight(cell);
    }
    above_.push_back(above);
    below_.push_back(below);
  }
  [[nodiscard]] double mean() const { return sum(above_) / sum(below_); }
  [[nodiscard]] double error() const {
    double square = 0.0;
    for (std::size_t i = 0; i < above_.size(); ++i) square += std::pow(above_[i] - mean() * below_[i], 2);
    const auto n = static_cast<double>(above_.size());
    return std::sqrt(square * n / (n - 1.0)) / sum(below_);
  }

 private:
  static double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
  std::vector<double> above_, below_;
};

void expect_mean(const RatioMean& found, double expected, double most_error, const char* what) {
  EXPECT_NEAR(found.mean(), expected, kErrors * found.error()) << what;
  EXPECT_LT(found.error(), most_error * expected) << what << ": the test would see nothing";
}

double by_number(const Cell& cell) { return cell.weight; }
double by_volume(const Cell& cell) { return cell.weight * cell.volume; }
double volume_of(const Cell& cell) { return cell.volume; }

void expect_poisson_cells(const JointPattern& pattern, double side, double mean_volume) {
  RatioMean volume, faces, edges, vertices;
  for (Seed seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<Cell> found = inner_cells(cells(pattern, side, seed), side);
    volume.add_seed(found, volume_of, by_number);
    faces.add_seed(found, [](const Cell& cell) { return cell.faces; }, by_number);
    edges.add_seed(found, [](const Cell& cell) { return cell.edges; }, by_number);
    vertices.add_seed(found, [](const Cell& cell) { return cell.vertices; }, by_number);
  }
  expect_mean(volume, mean_volume, 0.1, "volume");
  expect_mean(faces, 6.0, 0.01, "faces");
  expect_mean(edges, 12.0, 0.01, "edges");
  expect_mean(vertices, 8.0, 0.01, "vertices");
}

// Three normals at the same angle to each other, about the cube's diagonal.
std::vector<Vec3> oblique_normals(double angle) {
  const double sine = std::sqrt((1.0 - std::cos(angle)) / 1.5);
  std::vector<Vec3> normals;
  for (int i = 0; i < 3; ++i) {
    Vec3 away(1.0 / std::sqrt(3.0));
    away[i] -= std::sqrt(3.0);
    normals.push_back(std::sqrt(1.0 - sine * sine) * Vec3(1.0 / std::sqrt(3.0)) + sine * glm::normalize(away));
  }
  return normals;
}

TEST(PersistentPlanes, IsotropicOnesHaveTheCellsOfAPoissonTessellation) {
  // Mean volume 48 / (π P32³) = 15.279 / P32³.
  const double p32 = 3.0;
  const JointSet set{.kappa = 1e-9, .p32 = p32, .radius_law = RadiusLaw::Persistent};
  expect_poisson_cells({.sets = {set}}, 14.0, 48.0 / (kPi * std::pow(p32, 3)));
}

TEST(PersistentPlanes, OfThreeSetsHaveCellsByTheirDeterminant) {
  // Mean volume 27 / (P32³ |det|) of three equal sets.
  const double p32 = 3.0;
  for (const double angle : {90.0, 60.0}) {
    JointPattern pattern;
    const std::vector<Vec3> n = oblique_normals(radians(angle));
    for (const Vec3& normal : n) pattern.sets.push_back(planes(normal, 3.0 / p32));
    const double det = std::abs(glm::dot(n[0], glm::cross(n[1], n[2])));
    SCOPED_TRACE(angle);
    expect_poisson_cells(pattern, 14.0, 27.0 / (p32 * p32 * p32 * det));
  }
}

TEST(PersistentPlanes, OrthogonalExponentialSpacingsHaveTheKnownSpreadOfVolumes) {
  // In units of s₁ s₂ s₃: mean 1, CV √7, median 0.223, volume-weighted mean 8 and quantiles 0.572, 3.94, 19.4.
  const double side = 24.0;
  const Vec3 s(1.0, 0.8, 1.25);
  const JointPattern pattern{.sets = {planes({1, 0, 0}, s.x), planes({0, 1, 0}, s.y), planes({0, 0, 1}, s.z)}};
  RatioMean mean, square, weighted, median, tenth, half, most;
  for (Seed seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<Cell> found = inner_cells(cells(pattern, side, seed), side);
    mean.add_seed(found, volume_of, by_number);
    square.add_seed(found, [](const Cell& cell) { return cell.volume * cell.volume; }, by_number);
    weighted.add_seed(found, volume_of, by_volume);
    median.add_seed(found, [](const Cell& cell) { return cell.volume < 0.223 ? 1.0 : 0.0; }, by_number);
    tenth.add_seed(found, [](const Cell& cell) { return cell.volume < 0.572 ? 1.0 : 0.0; }, by_volume);
    half.add_seed(found, [](const Cell& cell) { return cell.volume < 3.94 ? 1.0 : 0.0; }, by_volume);
    most.add_seed(found, [](const Cell& cell) { return cell.volume < 19.4 ? 1.0 : 0.0; }, by_volume);
  }
  expect_mean(mean, 1.0, 0.06, "mean volume");
  expect_mean(square, 8.0, 0.12, "mean square: CV² + 1 = 8");
  expect_mean(weighted, 8.0, 0.1, "volume-weighted mean");
  expect_mean(median, 0.5, 0.04, "share of cells below the median");
  expect_mean(tenth, 0.1, 0.1, "share of volume below D10");
  expect_mean(half, 0.5, 0.06, "share of volume below D50");
  expect_mean(most, 0.9, 0.04, "share of volume below D90");
}

TEST(PersistentPlanes, AtFixedSpacingsHaveTheVolumeOfTheDeterminantNotOfTheSines) {
  struct Case {
    double angle, exact, sine_error;  // Vb / S³, and what the sine form says too much
  };
  for (const auto& [angle, exact, sine_error] :
       {Case{75, 1.0952, 0.013}, Case{60, 1.4142, 0.089}, Case{50, 1.8517, 0.20}, Case{45, 2.1974, 0.287}}) {
    SCOPED_TRACE(angle);
    JointPattern pattern;
    for (const Vec3& normal : oblique_normals(radians(angle)))
      pattern.sets.push_back(planes(normal, 1.5, SpacingLaw::Fixed));
    const double cube = std::pow(1.5, 3);
    std::size_t whole = 0;
    for (Seed seed = 1; seed <= kSeeds; ++seed)
      for (const Cell& cell : inner_cells(cells(pattern, 8.0, seed), 8.0)) {
        ASSERT_NEAR(cell.volume / cube, exact, 1e-4);
        ASSERT_EQ(cell.faces, 6.0);
        ++whole;
      }
    EXPECT_GT(whole, 8u * kSeeds);
    const double sine_form = 1.0 / std::pow(std::sin(radians(angle)), 3);
    EXPECT_NEAR(sine_form / exact - 1.0, sine_error, 0.001 + 0.03 * sine_error);
  }
}

TEST(PersistentPlanes, HaveTheIntensityOfTheirSpacingOnTheTorus) {
  // P32 = Σ 1/S, also where turned planes close the tile and where a set does not close it.
  for (const SpacingLaw law : {SpacingLaw::Fixed, SpacingLaw::Exponential, SpacingLaw::Lognormal})
    for (Seed seed = 1; seed <= 5; ++seed) {
      const double side = 20.0;
      JointPattern pattern{.sets = {planes({1, 0.05, 0}, 2.0, law), planes({0, 1, 0.05}, 2.5, law),
                                    planes({0.05, 0, 1}, 4.0, law)}};
      const Clusters clusters = cells(pattern, side, seed, Domain::Torus);
      double volume = 0.0;
      for (const Cluster& cluster : clusters.list) volume += cluster.shape.volume();
      EXPECT_NEAR(volume, side * side * side, 1e-6);
      double area = 0.0;
      for (const Cluster& cluster : clusters.list)
        for (const Polytope::Face& face : cluster.shape.faces)
          for (std::size_t i = 2; i < face.loop.size(); ++i) {
            const Vec3& o = cluster.shape.vertices[face.loop[0]];
            area += 0.25 * glm::length(glm::cross(cluster.shape.vertices[face.loop[i - 1]] - o,
                                                  cluster.shape.vertices[face.loop[i]] - o));
          }
      EXPECT_NEAR(area / volume, 1 / 2.0 + 1 / 2.5 + 1 / 4.0, 0.03);
      EXPECT_EQ(clusters.added_joints, 0u);
    }
}

TEST(PersistentPlanes, KeepTheLawOfTheirSpacingAroundTheTorus) {
  // N gaps that add up to a period: of exponential ones CV² = (N − 1) / (N + 1).
  const double side = 20.0;
  const double count = 20.0;
  for (const SpacingLaw law : {SpacingLaw::Fixed, SpacingLaw::Exponential, SpacingLaw::Lognormal}) {
    double square = 0.0;
    for (Seed seed = 1; seed <= kSeeds; ++seed) {
      const JointPattern pattern{
          .sets = {planes({1, 0, 0}, side / count, law), planes({0, 1, 0}, 10.0), planes({0, 0, 1}, 10.0)}};
      std::vector<double> at;
      for (const Disc& disc : cells(pattern, side, seed, Domain::Torus).discs)
        if (disc.set == 0) at.push_back(disc.centre.x - side * std::floor(disc.centre.x / side));
      ASSERT_EQ(at.size(), count);
      std::sort(at.begin(), at.end());
      for (std::size_t i = 0; i < at.size(); ++i) {
        const double gap = i > 0 ? at[i] - at[i - 1] : at[0] + side - at.back();
        square += std::pow(gap * count / side - 1.0, 2) / (count * kSeeds);
      }
    }
    const double expected = law == SpacingLaw::Fixed ? 0.0 : law == SpacingLaw::Exponential ? (count - 1) / (count + 1) : 0.25;
    EXPECT_NEAR(std::sqrt(square), std::sqrt(expected), 0.1 * std::sqrt(expected) + 1e-9);
  }
}

TEST(Columns, OfHexagonsHaveTheirClosedForm) {
  // Vb = √3/2 d² h and P32 = 2/d + 1/h; d from the columns' mean area, since the lattice is stretched to the tile.
  const double side = 14.0;
  const double height = 3.5;
  JointSet cross = planes({0, 0, 1}, height, SpacingLaw::Fixed);
  cross.ends_at = {std::string(kColumns)};
  const JointPattern pattern{.sets = {cross}, .columns = {{.width = 2.0, .irregularity = 0.0}}};
  const Clusters clusters = cells(pattern, side, 1, Domain::Torus);
  const double columns = static_cast<double>(clusters.list.size()) / (side / height);
  EXPECT_NEAR(columns, 7 * 8, 1e-9);
  const double d = std::sqrt(side * side / columns / (0.5 * std::sqrt(3.0)));
  double area = 0.0;
  std::set<double> levels;
  for (const Cluster& cluster : clusters.list) {
    EXPECT_EQ(cluster.shape.faces.size(), 8u) << "six sides, two ends";
    EXPECT_NEAR(cluster.shape.volume(), 0.5 * std::sqrt(3.0) * d * d * height, 1e-9);
    levels.insert(cluster.shape.bounds().lo.z);
    for (const Polytope::Face& face : cluster.shape.faces)
      for (std::size_t i = 2; i < face.loop.size(); ++i) {
        const Vec3& o = cluster.shape.vertices[face.loop[0]];
        area += 0.25 * glm::length(glm::cross(cluster.shape.vertices[face.loop[i - 1]] - o,
                                              cluster.shape.vertices[face.loop[i]] - o));
      }
  }
  EXPECT_NEAR(area / (side * side * side), 2.0 / d + 1.0 / height, 1e-3);
  EXPECT_EQ(levels.size(), clusters.list.size()) << "cross joints end at columns: each has its own";
}

TEST(Columns, HaveFourToEightSidesAndSixOnAverage) {
  for (const double irregularity : {0.2, 0.5, 1.0}) {
    double sides = 0.0, usual = 0.0, count = 0.0;
    for (Seed seed = 1; seed <= 10; ++seed) {
      const JointPattern pattern{.columns = {{.width = 1.5, .irregularity = irregularity}}};
      for (const Cluster& cluster : cells(pattern, 20.0, seed, Domain::Torus).list) {
        const auto own = static_cast<double>(std::count_if(
            cluster.shape.faces.begin(), cluster.shape.faces.end(),
            [](const Polytope::Face& face) { return face.joint == kColumnJoint; }));
        sides += own;
        usual += own >= 4 && own <= 8;
        ++count;
      }
    }
    EXPECT_NEAR(sides / count, 6.0, 1e-9) << irregularity;
    EXPECT_GT(usual / count, irregularity < 1.0 ? 1.0 - 1e-3 : 0.99) << irregularity;
  }
}

TEST(Columns, InTiersMeetAtAJoint) {
  const double side = 20.0;
  const JointPattern pattern{.columns = {{.width = 3.0, .irregularity = 0.3, .height = 2.0},
                                         {.width = 1.2, .irregularity = 1.0, .height = 1.0}}};
  const Clusters clusters = cells(pattern, side, 3, Domain::Torus);
  double below = 0.0, above = 0.0, volume = 0.0;
  for (const Cluster& cluster : clusters.list) {
    const Box bounds = cluster.shape.bounds();
    volume += cluster.shape.volume();
    const bool is_lower = bounds.lo.z < 1.0;
    EXPECT_NEAR(bounds.lo.z, is_lower ? 0.0 : side * 2.0 / 3.0, 1e-9);
    EXPECT_NEAR(bounds.hi.z, is_lower ? side * 2.0 / 3.0 : side, 1e-9);
    (is_lower ? below : above) += 1.0;
  }
  EXPECT_NEAR(volume, side * side * side, 1e-6);
  EXPECT_NEAR(above / below, std::pow(3.0 / 1.2, 2), 0.1);
}

TEST(DrawDiscs, HaveTheIntensityAskedFor) {
  // Within the box, lines meet discs as P32 E|n · t| says; on the torus Σ π r² / V is P32 to half a disc.
  const double side = 12.0;
  const JointPattern random{.sets = {{.kappa = 1e-9, .p32 = 0.8, .radius_lo = 1.0, .radius_hi = 3.0}},
                            .centre_spacing = 0.0};
  JointPattern sheets = random;
  sheets.sets[0] = {.normal = glm::normalize(Vec3(1, 2, 5)), .kappa = kParallel, .spacing = 0.75,
                    .persistence = 0.6, .radius_lo = 1.0, .radius_hi = 3.0};
  const Vec3 line = glm::normalize(Vec3(0.1, 0.2, 1.0));
  for (const JointPattern* pattern : {&random, &std::as_const(sheets)}) {
    const bool is_random = pattern == &random;
    const double p32 = 0.8;  // 0.6 / 0.75 for the sheets
    const double cosine = is_random ? 0.5 : glm::dot(pattern->sets[0].normal, line);
    const double half_disc = 0.5 * kPi * 9.0 / std::pow(side, 3);
    std::vector<double> rates;
    for (Seed seed = 1; seed <= kSeeds; ++seed) {
      const auto discs = draw_discs(*pattern, side, seed);
      if (is_random) {
        EXPECT_NEAR(intensity(discs, side), p32, half_disc);
      }
      double hits = 0.0;
      const auto in_box = draw_discs(*pattern, side, seed, Domain::Box);
      for (int k = 0; k < 40; ++k) {
        Rng rng(seed, "lines", static_cast<std::uint64_t>(k));
        const double x = rng.uniform(0.0, 0.7 * side);
        const double y = rng.uniform(0.0, 0.7 * side);
        const Vec3 from(x, y, 0.0);
        for (const Disc& disc : in_box) {
          const double along = glm::dot(disc.normal, line);
          const double t = glm::dot(disc.normal, disc.centre - from) / along;
          hits += t > 0.0 && t * line.z < side && glm::distance(from + t * line, disc.centre) < disc.radius;
        }
      }
      rates.push_back(hits / (40.0 * side / line.z));
    }
    const double mean = std::accumulate(rates.begin(), rates.end(), 0.0) / kSeeds;
    double square = 0.0;
    for (const double rate : rates) square += (rate - mean) * (rate - mean);
    const double error = std::sqrt(square / (kSeeds - 1) / kSeeds);
    EXPECT_NEAR(mean, p32 * cosine, kErrors * error) << (is_random ? "random" : "sheets");
    EXPECT_LT(error, 0.05 * mean);
  }
}

TEST(DrawDiscs, ScatterAsTheirKappaSays) {
  // κ̂ = (N − 1) / (N − R), with a standard error of κ / √N.
  for (const double kappa : {5.0, 20.0, 60.0, 300.0}) {
    const JointPattern pattern{.sets = {{.normal = glm::normalize(Vec3(2, -1, 2)), .kappa = kappa}}, .discs = 400,
                               .centre_spacing = 0.0};
    double n = 0.0;
    Vec3 sum{0.0};
    for (Seed seed = 1; seed <= kSeeds; ++seed)
      for (const Disc& disc : draw_discs(pattern, 20.0, seed)) {
        sum += disc.normal;
        ++n;
      }
    EXPECT_NEAR((n - 1.0) / (n - glm::length(sum)), kappa, kErrors * kappa / std::sqrt(n));
  }
}

TEST(DrawDiscs, HaveTheQuantilesOfTheirRadiusLaw) {
  struct Case {
    JointSet set;
    double tenth, half, most;
  };
  const auto power = [](double u) { return 0.5 * std::pow(1.0 - u * (1.0 - std::pow(0.5 / 8.0, 1.6)), -1.0 / 1.6); };
  const double sigma = std::sqrt(std::log(1.0 + 0.6 * 0.6));
  const auto lognormal = [&](double z) { return 2.0 * std::exp(-0.5 * sigma * sigma + z * sigma); };
  const double z = 1.2815515655446004;
  const Case all[] = {
      {{.radius_lo = 1.0, .radius_hi = 3.0}, 1.2, 2.0, 2.8},
      {{.radius_law = RadiusLaw::PowerLaw, .radius_lo = 0.5, .radius_hi = 8.0, .radius_exponent = 1.6},
       power(0.1), power(0.5), power(0.9)},
      {{.radius_law = RadiusLaw::Lognormal, .radius_lo = 1e-3, .radius_hi = 50.0, .radius_mean = 2.0, .radius_cv = 0.6},
       lognormal(-z), lognormal(0.0), lognormal(z)}};
  for (const Case& c : all) {
    const auto discs = draw_discs({.sets = {c.set}, .discs = 3000, .centre_spacing = 0.0}, 20.0, 1);
    const auto n = static_cast<double>(discs.size());
    const auto share_below = [&](double radius) {
      return static_cast<double>(std::count_if(discs.begin(), discs.end(),
                                               [&](const Disc& disc) { return disc.radius < radius; })) / n;
    };
    EXPECT_NEAR(share_below(c.tenth), 0.1, kErrors * std::sqrt(0.09 / n));
    EXPECT_NEAR(share_below(c.half), 0.5, kErrors * std::sqrt(0.25 / n));
    EXPECT_NEAR(share_below(c.most), 0.9, kErrors * std::sqrt(0.09 / n));
  }
}

}  // namespace
}  // namespace outcrop
