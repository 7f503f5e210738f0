#include "mesh_region.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "assembly.h"
#include "brick_tree.h"
#include "chunk.h"
#include "outcrop/core/parallel.h"

namespace outcrop::meshing {
namespace {

/// Octree cells of 2³ levels of bricks, 64³ lattice cells, hold about ten thousand triangles.
constexpr int kChunkLevel = 3;
/// Small regions are cut finer, so that there is work for many threads.
constexpr int kLevelsAboveChunks = 3;

/// The trees of chunks, made when they are needed and dropped when nobody will ask again.
///
/// What balance makes of a chunk's bricks, and of those that touch them, depends on its 26 neighbours and nothing else:
/// a chunk is twice as long as the coarsest brick.
class Forest {
 public:
  Forest(const Lattice& lattice, std::vector<Cell>& cells, int level, double tolerance, const ForcedSplits& forced)
      : lattice_(lattice), cells_(cells), level_(level), tolerance_(tolerance), forced_(forced), trees_(cells.size()) {
    for (std::uint32_t i = 0; i < cells.size(); ++i) number_[key(cells[i].index)] = i;
    for (std::uint32_t i = 0; i < cells.size(); ++i) waiting_.push_back(around(i).size());
  }

  /// Makes what chunks first to last − 1 need. @return field values computed.
  std::size_t prepare(std::size_t first, std::size_t last, const Task& task) {
    std::vector<std::uint32_t> missing;
    for (std::size_t i = first; i < last; ++i)
      for (const std::uint32_t n : around(i))
        if (!made_[n]) {
          made_[n] = 1;
          missing.push_back(n);
        }
    const auto evaluations = parallel_map(
        missing.size(),
        [&](std::size_t i) {
          Refinement refinement = refine(lattice_, cells_[missing[i]], level_, tolerance_, forced_);
          const std::size_t made = refinement.evaluations;
          // What is not meshed now waits as a list of bricks alone.
          if (missing[i] < first || missing[i] >= last) refinement.known = {};
          trees_[missing[i]] = std::move(refinement);
          return made;
        },
        task);
    std::size_t sum = 0;
    for (const std::size_t n : evaluations) sum += n;
    return sum;
  }
  [[nodiscard]] BrickTree balanced(std::size_t chunk) const {
    BrickTree tree;
    for (const std::uint32_t n : around(chunk)) tree.add(trees_[n].leaves);
    tree.balance(lattice_);
    return tree;
  }
  /// What refinement knows about cells of a chunk; handed over.
  [[nodiscard]] ChunkBuilder::KnownCells take_known(std::size_t chunk) {
    ChunkBuilder::KnownCells map;
    for (auto& [place, known] : trees_[chunk].known) map[BrickTree::key(place)] = std::move(known);
    trees_[chunk].known = {};
    return map;
  }
  void release(std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (const std::uint32_t n : around(i))
        if (--waiting_[n] == 0) trees_[n] = {};
  }

 private:
  static std::uint64_t key(const IVec3& index) {
    const auto part = [](int i) { return static_cast<std::uint64_t>(i + 1); };
    return part(index.z) << 40 | part(index.y) << 20 | part(index.x);
  }
  /// The chunk and its neighbours.
  [[nodiscard]] std::vector<std::uint32_t> around(std::size_t chunk) const {
    std::vector<std::uint32_t> list;
    for (int i = 0; i < 27; ++i) {
      const auto* n = number_.find(key(cells_[chunk].index + IVec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (n) list.push_back(*n);
    }
    return list;
  }

  const Lattice& lattice_;
  const std::vector<Cell>& cells_;
  int level_;
  double tolerance_;
  const ForcedSplits& forced_;
  FlatMap<std::uint32_t> number_;
  std::vector<Refinement> trees_;
  std::vector<std::size_t> waiting_;
  std::vector<char> made_ = std::vector<char>(trees_.size(), 0);
};

/// Chunk builders that are not at work: as many as there are threads, not as there are chunks.
class Builders {
 public:
  Builders(const Lattice& lattice, const PolygonizeOptions& options, const Task& task)
      : lattice_(lattice), options_(options), task_(task) {}
  [[nodiscard]] std::unique_ptr<ChunkBuilder> take() {
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return std::make_unique<ChunkBuilder>(lattice_, options_, task_);
    std::unique_ptr<ChunkBuilder> builder = std::move(idle_.back());
    idle_.pop_back();
    return builder;
  }
  void give_back(std::unique_ptr<ChunkBuilder> builder) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(builder));
  }

