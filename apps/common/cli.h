/// What every program does alike: parse, run, be interrupted, report progress, turn exceptions into one line and a
/// code.
#pragma once

#include <functional>

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

/// Parses the command line, runs `body`, and returns the program's exit code.
///
/// 0: done, or help or version was asked for. 1: the machine's fault or ours. 2: the command line, an option or an
/// input cannot be used. 130: interrupted by SIGINT or SIGTERM; the task's stop token asks `body` to end, a second
/// signal kills, and one that comes before `run` ends the program at once. Whatever is not 0 comes with exactly one
/// line `program: message` on stderr. Adds `--version`. Options of floating-point type refuse NaN and infinity. Call it
/// from main, once.
int run(CLI::App& app, int argc, char** argv, const Options& options, const std::function<void(const Task&)>& body);

}  // namespace outcrop::cli
