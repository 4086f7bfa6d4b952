// SPDX-License-Identifier: Apache-2.0
#include "common/child_run.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "ydd/base/files.h"
#include "ydd/base/interruption.h"
#include "ydd/base/json_reader.h"
#include "ydd/base/timing.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Megabytes of the line "key: N kB" of /proc/PID/status; 0: it is not there.
double status_mb(const std::string& line, std::string_view key) {
  if (!line.starts_with(key) || line.size() <= key.size() || line[key.size()] != ':') return 0;
  const std::size_t begin = line.find_first_of("0123456789");
  std::int64_t kilobytes = 0;
  if (begin != std::string::npos) {
    std::from_chars(line.data() + begin, line.data() + line.size(), kilobytes);
  }
  return static_cast<double>(kilobytes) / 1024;
}

/// Keeps the largest of what the child uses by now. The kernel keeps peaks of all but what is
/// shared.
void look_at_memory(pid_t child, ProcessUse& use) {
  std::ifstream status(fmt::format("/proc/{}/status", child));
  double shared_mb = 0;
  for (std::string line; std::getline(status, line);) {
    use.virtual_mb = std::max(use.virtual_mb, status_mb(line, "VmPeak"));
    use.resident_mb = std::max(use.resident_mb, status_mb(line, "VmHWM"));
    shared_mb += status_mb(line, "RssFile") + status_mb(line, "RssShmem");
  }
  use.shared_mb = std::max(use.shared_mb, shared_mb);
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Waits for a child, and ends it when this process is asked to end. Its exit code; negative if it
/// died.
int wait_for(pid_t child, ProcessUse& use) {
  using std::chrono::milliseconds;
  constexpr int kLookEvery = 10;
  int status = 0;
  pid_t ended = 0;
  rusage usage{};
  const std::int64_t start_ns = wall_clock_ns();
  for (int i = 0; (ended = ::wait4(child, &status, WNOHANG, &usage)) == 0; ++i) {
    if (i % kLookEvery == 0) look_at_memory(child, use);
    if (interruption::sleep_until(std::chrono::steady_clock::now() + milliseconds(5))) continue;
    ::kill(child, SIGTERM);
    ended = ::wait4(child, &status, 0, &usage);
    break;
  }
  if (ended < 0) return -1;
  use.wall_s = static_cast<double>(wall_clock_ns() - start_ns) * 1e-9;
  use.cpu_s = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Runs this program again; its output goes to `log`. Gives the exit code, negative if it could
/// not be started or died.
int spawn_self(std::vector<std::string>& arguments, const fs::path& log, ProcessUse& use) {
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
  return failed == 0 ? wait_for(child, use) : -1;
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

Result<ProcessUse> run_self(std::vector<std::string> arguments, const fs::path& log) {
  arguments.insert(arguments.begin(), "ydd-slam");
  ProcessUse use;
  if (spawn_self(arguments, log, use) == 0) return use;
  const Result<std::string> said = read_file(log);
  return Error{said ? last_line(*said) : std::string("a run could not be started")};
}

Result<KeptRun> run_in_child_keeping(std::vector<std::string> arguments, const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), {"--out", folder.string(), "--quiet"});
  const Result<ProcessUse> use = run_self(std::move(arguments), folder.string() + ".log");
  if (!use) return use.error();
  Result<Json> summary = read_json(folder / "summary.json");
  if (!summary) return summary.error();
  Result<Json> timings = read_json(folder / "timings.json");
  if (!timings) return timings.error();
  return KeptRun{{*std::move(summary), *std::move(timings)}, *use};
}

Result<ChildRun> run_in_child(std::vector<std::string> arguments, const fs::path& folder) {
  Result<KeptRun> run = run_in_child_keeping(std::move(arguments), folder);
  if (!run) return run.error();
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return std::move(run->results);
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