 private:
  const Lattice& lattice_;
  const PolygonizeOptions& options_;
  const Task& task_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<ChunkBuilder>> idle_;
};

/// Room for `count` more, and a wish for large pages: with small ones the kernel takes as long to hand out a mesh's
/// memory as the mesher to fill it.
template <class T>
void reserve(std::vector<T>& array, std::size_t count) {
  array.reserve(count);
  constexpr std::size_t kPage = std::size_t{1} << 21;
  const auto begin = reinterpret_cast<std::uintptr_t>(array.data());
  const std::uintptr_t first = (begin + kPage - 1) / kPage * kPage, last = (begin + count * sizeof(T)) / kPage * kPage;
  if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);  // Declined, nothing is lost.
}

}  // namespace

int chunk_level(const Lattice& lattice, bool crisp) noexcept {
  const int root = root_level(lattice);
  // Creases are joined within chunks alone.
  if (lattice.coarsest == 0 && !crisp) return std::clamp(root - kLevelsAboveChunks, 0, kChunkLevel);
  return std::min(root, std::max(kChunkLevel, lattice.coarsest + 1));
}

std::vector<Cell> chunk_cells(const Field& field, const Lattice& lattice, int chunk, const Task& task) {
  std::vector<Cell> cells = root_cells(lattice, field);
  for (int level = root_level(lattice); level > chunk; --level) {
    const auto parts = parallel_map(
        cells.size(), [&](std::size_t i) { return split(lattice, cells[i], level); }, task);
    cells.clear();
    for (const auto& part : parts) cells.insert(cells.end(), part.begin(), part.end());
  }
  return cells;
}

Assembly mesh_region(const Field& field, const Lattice& lattice, const PolygonizeOptions& options,
                     const PieceOptions& pieces, const Task& task, const ForcedSplits& forced) {
  const int level = chunk_level(lattice, options.crisp);
  std::vector<Cell> cells = chunk_cells(field, lattice, level, task);
  const bool uniform = lattice.coarsest == 0;
  const AssemblyNeeds needs(options);
  Assembly assembly(lattice, options, pieces.spool.empty() ? memory_store() : disk_store(pieces.spool));
  Forest forest(lattice, cells, level, options.tolerance, forced);
  Builders builders(lattice, options, task);
  task.begin("meshing", cells.size());
  const std::size_t at_a_time = std::max<std::size_t>(1, pieces.squares >> 2 * std::max(0, level - kChunkLevel));
  for (std::size_t first = 0; first < cells.size(); first += at_a_time) {
    const std::size_t last = std::min(first + at_a_time, cells.size());
    if (!uniform) assembly.count_evaluations(forest.prepare(first, last, task));
    auto made = parallel_map(
        last - first,
        [&](std::size_t i) {
          std::unique_ptr<ChunkBuilder> builder = builders.take();
          BrickTree tree;
          ChunkBuilder::KnownCells known;
          if (!uniform) {
            tree = forest.balanced(first + i);
            known = forest.take_known(first + i);
            builder->use(tree, known);
          }
          Chunk chunk = builder->build(cells[first + i], level);
          builders.give_back(std::move(builder));
          if (uniform) cells[first + i].field.reset();
          ChunkSummary summary = summarise(chunk, lattice, needs);
          task.advance();
          return std::pair(std::move(chunk), std::move(summary));
        },
        task);
    for (auto& [chunk, summary] : made) assembly.add(std::move(chunk), std::move(summary));
    forest.release(first, last);
  }
  cells.clear();
  assembly.finish(field, task);
  return assembly;
}

void MeshCollector::begin(const MeshTotals& totals) {
  mesh_.origin = totals.origin;
  reserve(mesh_.positions, totals.vertices);
  if (totals.normals) reserve(mesh_.normals, totals.vertices);
  if (totals.labels) reserve(mesh_.labels, totals.vertices);
  reserve(mesh_.triangles, totals.triangles);
}

void MeshCollector::add(const MeshPiece& piece) {
  // New vertices come in long runs between those that earlier pieces brought.
  const auto append = [](auto& array, const auto& from, std::size_t first, std::size_t last) {
    if (!from.empty()) array.insert(array.end(), from.begin() + first, from.begin() + last);
  };
  const auto& numbers = piece.numbers;
  for (std::size_t first = 0, last = 0; first < numbers.size(); first = last) {
    const bool known = numbers[first] < piece.first_number;
    while (last < numbers.size() && (numbers[last] < piece.first_number) == known) ++last;
    if (known) continue;
    append(mesh_.positions, piece.positions, first, last);
    append(mesh_.normals, piece.normals, first, last);
    append(mesh_.labels, piece.labels, first, last);
  }
  for (const Triangle& t : piece.triangles)
    mesh_.triangles.push_back({numbers[t[0]], numbers[t[1]], numbers[t[2]]});
}

}  // namespace outcrop::meshing
