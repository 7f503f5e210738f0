#include "spool.h"

#include <algorithm>

#include "outcrop/core/error.h"

namespace outcrop::meshing {
namespace {

constexpr std::size_t kMemoryBytes = std::size_t{1} << 20;

}  // namespace

void Spool::write(std::span<const std::byte> bytes) {
  size_ += bytes.size();
  if (!file_) {
    memory_.insert(memory_.end(), bytes.begin(), bytes.end());
    if (memory_.size() <= kMemoryBytes) return;
    file_.emplace(beside_.parent_path() / (beside_.stem().string() + ".spool"));
    file_->write(memory_);
    memory_ = {};
  } else {
    file_->write(bytes);
  }
}

void Spool::read(std::uint64_t offset, std::span<std::byte> bytes) {
  if (!file_) {
    std::copy_n(memory_.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
    return;
  }
  if (flushed_ != size_) {
    file_->overwrite(0, {});  // Flushes.
    flushed_ = size_;
  }
  if (!reader_.is_open()) reader_.open(file_->temporary_path(), std::ios::binary);
  reader_.seekg(static_cast<std::streamoff>(offset));
  reader_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!reader_) throw SystemError(file_->temporary_path().string() + ": cannot be read back");
}

}  // namespace outcrop::meshing
