#include "outcrop/core/data_path.h"

#include <cstdlib>
#include <string>
#include <system_error>

#include "outcrop/core/error.h"

namespace outcrop {

namespace fs = std::filesystem;

fs::path data_path() {
  std::error_code ignored;
  if (const char* const named = std::getenv("OUTCROP_DATA"); named && *named) {
    if (!fs::is_directory(named, ignored)) {
      throw InputError(std::string(named) + ": expected a folder, as OUTCROP_DATA says, got none");
    }
    return named;
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path candidates[] = {program.parent_path().parent_path() / "share" / "outcrop", OUTCROP_SOURCE_DATA,
                                 OUTCROP_INSTALLED_DATA};
  for (const fs::path& candidate : candidates) {
    if (fs::is_directory(candidate, ignored)) return candidate;
  }
  throw InputError(
      candidates[0].string() +
      ": expected the project's data folder, got none; set OUTCROP_DATA to the folder that holds reliefs/");
}

}  // namespace outcrop
