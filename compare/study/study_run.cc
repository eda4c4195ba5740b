#include "compare/study/study_run.h"

#include "fast/command/command_line.h"
#include "scene/base/build_info.h"
#include "scene/base/files.h"
#include "scene/base/hash.h"
#include "scene/base/json_text.h"
#include "scene/input/scene_io.h"
#include "scene/output/results.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <array>
#include <ctime>
#include <deque>
#include <iostream>
#include <optional>
#include <streambuf>

namespace touchstone::compare {
namespace {

using Json = nlohmann::ordered_json;

/// A file that the program wrote, or null if it is missing or altered.
Json read_json(const std::filesystem::path& path) {
  const std::optional<std::string> text = scene::read_file(path);
  Json json = text ? Json::parse(*text, nullptr, false) : Json();
  return json.is_object() ? json : Json();
}

/// A text in the JSON object; empty if there is none.
std::string text_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

double number_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : 0.0;
}

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text.data();
}

/// While it exists, it also keeps the last line written to a stream, in which commands say why they failed.
class LastLine : public std::streambuf {
 public:
  explicit LastLine(std::ostream& stream) : stream_(stream), below_(stream.rdbuf(this)) {}
  ~LastLine() override { stream_.rdbuf(below_); }
  LastLine(const LastLine&) = delete;
  LastLine& operator=(const LastLine&) = delete;
  [[nodiscard]] const std::string& text() const noexcept { return line_.empty() ? last_ : line_; }

 protected:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char letter = traits_type::to_char_type(c);
    if (letter != '\n' && letter != '\r') {
      line_ += letter;
    } else if (!line_.empty()) {
      last_ = std::exchange(line_, "");
    }
    return below_->sputc(letter);
  }
  int sync() override { return below_->pubsync(); }

 private:
  std::ostream& stream_;
  std::streambuf* below_;
  std::string line_, last_;
};

bool is_done(const StudyManifest& manifest, const ManifestCase& one, const Json& done) {
  if (done.is_null() || text_in(done, "id") != one.id) return false;
  const std::optional<std::string> summary = scene::read_file(manifest.result_folder(one) / "summary.json");
  return summary && text_in(done, "summary") == scene::hash_text(*summary);
}

/// Runs the command; every kind of failure becomes an exit code and a message.
int run_verb(const CaseRun& run, const std::filesystem::path& scene_file, const std::filesystem::path& folder,
             std::string& why) {
  try {
    const LastLine said(std::cerr);
    const int code = run(scene_file, folder);
    why = said.text();
    return code;
  } catch (...) {
    fast::Failure failure = fast::failure_at_hand();
    why = std::move(failure.message);
    return failure.exit_code;
  }
}

/// Runs one case, whose lock is held. @returns its exit code
int run_case(const StudyManifest& manifest, const ManifestCase& one, const CaseRun& run,
             const std::function<void(const std::string&)>& say) {
  const std::filesystem::path folder = manifest.result_folder(one), scene_file = manifest.scene_file(one);
  const std::string title = fmt::format("case {} of {} ({})", one.index, manifest.cases.size(), one.name);
  if (case_id(manifest.run, scene::load_scene(scene_file)) != one.id) {
    throw scene::InputError({{scene_file.string(), 0, 0,
                              "changed since the study was expanded; expected the scene of " + title +
                                  ": change the study and expand it again"}});
  }
  scene::remove_unfinished(folder);
  std::filesystem::remove(folder / "done.json");
  std::filesystem::remove(folder / "failed.json");
  const Json attempt = {{"id", one.id}, {"host", host_name()}, {"process", ::getpid()}, {"began", utc_now()}};
  scene::write_file(folder / "attempt.json", scene::json_text(attempt));
  say(title);
  const scene::Stopwatch watch;
  std::string why;
  const int code = run_verb(run, scene_file, folder, why);
  if (code == fast::interrupted) return code;
  if (code != fast::done) {
    Json failed = attempt;
    failed["exit_code"] = code;
    failed["why"] = why;
    scene::write_file(folder / "failed.json", scene::json_text(failed));
    say(title + " failed: " + why);
    return code;
  }
  const std::optional<std::string> summary = scene::read_file(folder / "summary.json");
  if (!summary) throw std::logic_error("the command wrote no summary.json");
  Json done = attempt;
  done["ended"] = utc_now();
  done["wall_s"] = watch.wall_s();
  done["version"] = scene::build_info.version;
  done["commit"] = scene::build_info.commit;
  done["summary"] = scene::hash_text(*summary);
  scene::write_file(folder / "done.json", scene::json_text(done));
  say(title + fmt::format(" done in {:.1f} s", watch.wall_s()));
  return code;
}

}  // namespace

