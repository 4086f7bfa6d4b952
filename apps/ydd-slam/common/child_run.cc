// SPDX-License-Identifier: Apache-2.0
#include "common/child_run.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "ydd/base/files.h"
#include "ydd/base/interruption.h"
#include "ydd/base/json_reader.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Waits for a child, and ends it when this process is asked to end. Its exit code; negative if it
/// died.
int wait_for(pid_t child) {
  using std::chrono::milliseconds;
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(child, &status, WNOHANG)) == 0) {
    if (interruption::sleep_until(std::chrono::steady_clock::now() + milliseconds(5))) continue;
    ::kill(child, SIGTERM);
    ended = ::waitpid(child, &status, 0);
    break;
  }
  if (ended < 0) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Runs this program again; its output goes to `log`. Gives the exit code, negative if it could
/// not be started or died.
int spawn_self(std::vector<std::string>& arguments, const fs::path& log) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int failed =
      ::posix_spawn(&child, "/proc/self/exe", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failed == 0 ? wait_for(child) : -1;
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "no output";
  const std::size_t begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

Result<Json> read_json(const fs::path& file) {
  const Result<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_json(*text, file.string());
}

/// The value of the first line "key : value" of a file of /proc.
std::string proc_value(const char* file, const std::string& key) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(':');
    if (line.rfind(key, 0) != 0 || colon == std::string::npos) continue;
    const std::size_t value = line.find_first_not_of(" \t", colon + 1);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "unknown";
}

}  // namespace

Result<ChildRun> run_in_child(std::vector<std::string> arguments, const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  const fs::path log = folder.string() + ".log";
  arguments.insert(arguments.begin(), {"ydd-slam", "run"});
  for (const std::string& option :
       {std::string("--out"), folder.string(), std::string("--quiet")}) {
    arguments.push_back(option);
  }
  const int code = spawn_self(arguments, log);
  if (code != 0) {
    const Result<std::string> said = read_file(log);
    return Error{said ? last_line(*said) : std::string("a run could not be started")};
  }
  Result<Json> summary = read_json(folder / "summary.json");
  if (!summary) return summary.error();
  Result<Json> timings = read_json(folder / "timings.json");
  if (!timings) return timings.error();
  fs::remove_all(folder, ignored);
  return ChildRun{std::move(*summary), std::move(*timings)};
}

Json machine_description() {
  utsname system{};
  ::uname(&system);
  return {{"processor", proc_value("/proc/cpuinfo", "model name")},
          {"cores", std::thread::hardware_concurrency()},
          {"memory", proc_value("/proc/meminfo", "MemTotal")},
          {"system", fmt::format("{} {}", system.sysname, system.release)},
          {"compiler", __VERSION__}};
}

}  // namespace ydd::app
