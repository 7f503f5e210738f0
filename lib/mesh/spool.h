/// A file that lives as long as its writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>

#include "outcrop/core/file.h"

namespace outcrop::meshing {

/// Bytes that wait on disk: written in one go, then read.
class Spool {
 public:
  /// @param beside  In whose folder the file lies. @throws as OutputFile.
  explicit Spool(const std::filesystem::path& beside);

  /// @throws SystemError when the disk refuses.
  void write(std::span<const std::byte> bytes) {
    file_.write(bytes);
    size_ += bytes.size();
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// @throws SystemError when what was written cannot be read back.
  void read(std::uint64_t offset, std::span<std::byte> bytes);

 private:
  OutputFile file_;
  std::uint64_t size_ = 0, flushed_ = 0;
  std::ifstream reader_;
};

}  // namespace outcrop::meshing
