#include "outcrop/mesh/triangle_mesh.h"

namespace outcrop {

Box TriangleMesh::bounds() const {
  Box box;
  for (const Vec3f& p : positions) box.include(origin + Vec3(p));
  return box;
}

TriangleMesh rebased(TriangleMesh mesh, const Vec3& origin) {
  const Vec3 shift = mesh.origin - origin;
  for (Vec3f& p : mesh.positions) p = Vec3f(Vec3(p) + shift);
  mesh.origin = origin;
  return mesh;
}

}  // namespace outcrop
