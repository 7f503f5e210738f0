/// Files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace outcrop {

/// A file under construction: written beside its target and renamed when whole, so that a failed run keeps the old one.
///
/// The destructor removes what was not committed.
class OutputFile {
 public:
  /// @throws ParameterError when the folder does not exist, is no folder, or cannot be written to.
  explicit OutputFile(std::filesystem::path target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends bytes through a buffer. @throws SystemError when the disk refuses (full, quota, I/O error).
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  /// Overwrites bytes already written, for counts in headers that are known last.
  void overwrite(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Where a library that insists on a path may write instead; same folder, same extension as the target.
  [[nodiscard]] const std::filesystem::path& temporary_path() const noexcept;
  /// Flushes, checks and renames onto the target. @throws SystemError; the old file is then still there.
  void commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Throws what the OutputFile constructor would, without making a file: for checking outputs before long work.
void check_output_path(const std::filesystem::path& target);

/// The whole file as text. @throws InputError naming `path` when it is missing, a directory or unreadable.
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

}  // namespace outcrop
