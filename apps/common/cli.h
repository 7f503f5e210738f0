/// What every program does alike: parse, run, be interrupted, report progress, turn exceptions into one line and a
/// code.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "outcrop/core/task.h"

namespace CLI {
class App;
}

namespace outcrop::cli {

/// Bound to the program's own flags, so read only once the command line is parsed.
struct Options {
  bool quiet = false;    ///< No progress, not even on a terminal.
  bool verbose = false;  ///< Progress even when stderr is no terminal.
};

/// `-o`, `--preview` and `--size`: what to write.
void add_output_options(CLI::App& app, std::vector<std::filesystem::path>& meshes,
                        std::vector<std::filesystem::path>& previews, int& width, int& height);

/// `--threads`, `--memory-limit`, `--dry-run`, `--quiet` and `--verbose`: how to run.
/// @param expected  What a dry run tells.
void add_run_options(CLI::App& app, int& threads, double& memory_limit_gib, bool& dry_run, Options& options,
                     const std::string& expected);

/// Writes a line `program: line` to stderr, nothing when quiet.
void notify(const CLI::App& app, const Options& options, const std::string& line);

/// Parses the command line, runs `body`, and returns the program's exit code.
///
/// 0: done, or help or version was asked for. 1: the machine's fault or ours. 2: the command line, an option or an
/// input cannot be used. 130: interrupted by SIGINT or SIGTERM; the task's stop token asks `body` to end, a second
/// signal kills, and one that comes before `run` ends the program at once. Whatever is not 0 comes with exactly one
/// line `program: message` on stderr. Adds `--version`. Options of floating-point type refuse NaN and infinity. Call it
/// from main, once.
int run(CLI::App& app, int argc, char** argv, const Options& options, const std::function<void(const Task&)>& body);

}  // namespace outcrop::cli
