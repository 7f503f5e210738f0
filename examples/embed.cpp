// A field of one's own between the library's: amplifies a made-up valley, cuts a cave into it, asks for values in a batch
// and meshes the result. Prints what it found.
#include <cmath>
#include <iostream>
#include <memory>
#include <vector>

#include "outcrop/amplify/amplify.h"
#include "outcrop/implicit/combine.h"
#include "outcrop/mesh/check_mesh.h"
#include "outcrop/mesh/polygonize.h"

namespace {

/// A tunnel along x with a wavy axis: negative inside. A node needs a value and a Lipschitz bound; the rest has defaults.
class Tunnel final : public outcrop::PointField {
 public:
  [[nodiscard]] double lipschitz() const noexcept override { return 1.2; }  // √(1 + 0.6²): 0.6 is the axis' largest slope.

 protected:
  [[nodiscard]] double at(const outcrop::Vec3& p) const noexcept override {
    return std::hypot(p.y - 20.0 - 4.0 * std::sin(0.15 * p.x), p.z - 6.0) - 3.0;
  }
};

/// A valley side: a floor, a wall of some 65 degrees, a plateau.
outcrop::Heightfield valley() {
  outcrop::ElevationGrid grid{.width = 41, .height = 41};
  for (int row = 0; row < 41; ++row)
    for (int column = 0; column < 41; ++column)
      grid.elevations.push_back(static_cast<float>(8.0 + 8.0 * std::tanh((column - 20.0) / 3.5)));
  return outcrop::Heightfield(grid);
}

}  // namespace

int main() {
  const outcrop::Heightfield heightfield = valley();
  outcrop::StrataFile strata;
  strata.materials[0].tile_side = 8.0;
  const outcrop::Amplified rock = outcrop::amplify(
      heightfield, strata, {.region_lo = {2, 2}, .region_hi = {38, 38}, .resolution = 0.25, .seed = 7});
  const outcrop::FieldPtr scene = outcrop::difference_of(rock.field, std::make_shared<Tunnel>());

  // Values come in batches: one virtual call for all points.
  const std::vector<double> x{10, 20, 30}, y{20, 20, 20}, z{6, 6, 6};
  std::vector<double> values(x.size());
  scene->values({x, y, z}, values, {});
  for (std::size_t i = 0; i < x.size(); ++i)
    std::cout << "f(" << x[i] << ", " << y[i] << ", " << z[i] << ") = " << values[i] << " m\n";

  const outcrop::PolygonizeResult result =
      outcrop::polygonize(*scene, {.region = rock.region, .resolution = 0.25, .border = outcrop::Border::Closed});
  const outcrop::MeshCheck check = outcrop::check_mesh(result.mesh);
  std::cout << check.triangles << " triangles, " << (check.closed() ? "closed" : "open") << '\n';
  return check.closed() && check.triangles > 0 ? 0 : 1;
}
