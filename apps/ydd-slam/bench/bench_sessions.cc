// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_sessions.h"

#include <fmt/format.h>

#include "bench/bench_seeds.h"
#include "common/progress.h"
#include "common/scratch_folder.h"
#include "ydd/base/files.h"
#include "ydd/base/json_reader.h"
#include "ydd/base/json_text.h"
#include "ydd/base/log.h"
#include "ydd/map_files/map_file.h"
#include "ydd/studies/sessions.h"

namespace ydd::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMaxSeriesBytes = 64U << 20U;

Json to_json(const SessionFigures& s) {
  return {{"session", s.number},
          {"light", s.light},
          {"frames", s.frames},
          {"frames_until_found", s.frames_until_found},
          {"found_cpu_ms", s.found_cpu_ms},
          {"lost_frames", s.lost_frames},
          {"losses", s.losses},
          {"recoveries", s.recoveries},
          {"frame_cpu_ms_median", s.frame_cpu_ms_median},
          {"frame_cpu_ms_p95", s.frame_cpu_ms_p95},
          {"keyframes_made", s.keyframes_made},
          {"keyframes_culled", s.keyframes_culled},
          {"keyframes", s.keyframes},
          {"points", s.points},
          {"observations", s.observations},
          {"maps", s.maps},
          {"file_mb", static_cast<double>(s.file_bytes) * 1e-6},
          {"load_ms", s.load_ms},
          {"save_ms", s.save_ms},
          {"ate_m", s.ate_m},
          {"map_m", s.map_m},
          {"place_m", s.place_m},
          {"found_m", s.found_m},
          {"misplaced_frames", s.misplaced_frames},
          {"loops", s.loops},
          {"merges", s.merges},
          {"false_loops", s.false_loops},
          {"resident_mb", s.memory_mb}};
}

/// The row of sessions so far and the map after them, in a folder.
class SessionFolder {
 public:
  /// Takes up what lies there. Failure: it is of something else, or map and figures do not belong
  /// together.
  static Result<SessionFolder> open(const fs::path& folder, const Json& about) {
    SessionFolder opened(folder, about);
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure) return Error{fmt::format("{}: {}", folder.string(), failure.message())};
    if (!fs::exists(opened.figures_file())) return opened;
    const Result<std::string> text = read_file_bounded(opened.figures_file(), kMaxSeriesBytes);
    if (!text) return text.error();
    Result<Json> json = parse_json(*text, opened.figures_file().string());
    if (!json) return json.error();
    opened.json_ = *std::move(json);
    if (!opened.json_.is_object() || !opened.json_.contains("series") ||
        opened.json_.value("about", Json()) != about) {
      return Error{fmt::format("{}: was made by other options; name another folder",
                               opened.figures_file().string())};
    }
    return opened.check();
  }

  int done() const { return static_cast<int>(json_["series"].size()); }
  fs::path map_file() const { return folder_ / "map.ydd"; }
  fs::path figures_file() const { return folder_ / "sessions.json"; }
  const Json& json() const { return json_; }

  Result<void> add(const SessionFigures& figures) {
    json_["series"].push_back(to_json(figures));
    return write_file_atomically(figures_file(), json_text(json_, 1) + "\n");
  }

 private:
  SessionFolder(fs::path folder, const Json& about) : folder_(std::move(folder)) {
    json_["about"] = about;
    json_["series"] = Json::array();
  }

  Result<SessionFolder> check() const {
    if (done() == 0) return *this;
    const Result<Atlas> atlas = load_map(map_file());
    if (!atlas) return atlas.error();
    if (json_["series"].back().value("keyframes", std::size_t{0}) != atlas->keyframes().size()) {
      return Error{
          fmt::format("{}: is not the map after the {} sessions of {}; name another folder",
                      map_file().string(), done(), figures_file().string())};
    }
    return *this;
  }

  fs::path folder_;
  Json json_;
};

std::string row(const Json& s) {
  return fmt::format(
      "| {} | {} | {} | {} | {:.1f} | {} | {} | {:.1f} | {:.4f} | {:.4f} | {} | {} ({}) | "
      "{} ({}) | {:.2f} | {:.0f} |\n",
      s["session"].get<int>() + 1, s["light"].get<std::string>(), s["keyframes"].get<int>(),
      s["points"].get<int>(), s["file_mb"].get<double>(), s["maps"].get<int>(),
      s["frames_until_found"].get<int>(), s["found_cpu_ms"].get<double>(), s["ate_m"].get<double>(),
      s["place_m"].get<double>(), s["misplaced_frames"].get<int>(), s["losses"].get<int>(),
      s["lost_frames"].get<int>(), s["loops"].get<int>() + s["merges"].get<int>(),
      s["false_loops"].get<int>(), s["frame_cpu_ms_median"].get<double>(),
      s["resident_mb"].get<double>());
}

