#include "mesh_text.h"

namespace outcrop::meshing {

/// Positions and faces; all else (normals, textures, materials, curves) is passed over.
FileMesh read_obj(const std::filesystem::path& path, std::string_view text) {
  FileMesh mesh;
  TextLines lines(path, text);
  std::vector<std::uint32_t> corners;
  while (lines.next()) {
    const auto& words = lines.words();
    if (words.empty()) continue;
    if (words[0] == "v") {
      mesh.positions.push_back(lines.vec3(1, "three coordinates after \"v\""));
    } else if (words[0] == "f") {
      corners.clear();
      const auto count = static_cast<long long>(mesh.positions.size());
      for (std::size_t i = 1; i < words.size() && words[i][0] != '#'; ++i) {
        const long long index = lines.integer(words[i].substr(0, words[i].find('/')), "a vertex number");
        // Numbers count from 1, negative ones back from the latest vertex.
        const long long vertex = index > 0 ? index - 1 : count + index;
        if (index == 0 || vertex < 0 || vertex >= count)
          lines.fail("a vertex number from 1 to " + std::to_string(count), std::to_string(index));
        corners.push_back(static_cast<std::uint32_t>(vertex));
      }
      if (corners.size() < 3) lines.fail("a face of three or more vertices", std::to_string(corners.size()));
      mesh.add_polygon(corners);
    }
  }
  return mesh;
}

}  // namespace outcrop::meshing