const char* state_name(CaseState state) {
  constexpr std::array names = {"done", "failed", "running", "interrupted", "waiting"};
  return names[static_cast<std::size_t>(state)];
}

CaseStatus case_status(const StudyManifest& manifest, const ManifestCase& one) {
  const std::filesystem::path folder = manifest.result_folder(one);
  if (const Json done = read_json(folder / "done.json"); is_done(manifest, one, done)) {
    return {CaseState::done, "", text_in(done, "version") + " " + text_in(done, "commit"), number_in(done, "wall_s")};
  }
  const bool running = scene::FolderLock::held(folder);
  const Json failed = read_json(folder / "failed.json");
  if (!running && !failed.is_null()) return {CaseState::failed, text_in(failed, "why"), "", 0.0};
  const Json attempt = read_json(folder / "attempt.json");
  if (attempt.is_null()) return {running ? CaseState::running : CaseState::waiting, "", "", 0.0};
  return {running ? CaseState::running : CaseState::interrupted,
          fmt::format("begun {} on {} by process {}", text_in(attempt, "began"), text_in(attempt, "host"),
                      number_in(attempt, "process")),
          "", 0.0};
}

int run_cases(const StudyManifest& manifest, const CaseRange& range, const CaseRun& run,
              const std::function<void(const std::string&)>& say) {
  const int count = static_cast<int>(manifest.cases.size());
  if (range.first < 1 || range.first > count) {
    throw scene::InputError(fmt::format("--index {}: expected a whole number in [1, {}]", range.first, count));
  }
  if (range.step < 1) throw scene::InputError(fmt::format("--step {}: expected a whole number from 1", range.step));
  const auto failure = [&](const ManifestCase& one) { return read_json(manifest.result_folder(one) / "failed.json"); };
  std::deque<std::pair<const ManifestCase*, Json>> todo;  // with its earlier failure
  for (int index = range.first; index <= count; index += range.step) {
    todo.emplace_back(&manifest.cases[index - 1], failure(manifest.cases[index - 1]));
  }
  const bool single = todo.size() == 1;
  int worst = fast::done;
  // Cases that other processes run are moved to the end. If nothing else is left, the loop waits for them.
  std::size_t busy = 0;
  while (!todo.empty()) {
    const auto [at, failed_before] = std::move(todo.front());
    const ManifestCase& one = *at;
    todo.pop_front();
    if (case_status(manifest, one).state == CaseState::done) {
      busy = 0;
      continue;
    }
    const std::filesystem::path folder = manifest.result_folder(one);
    scene::require_writable(folder, "study folder");
    scene::FolderLock lock(folder);
    if (busy < todo.size()) {
      if (!lock.try_take()) {
        ++busy;
        todo.emplace_back(&one, failed_before);
        continue;
      }
    } else {
      bool told = false;
      lock.take([&] {
        if (!std::exchange(told, true))
          say(fmt::format("case {} is run by another process; waiting for it", one.index));
      });
    }
    busy = 0;
    // Another process may have finished it meanwhile, or failed with the same settings.
    if (case_status(manifest, one).state == CaseState::done) continue;
    const Json failed = failure(one);
    const bool tried = !failed.is_null() && failed != failed_before;
    const int code = tried ? static_cast<int>(number_in(failed, "exit_code")) : run_case(manifest, one, run, say);
    if (code == fast::interrupted) return code;
    if (code != fast::done) worst = single ? code : fast::answer_is_no;
  }
  return worst;
}

}  // namespace touchstone::compare
