#include "chunk_store.h"

#include <utility>
#include <vector>

#include "spool.h"

namespace outcrop::meshing {
namespace {

class MemoryStore final : public ChunkStore {
 public:
  void add(Chunk chunk) override { chunks_.push_back(std::move(chunk)); }
  Chunk get(std::size_t index, bool last) override {
    if (!last) return chunks_[index];
    return std::exchange(chunks_[index], {});
  }

 private:
  std::vector<Chunk> chunks_;
};

class DiskStore final : public ChunkStore {
 public:
  explicit DiskStore(const std::filesystem::path& beside) : spool_(beside) {}

  void add(Chunk chunk) override {
    places_.push_back({spool_.size(), chunk.positions.size(), chunk.normals.size(), chunk.labels.size(),
                       chunk.triangles.size(), chunk.border.size()});
    for_each_array(chunk, [&](const auto& array) { spool_.write(std::as_bytes(std::span(array))); });
  }
  Chunk get(std::size_t index, bool) override {
    const Place& place = places_[index];
    Chunk chunk;
    chunk.positions.resize(place.positions);
    chunk.normals.resize(place.normals);
    chunk.labels.resize(place.labels);
    chunk.triangles.resize(place.triangles);
    chunk.border.resize(place.border);
    std::uint64_t offset = place.offset;
    for_each_array(chunk, [&](auto& array) {
      const auto bytes = std::as_writable_bytes(std::span(array));
      spool_.read(offset, bytes);
      offset += bytes.size();
    });
    return chunk;
  }

 private:
  struct Place {
    std::uint64_t offset;
    std::size_t positions, normals, labels, triangles, border;
  };
  template <class AChunk, class Visit>
  static void for_each_array(AChunk& chunk, Visit&& visit) {
    visit(chunk.positions);
    visit(chunk.normals);
    visit(chunk.labels);
    visit(chunk.triangles);
    visit(chunk.border);
  }

  Spool spool_;
  std::vector<Place> places_;
};

}  // namespace

std::unique_ptr<ChunkStore> memory_store() { return std::make_unique<MemoryStore>(); }
std::unique_ptr<ChunkStore> disk_store(const std::filesystem::path& beside) {
  return std::make_unique<DiskStore>(beside);
}

}  // namespace outcrop::meshing
