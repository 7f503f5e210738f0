/// Prints how many pairs of triangles of each mesh file intersect, by CGAL's exact predicates: one number a line.
/// Exit 0: none does; 1: some do; 2: a file cannot be judged.
#include <exception>
#include <iostream>
#include <span>

#include "outcrop/mesh/write_mesh.h"
#include "self_intersections.h"

int main(int argc, char** argv) try {
  bool any = false;
  for (const char* const path : std::span(argv, argc).subspan(1)) {
    const std::size_t pairs = outcrop::test::self_intersections(outcrop::read_mesh(path));
    std::cout << pairs << std::endl;
    any = any || pairs > 0;
  }
  return any ? 1 : 0;
} catch (const std::exception& error) {
  std::cerr << "count_intersections: " << error.what() << '\n';
  return 2;
}
