#include "spool.h"

#include "outcrop/core/error.h"

namespace outcrop::meshing {

Spool::Spool(const std::filesystem::path& beside) : file_(beside.parent_path() / (beside.stem().string() + ".spool")) {}

void Spool::read(std::uint64_t offset, std::span<std::byte> bytes) {
  if (flushed_ != size_) {
    file_.overwrite(0, {});  // Flushes.
    flushed_ = size_;
  }
  if (!reader_.is_open()) reader_.open(file_.temporary_path(), std::ios::binary);
  reader_.seekg(static_cast<std::streamoff>(offset));
  reader_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!reader_) throw SystemError(file_.temporary_path().string() + ": cannot be read back");
}

}  // namespace outcrop::meshing
