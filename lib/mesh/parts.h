/// Connected parts of a closed mesh, and which of them are wanted.
#pragma once

#include <cstddef>
#include <vector>

#include "lattice.h"
#include "outcrop/mesh/polygonize.h"

namespace outcrop::meshing {

/// One flag a triangle: keep it?
struct PartSelection {
  std::vector<char> keep;
  std::size_t parts_removed = 0;
  std::size_t voids_removed = 0;
};

/// Chooses among the parts of a closed mesh. A part of negative volume is a void: it stays only with `keep_voids` and
/// the rock around it. Rock inside a void that goes, goes too: it would end up inside rock.
///
/// Cost: O(triangles), plus the void's triangles for each part whose box lies in the void's.
[[nodiscard]] PartSelection select_parts(const TriangleMesh& mesh, const Lattice& lattice, Parts parts,
                                         bool keep_voids);

/// The mesh without the triangles whose flag is 0, and without vertices that nobody uses then; order is kept.
[[nodiscard]] TriangleMesh filtered(TriangleMesh mesh, const std::vector<char>& keep);

}  // namespace outcrop::meshing
