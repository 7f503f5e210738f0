#include "outcrop/core/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <random>
#include <system_error>
#include <utility>
#include <vector>

#include "outcrop/core/error.h"

namespace outcrop {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr int kNameAttempts = 16;

std::string reason(int code) { return std::generic_category().message(code); }

fs::path folder_of(const fs::path& target) {
  const fs::path parent = target.parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

// A link stays a link: what it points to is replaced.
fs::path resolved(const fs::path& target) {
  std::error_code ignored;
  if (!fs::is_symlink(target, ignored)) return target;
  const fs::path real = fs::weakly_canonical(target, ignored);
  return real.empty() ? target : real;
}

fs::path temporary_name(const fs::path& target) {
  std::random_device device;
  constexpr char kDigits[] = "0123456789abcdefghijklmnopqrstuv";
  std::string suffix;
  for (int i = 0; i < 8; ++i) suffix += kDigits[device() % 32];
  const std::string stem = target.stem().string().substr(0, 100);  // names are limited to 255 bytes
  return folder_of(target) /
         ("." + stem + "." + std::to_string(getpid()) + "-" + suffix + ".part" + target.extension().string());
}

}  // namespace

struct OutputFile::State {
  fs::path target;
  fs::path temporary;
  int descriptor = -1;
  bool committed = false;
  std::uint64_t flushed = 0;
  std::vector<std::byte> buffer;

  [[noreturn]] void fail(int code) const {
    throw SystemError(target.string() + ": cannot be written: " + reason(code) +
                      (committed ? "" : "; what was there before is unchanged"));
  }

  void flush() {
    std::size_t done = 0;
    while (done < buffer.size()) {
      const ssize_t n = ::write(descriptor, buffer.data() + done, buffer.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) fail(n < 0 ? errno : ENOSPC);
      done += static_cast<std::size_t>(n);
    }
    flushed += buffer.size();
    buffer.clear();
  }
};

void check_output_path(const fs::path& target) {
  const auto expect = [&](bool holds, std::string_view bound, const std::string& got) {
    require(holds, target.string(), bound, got);
  };
  expect(target.has_filename(), "the name of a file to write", target.empty() ? "nothing" : "the name of a folder");
  const fs::path real = resolved(target);
  const fs::path folder = folder_of(real);
  std::error_code error;
  const fs::file_status found = fs::status(folder, error);
  expect(fs::exists(found), "a file in a folder that exists", "no folder " + folder.string());
  expect(fs::is_directory(found), "a file in a folder", "the file " + folder.string() + " in its place");
  const fs::file_status old = fs::status(real, error);
  expect(!fs::is_directory(old), "a file to write", "a folder of that name");
  expect(!fs::exists(old) || fs::is_regular_file(old), "a file to write", "a device, pipe or socket of that name");
  const int refused = ::access(folder.c_str(), W_OK | X_OK) == 0 ? 0 : errno;
  expect(refused == 0, "a file in a folder that can be written to",
         "the folder " + folder.string() + " (" + reason(refused) + ")");
}

OutputFile::OutputFile(fs::path target) : state_(std::make_unique<State>()) {
  check_output_path(target);
  state_->target = resolved(target);
  for (int attempt = 0; state_->descriptor < 0; ++attempt) {
    state_->temporary = temporary_name(state_->target);
    state_->descriptor = ::open(state_->temporary.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (state_->descriptor >= 0) break;
    const int code = errno;
    if (code == EEXIST && attempt < kNameAttempts) continue;
    if (code == ENOSPC || code == EDQUOT || code == EIO || code == EMFILE || code == ENFILE) state_->fail(code);
    require(false, target.string(), "a file in a folder that can be written to",
            "the folder " + folder_of(state_->target).string() + " (" + reason(code) + ")");
  }
  state_->buffer.reserve(kBufferBytes);
}

OutputFile::~OutputFile() {
  if (state_->descriptor >= 0) ::close(state_->descriptor);
  if (!state_->committed) ::unlink(state_->temporary.c_str());
}

void OutputFile::write(std::span<const std::byte> bytes) {
  State& s = *state_;
  while (!bytes.empty()) {
    const std::size_t n = std::min(bytes.size(), kBufferBytes - s.buffer.size());
    s.buffer.insert(s.buffer.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    bytes = bytes.subspan(n);
    if (s.buffer.size() == kBufferBytes) s.flush();
  }
}

void OutputFile::write(std::string_view text) { write(std::as_bytes(std::span(text))); }

void OutputFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  State& s = *state_;
  s.flush();
  assert(offset + bytes.size() <= s.flushed);
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(s.descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) s.fail(n < 0 ? errno : ENOSPC);
    offset += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

const fs::path& OutputFile::temporary_path() const noexcept { return state_->temporary; }

void OutputFile::commit() {
  State& s = *state_;
  s.flush();
  const int descriptor = std::exchange(s.descriptor, -1);
  if (::close(descriptor) != 0 && errno != EINTR) s.fail(errno);  // some file systems report a full disk only here
  if (::rename(s.temporary.c_str(), s.target.c_str()) != 0) s.fail(errno);
  s.committed = true;
}

std::string read_text(const fs::path& path) {
  const auto fail = [&](const std::string& got) {
    throw InputError(path.string() + ": expected a readable file, got " + got);
  };
  std::error_code error;
  const fs::file_status found = fs::status(path, error);
  if (found.type() == fs::file_type::not_found) fail("none");
  if (fs::is_directory(found)) fail("a folder");
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(reason(errno));
  std::string text;
  std::vector<char> chunk(std::size_t{1} << 16);
  int code = 0;
  for (;;) {
    const ssize_t n = ::read(descriptor, chunk.data(), chunk.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) code = errno;
    if (n <= 0) break;
    text.append(chunk.data(), static_cast<std::size_t>(n));
  }
  ::close(descriptor);
  if (code != 0) fail(reason(code));
  return text;
}

}  // namespace outcrop
