/// Bytes that wait for their place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <vector>

#include "outcrop/core/file.h"

namespace outcrop::meshing {

/// Written in one go, then read; what is more than a megabyte lies in a file that is gone with the spool.
class Spool {
 public:
  /// @param beside  In whose folder the file lies.
  explicit Spool(std::filesystem::path beside) : beside_(std::move(beside)) {}

  /// @throws SystemError when the disk refuses.
  void write(std::span<const std::byte> bytes);
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// @throws SystemError when what was written cannot be read back.
  void read(std::uint64_t offset, std::span<std::byte> bytes);

 private:
  std::filesystem::path beside_;
  std::vector<std::byte> memory_;  ///< Everything, until there is a file.
  std::optional<OutputFile> file_;
  std::uint64_t size_ = 0, flushed_ = 0;
  std::ifstream reader_;
};

}  // namespace outcrop::meshing
