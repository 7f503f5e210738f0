/// Writes closed meshes of awkward shapes into a folder, for a judge that is not ours: tests/mesh/judge.py.
#include <filesystem>
#include <string>

#include "fields.h"
#include "outcrop/mesh/polygonize.h"
#include "outcrop/mesh/write_mesh.h"

namespace {

using outcrop::FieldPtr;
using outcrop::Vec3;

/// White noise at whole coordinates: every case of the table beside every other.
FieldPtr noise(outcrop::Seed seed) {
  return outcrop::test::formula(
      [=](const Vec3& p) {
        const outcrop::IVec3 node(glm::floor(p + 0.5));
        const auto key = static_cast<std::uint64_t>((node.x + 64) + 128 * ((node.y + 64) + 128 * (node.z + 64)));
        return outcrop::Rng(seed, "node", key).uniform(-1.0, 1.0);
      },
      1e6);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  const auto write = [&](const std::string& name, const FieldPtr& field, double half, double resolution) {
    const outcrop::PolygonizeOptions options{.region = {Vec3(-half), Vec3(half)},
                                             .resolution = resolution,
                                             .border = outcrop::Border::Closed,
                                             .keep_voids = true};
    outcrop::write_mesh(folder / name, outcrop::polygonize(*field, options).mesh);
  };
  for (const outcrop::Seed seed : {0, 1}) {
    write("waves" + std::to_string(seed) + ".ply", outcrop::test::waves(seed, 0.6, 0.1 * static_cast<double>(seed)),
          1.0, 0.06);
    write("noise" + std::to_string(seed) + ".obj", noise(seed), 8.0, 1.0);
  }
  const FieldPtr hills = outcrop::test::formula(
      [](const Vec3& p) { return p.z - 0.4 * std::sin(3 * p.x + 2 * p.y) * std::cos(4 * p.y); }, 2.5);
  for (const std::string extension : {"ply", "obj", "stl"}) write("hills." + extension, hills, 1.0, 0.05);
  write("diagonal.ply", outcrop::test::half_space_below({1, 1, 1}, 0.0), 1.0, 0.05);
  return 0;
}
