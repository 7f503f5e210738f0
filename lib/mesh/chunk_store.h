/// Where chunks wait until all are made: in memory, or in a file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "chunk.h"

namespace outcrop::meshing {

class ChunkStore {
 public:
  virtual ~ChunkStore() = default;
  virtual void add(Chunk chunk) = 0;
  /// The chunk as it was added; `last` when nobody will ask for it again.
  [[nodiscard]] virtual Chunk get(std::size_t index, bool last) = 0;
};

[[nodiscard]] std::unique_ptr<ChunkStore> memory_store();
/// @param beside  The file lies in the same folder, and is gone when the store is. @throws as OutputFile.
[[nodiscard]] std::unique_ptr<ChunkStore> disk_store(const std::filesystem::path& beside);

}  // namespace outcrop::meshing
