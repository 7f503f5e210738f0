#include "cli.h"

#include <semaphore.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "outcrop/core/error.h"
#include "progress_line.h"

namespace outcrop::cli {

namespace {

constexpr int kDone = 0;
constexpr int kOurFault = 1;
constexpr int kCallersFault = 2;
constexpr int kInterrupted = 130;

constexpr int kSignals[] = {SIGINT, SIGTERM};
constexpr std::string_view kInterruptedText = "interrupted; no file was left in part";

// nohup and shells' & ask to be spared.
void handle_unless_ignored(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  for (const int signal : kSignals) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

void write_error(std::string_view text) { (void)!::write(STDERR_FILENO, text.data(), text.size()); }

// The program's name, known before libc has looked at it.
const char* g_name = "";

// Until `run` listens there is no file and nothing to wait for.
extern "C" void leave_at_once(int) {
  write_error(g_name);
  write_error(": ");
  write_error(kInterruptedText);
  write_error("\n");
  _exit(kInterrupted);
}

// The loader calls what stands in this section before the constructors of any library. While it maps and relocates
// them, a tenth of a second, the kernel's own way applies: the signal ends the program without a word.
extern "C" void listen_early(int count, char** words, char**) {
  if (count > 0) {
    const char* const slash = std::strrchr(words[0], '/');
    g_name = slash ? slash + 1 : words[0];
  }
  handle_unless_ignored(leave_at_once);
}
[[gnu::section(".preinit_array"), gnu::used]] void (*const g_listen_early)(int, char**, char**) = listen_early;

// Set by the handler, which may run on any thread: libraries start threads before main that block no signal.
sem_t g_arrived;
volatile std::sig_atomic_t g_signals = 0;

extern "C" void note_signal(int signal) {
  g_signals = g_signals + 1;
  if (g_signals > 1) {  // the second time: at once
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  sem_post(&g_arrived);
}

// Turns SIGINT and SIGTERM into a stop request, on a thread of its own since a handler may not touch a stop source.
class Interrupts {
 public:
  Interrupts() {
    sem_init(&g_arrived, 0, 0);
    watcher_ = std::thread([this] { watch(); });
    handle_unless_ignored(note_signal);
  }
  ~Interrupts() {
    finished_ = true;
    sem_post(&g_arrived);
    watcher_.join();
  }
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  void watch() {
    while (sem_wait(&g_arrived) != 0) continue;
    if (!finished_) source_.request_stop();
  }

  std::stop_source source_;
  std::atomic<bool> finished_ = false;
  std::thread watcher_;
};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(std::string("--").append(name));
    for (const std::string& name : option->get_snames()) names.push_back(std::string("-").append(name));
  }
  return names;
}

// What is wrong with the first argument that nothing took, or "".
std::string about_extras(const CLI::App& app) {
  const std::vector<std::string> extras = app.remaining();
  const auto option =
      std::find_if(extras.begin(), extras.end(), [](const auto& word) { return word.starts_with("-"); });
  if (option == extras.end()) return extras.empty() ? "" : "unexpected argument \"" + extras.front() + "\"";
  const std::string word = option->substr(0, option->find('='));
  const std::vector<std::string> names = option_names(app);
  const std::vector<std::string_view> known(names.begin(), names.end());
  const std::string_view nearest = word.size() > 2 ? nearest_name(word, known.data(), known.size()) : "";
  return "unknown option " + word + (nearest.empty() ? "" : "; did you mean " + std::string(nearest) + "?");
}

std::string expected_by(const CLI::Option* option) {
  const std::string type = option ? option->get_type_name() : "";
  const bool several = option && option->get_items_expected_max() > 1;
  if (type.find("FLOAT") != type.npos) return several ? "numbers" : "a number";
  if (type.starts_with("UINT")) return "an integer that is not negative";
  if (type.starts_with("INT")) return several ? "integers" : "an integer";
  return "another value";
}

std::string about(const CLI::App& app, const CLI::ParseError& error) {
  const bool counted = error.get_name() == "ArgumentMismatch", converted = error.get_name() == "ConversionError";
  // An option that took too few or too many values leaves others over: then it is the one to name.
  if (const std::string extras = about_extras(app); !counted && !converted && !extras.empty()) return extras;
  std::string text = error.what();
  constexpr std::string_view kUnconverted = "Could not convert: ";
  if (text.starts_with(kUnconverted)) {
    const std::size_t equals = text.find(" = ");
    const std::string name = text.substr(kUnconverted.size(), equals - kUnconverted.size());
    const std::string value = equals == text.npos ? "" : text.substr(equals + 3);
    return name + ": expected " + expected_by(app.get_option_no_throw(name)) + ", got \"" + value + "\"";
  }
  // "--region: 4 required FLOAT missing", "--cell-size: At Most 1 required but received 2"
  const std::string name = text.substr(0, text.find(": "));
  const CLI::Option* const option = app.get_option_no_throw(name);
  if (option && counted) {
    const int count = option->get_items_expected_min();
    const bool missing = text.ends_with(" missing");
    return name + ": expected " + (count == 1 ? "one value" : std::to_string(count) + " values") + ", got " +
           (!missing     ? std::to_string(option->results().size())
            : count == 1 ? "none"
                         : "fewer");
  }
  return text;
}

// NaN and infinity are no numbers to compute with, and CLI11 wraps negative integers and cuts long ones.
std::string about_number(const std::string& type, const std::string& text) {
  char* end = nullptr;
  errno = 0;
  if (type.find("FLOAT") != type.npos) {
    const double value = std::strtod(text.c_str(), &end);
    // What is no number at all fails later, with its own message.
    return *end || std::isfinite(value) ? "" : "expected a finite number, got " + text;
  }
  const bool negative = text.starts_with("-");
  if (type.starts_with("UINT")) {
    (void)std::strtoull(text.c_str(), &end, 10);
    if (!*end && (negative || errno == ERANGE)) return "expected an integer in [0, 2^64), got " + text;
  }
  return "";
}

void check_numbers(CLI::App& app) {
  for (CLI::Option* const option : app.get_options(nullptr)) {
    const std::string type = option->get_type_name();
    option->check(CLI::Validator([type](std::string& text) { return about_number(type, text); }, ""));
  }
}

// The exit code for the exception in flight, and its message.
std::pair<int, std::string> explained() {
  try {
    throw;
  } catch (const InputError& e) {
    return {kCallersFault, e.what()};
  } catch (const ParameterError& e) {
    return {kCallersFault, e.what()};
  } catch (const Cancelled&) {
    return {kInterrupted, std::string(kInterruptedText)};
  } catch (const std::bad_alloc&) {
    return {kOurFault, "out of memory"};
  } catch (const SystemError& e) {
    return {kOurFault, e.what()};
  } catch (const std::exception& e) {
    return {kOurFault, std::string("internal error: ") + e.what()};
  } catch (...) {
    return {kOurFault, "internal error of unknown kind"};
  }
}

}  // namespace

void add_output_options(CLI::App& app, std::vector<std::filesystem::path>& meshes,
                        std::vector<std::filesystem::path>& previews, int& width, int& height) {
  app.add_option("-o,--output", meshes, "Mesh to write: .ply, .obj, .stl or .vdb; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--preview", previews, "Picture to write: .png or .exr; may be repeated")->allow_extra_args(false);
  const auto set_size = [&](const std::vector<int>& size) {
    width = size[0];
    height = size[1];
  };
  app.add_option_function<std::vector<int>>("--size", set_size, "Width and height of previews, pixels")
      ->expected(2)
      ->default_str(std::to_string(width) + " " + std::to_string(height));
}

void add_run_options(CLI::App& app, int& threads, double& memory_limit_gib, bool& dry_run, Options& options,
                     const std::string& expected) {
  app.add_option("--threads", threads, "0: all cores")->capture_default_str();
  app.add_option("--memory-limit", memory_limit_gib, "GiB; 0: half of the machine's memory")->capture_default_str();
  app.add_flag("--dry-run", dry_run, "Only say what to expect: " + expected);
  app.add_flag("-q,--quiet", options.quiet, "No messages but errors");
  app.add_flag("-v,--verbose", options.verbose, "Progress even when stderr is no terminal");
}

void notify(const CLI::App& app, const Options& options, const std::string& line) {
  if (!options.quiet) std::cerr << app.get_name() << ": " << line << '\n';
}

int run(CLI::App& app, int argc, char** argv, const Options& options, const std::function<void(const Task&)>& body) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is an error of write, like a full disk
  const auto fail = [&](int code, const std::string& message) {
    std::cerr << app.get_name() << ": " << one_line(message) << std::endl;
    return code;
  };
  app.set_version_flag("--version", app.get_name() + " " OUTCROP_VERSION, "Print the version and exit");
  try {
    check_numbers(app);
    app.parse(argc, argv);
  } catch (const CLI::CallForVersion& version) {
    std::cout << version.what() << std::endl;
    return kDone;
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help() << std::flush;
    return kDone;
  } catch (const CLI::ParseError& error) {
    return fail(kCallersFault, about(app, error) + "; see " + app.get_name() + " --help");
  }

  std::pair<int, std::string> outcome{kDone, ""};
  {
    const Interrupts interrupts;
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const auto progress = (terminal || options.verbose) && !options.quiet
                              ? std::make_unique<ProgressLine>(app.get_name(), terminal)
                              : nullptr;
    try {
      body({.stop = interrupts.token(), .progress = progress.get()});
      if (!std::cout.flush()) throw SystemError("standard output: cannot be written");
    } catch (...) {
      outcome = explained();
    }
  }
  return outcome.first == kDone ? kDone : fail(outcome.first, outcome.second);
}

}  // namespace outcrop::cli