std::string table_of(const Json& series, std::size_t every) {
  std::string table =
      "| session | light | keyframes | points | file MB | maps | frames until found | that frame, "
      "ms | ATE m | in the map m | frames misplaced | losses (frames) | loops and merges (false) | "
      "ms a frame | resident MB |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | "
      "--- | --- | "
      "--- | --- | --- |\n";
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (i == 0 || (i + 1) % every == 0 || i + 1 == series.size()) table += row(series[i]);
  }
  return table;
}

/// Largest number of keyframes over all sessions from `from` on, by that after session `from`.
std::string growth(const Json& series, std::size_t from) {
  if (series.size() <= from) return "";
  const double base = series[from - 1]["keyframes"].get<double>();
  double most = 0;
  for (std::size_t i = from; i < series.size(); ++i) {
    most = std::max(most, series[i]["keyframes"].get<double>());
  }
  return fmt::format("\nkeyframes: at most {:.2f} times, in the end {:.2f} times those after {}\n",
                     most / base, series.back()["keyframes"].get<double>() / base, from);
}

Json about_of(const SessionRequest& request, const std::string& what, const WorldOptions& world) {
  Json about = {{"what", what},
                {"seed", request.seed},
                {"width_px", request.width_px},
                {"fps", request.fps},
                {"rooms", world.rooms},
                {"people", world.people},
                {"light_changes", !request.steady},
                {"set", request.set}};
  about[what == "visits" ? "seconds" : "minutes"] =
      what == "visits" ? request.seconds : request.minutes;
  return about;
}

Result<Json> run_sessions(const SessionRequest& request, const SessionPlan& plan,
                          const Json& about) {
  Result<SystemOptions> options = system_options(request.set);
  if (!options) return options.error();
  options->deterministic = true;
  std::optional<ScratchFolder> scratch;
  if (request.folder.empty()) {
    Result<ScratchFolder> made = ScratchFolder::make();
    if (!made) return made.error();
    scratch.emplace(std::move(*made));
  }
  Result<SessionFolder> folder =
      SessionFolder::open(scratch ? scratch->path() / "sessions" : fs::path(request.folder), about);
  if (!folder) return folder.error();
  const auto frames = [&](int number) {
    return static_cast<std::size_t>(plan(number).world.frames);
  };
  std::size_t total = 0, done = 0;
  for (int n = folder->done(); n < request.sessions; ++n) total += frames(n);
  Progress progress(about["what"].get<std::string>(), total, request.quiet);
  for (int n = folder->done(); n < request.sessions; ++n) {
    const auto told = [&](int frame, std::size_t keyframes) {
      progress.update(done + static_cast<std::size_t>(frame),
                      fmt::format("session {}, {} keyframes", n + 1, keyframes));
    };
    const Result<SessionFigures> figures = run_session(plan, n, *options, folder->map_file(), told);
    if (!figures) return figures.error();
    if (auto r = folder->add(*figures); !r) return r.error();
    done += frames(n);
  }
  return folder->json();
}

WorldOptions world_of(const SessionRequest& request, int rooms) {
  SeedRequest walk;
  walk.width_px = request.width_px;
  walk.fps = request.fps;
  return walk_world(walk, request.seed, rooms);
}

}  // namespace

Result<std::string> bench_visits(const SessionRequest& request) {
  constexpr std::size_t kSettled = 10;  // visits after which a room should hardly grow
  VisitOptions options;
  options.world = world_of(request, 1);
  options.seconds = request.seconds;
  options.light_changes = !request.steady;
  const Result<Json> json =
      run_sessions(request, visits(options), about_of(request, "visits", options.world));
  if (!json) return json.error();
  return table_and_json(table_of((*json)["series"], 10) + growth((*json)["series"], kSettled),
                        *json, request.out);
}

Result<std::string> bench_days(const SessionRequest& request) {
  DayOptions options;
  options.world = world_of(request, request.rooms);
  options.world.people = request.people;
  options.session_minutes = request.minutes;
  options.light_changes = !request.steady;
  const Result<Json> json =
      run_sessions(request, hours(options), about_of(request, "days", options.world));
  if (!json) return json.error();
  return table_and_json(table_of((*json)["series"], 1), *json, request.out);
}

}  // namespace ydd::app
