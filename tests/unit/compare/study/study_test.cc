// A study's folder with workers that compete, fail, are killed and restarted; a case's command only counts its runs.
#include "compare/study/study.h"

#include "compare/study/study_run.h"
#include "compare/study/study_table.h"
#include "fast/command/command_line.h"
#include "scene/base/files.h"
#include "scene/input/scene_io.h"
#include "scene/output/results.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <thread>

namespace touchstone::compare {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;
using std::filesystem::path;

const std::string scenes = source_folder() + "/meshes/scenes/";

class StudyFolderTest : public ::testing::Test {
 protected:
  /// @param values  of fast.C_n, one case each
  StudyManifest expanded(const std::string& values, const std::string& scene = "ball-on-cube-press",
                         const std::string& run = "fast") {
    const path file = folder_.path() / "study.toml";
    std::ofstream(file) << "scene = \"" << scenes << scene << ".toml\"\nrun = \"" << run
                        << "\"\n[[axis]]\nkey = \"fast.C_n\"\nvalues = " << values << '\n';
    return expand(load_study(file), study(), "/usr/bin/touchstone", "store");
  }
  [[nodiscard]] path study() const { return folder_.path() / "study"; }

  /// Appends a line to a log and writes a summary. The line is one write, so that processes do not mix.
  CaseRun counting_run(std::chrono::milliseconds takes = std::chrono::milliseconds(0)) {
    return [this, takes](const path& scene_file, const path& result) {
      std::ofstream(folder_.path() / "ledger", std::ios::app) << scene_file.stem().string() + "\n";
      std::this_thread::sleep_for(takes);
      const scene::Scene scene = scene::load_scene(scene_file);
      scene::write_summary(result / "summary.json", {{"force.nrmse", scene.fast.C_n, "", ""},
                                                     {"reference.model", 0.0, "a, \"quoted\" model", ""},
                                                     {"force.slip_onset_error_m", 0.001, "", "m"}});
      return static_cast<int>(fast::done);
    };
  }
  /// How often each case was run.
  [[nodiscard]] std::map<std::string, int> ledger() const {
    std::map<std::string, int> count;
    std::ifstream in(folder_.path() / "ledger");
    for (std::string line; std::getline(in, line);) ++count[line];
    return count;
  }
  static int run_all(const StudyManifest& manifest, const CaseRun& run) {
    return run_cases(manifest, {}, run, [](const std::string&) {});
  }
  static std::vector<std::string> states(const StudyManifest& manifest) {
    std::vector<std::string> list;
    for (const ManifestCase& one : manifest.cases) list.emplace_back(state_name(case_status(manifest, one).state));
    return list;
  }

  testing::TemporaryFolder folder_;
};

TEST_F(StudyFolderTest, TheManifestReadsBackAndNamesCasesByContent) {
  const StudyManifest written = expanded("[0.0, 0.1, 0.2]");
  const StudyManifest read = read_manifest(study());
  ASSERT_EQ(read.cases.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(read.cases[k].index, static_cast<int>(k) + 1);
    EXPECT_EQ(read.cases[k].id, written.cases[k].id);
    EXPECT_EQ(read.cases[k].along, written.cases[k].along);
    EXPECT_EQ(read.cases[k].settings, written.cases[k].settings);
    const scene::Scene scene = scene::load_scene(read.scene_file(read.cases[k]));
    EXPECT_EQ(case_id("fast", scene), read.cases[k].id);
    EXPECT_NE(case_id("compare", scene), read.cases[k].id);
  }
  // More values in another order: the same cases keep their identity.
  const StudyManifest more = expanded("[0.3, 0.2, 0.1]");
  EXPECT_EQ(more.cases[1].id, written.cases[2].id);
  EXPECT_EQ(more.cases[2].id, written.cases[1].id);
}

TEST_F(StudyFolderTest, CasesWithTheSameContentAreOne) {
  const path file = folder_.path() / "study.toml";
  std::ofstream(file) << "scene = \"" << scenes << "ball-on-cube-press.toml\"\nrun = \"fast\"\n"
                      << "[[case]]\nname = \"as it is\"\nset = {}\n[[case]]\nname = \"said again\"\n"
                      << "set = { tool.mass_kg = 1.0 }\n[[case]]\nname = \"heavier\"\nset = { tool.mass_kg = 2.0 }\n";
  const StudyManifest manifest = expand(load_study(file), study(), "/usr/bin/touchstone", "store");
  ASSERT_EQ(manifest.cases.size(), 2u);
  EXPECT_EQ(manifest.cases[0].name, "as it is");
  EXPECT_EQ(manifest.cases[1].name, "heavier");
  EXPECT_EQ(manifest.cases[1].index, 2);
}

TEST_F(StudyFolderTest, EveryShippedSceneSurvivesTheWayThroughTheFolder) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const StudyManifest manifest = expanded("[0.0, 0.1]", entry.path().stem());
    // A moved folder contains its mesh tools.
    const path moved = folder_.path() / "moved";
    std::filesystem::rename(study(), moved);
    const StudyManifest read = read_manifest(moved);
    for (const ManifestCase& one : read.cases) {
      const scene::Scene scene = scene::load_scene(read.scene_file(one));
      EXPECT_EQ(case_id("fast", scene), one.id) << entry.path();
      EXPECT_EQ(scene.fast.C_n, one.index == 1 ? 0.0 : 0.1);
    }
    std::filesystem::remove_all(moved);
  }
  EXPECT_GT(count, 10);
}

TEST_F(StudyFolderTest, WhatASolverCannotDoIsRefusedBeforeAnythingIsWritten) {
  const path file = folder_.path() / "study.toml";
  // An edge that is too sharp for the reference.
  std::ofstream(file) << "scene = \"" << scenes << "ball-on-cube-press.toml\"\nrun = \"reference\"\n[[case]]\n"
                      << "name = \"sharp\"\nset = { tool.shape = \"cylinder\", tool.length_m = 0.02, "
                      << "tool.edge_radius_m = 0.0, \"track[0].position_m[2]\" = 0.09, "
                      << "\"track[1].position_m[2]\" = 0.065 }\n";
  try {
    (void)expand(load_study(file), study(), "/usr/bin/touchstone", "store");
    FAIL() << "accepted";
  } catch (const scene::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("(case \"sharp\")"));
  }
  EXPECT_FALSE(std::filesystem::exists(study()));
}

TEST_F(StudyFolderTest, WhatIsDoneIsNotRunAgain) {
  const StudyManifest manifest = expanded("[0.0, 0.1, 0.2]");
  EXPECT_THAT(states(manifest), ElementsAre("waiting", "waiting", "waiting"));
  const auto silent = [](const std::string&) {};
  EXPECT_EQ(run_cases(manifest, {2, 100}, counting_run(), silent), fast::done);
  EXPECT_THAT(states(manifest), ElementsAre("waiting", "done", "waiting"));
  EXPECT_EQ(run_cases(manifest, {1, 2}, counting_run(), silent), fast::done);
  EXPECT_EQ(run_all(manifest, counting_run()), fast::done);
  EXPECT_THAT(states(manifest), ElementsAre("done", "done", "done"));
  for (const auto& [id, times] : ledger()) EXPECT_EQ(times, 1) << id;
  EXPECT_EQ(ledger().size(), 3u);
  // Expanded again with one more value: only that case is left.
  const StudyManifest more = expanded("[0.3, 0.2, 0.1, 0.0]");
  EXPECT_THAT(states(more), ElementsAre("waiting", "done", "done", "done"));
  // A result that was altered does not count.
  std::ofstream(more.result_folder(more.cases[2]) / "summary.json", std::ios::app) << " ";
  EXPECT_THAT(states(more), ElementsAre("waiting", "done", "interrupted", "done"));
  EXPECT_EQ(run_all(more, counting_run()), fast::done);
  EXPECT_EQ(ledger().at(more.cases[2].id), 2);
  // Nor does one whose marker file was overwritten.
  std::ofstream(more.result_folder(more.cases[2]) / "done.json") << "{\"id\": 3, \"summary\": []}";
  EXPECT_THAT(states(more), ElementsAre("done", "done", "interrupted", "done"));
}

TEST_F(StudyFolderTest, AnIndexOutsideTheStudyIsRefused) {
  const StudyManifest manifest = expanded("[0.0, 0.1]");
  for (const int index : {-1, 0, 3}) {
    EXPECT_THROW(run_cases(manifest, {index, 1}, counting_run(), [](const std::string&) {}), scene::InputError);
  }
}

TEST_F(StudyFolderTest, AnEditedSceneIsRefused) {
  const StudyManifest manifest = expanded("[0.0, 0.1]");
  const path file = manifest.scene_file(manifest.cases[0]);
  std::string text = *scene::read_file(file);
  text.replace(text.find("triangles = 3952"), 16, "triangles = 3953");
  std::ofstream(file) << text;
  try {
    run_all(manifest, counting_run());
    FAIL() << "accepted";
  } catch (const scene::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.string() + ": changed since the study was expanded"));
  }
  EXPECT_TRUE(ledger().empty());
}

TEST_F(StudyFolderTest, EveryFailureIsKeptWithItsReasonAndTriedAgain) {
  const StudyManifest manifest = expanded("[0.0, 0.1, 0.2, 0.3]");
  const auto sick = [&](const path& scene_file, const path& result) -> int {
    const double C_n = scene::load_scene(scene_file).fast.C_n;
    if (C_n == 0.0) {
      std::cerr << "a word before\ninstant 2 of 3 did not converge" << std::endl;
      return fast::not_converged;
    }
    if (C_n == 0.1) throw std::runtime_error("out of memory, say");
    if (C_n == 0.2)
      throw std::filesystem::filesystem_error("cannot write", "/x",
                                              std::make_error_code(std::errc::no_space_on_device));
    return counting_run()(scene_file, result);
  };
  EXPECT_EQ(run_all(manifest, sick), fast::answer_is_no);
  EXPECT_THAT(states(manifest), ElementsAre("failed", "failed", "failed", "done"));
  EXPECT_EQ(case_status(manifest, manifest.cases[0]).why, "instant 2 of 3 did not converge");
  EXPECT_EQ(case_status(manifest, manifest.cases[1]).why, "out of memory, say");
  EXPECT_THAT(case_status(manifest, manifest.cases[2]).why, HasSubstr("No space left on device"));
  EXPECT_EQ(run_cases(manifest, {1, 100}, sick, [](const std::string&) {}), fast::not_converged);

  const StudyTable table = collect(manifest);
  EXPECT_EQ(table.done, 1);
  EXPECT_THAT(table.text, HasSubstr("case 1 (fast.C_n = 0.0): failed: instant 2 of 3 did not converge\n"));
  EXPECT_THAT(table.text, HasSubstr("To run again: 1-3\n"));

  EXPECT_EQ(run_all(manifest, counting_run()), fast::done);
  EXPECT_THAT(states(manifest), ElementsAre("done", "done", "done", "done"));
  EXPECT_EQ(collect(manifest).text, "");
}

TEST_F(StudyFolderTest, AStopEndsTheRunAtOnceAndLeavesTheCaseInterrupted) {
  const StudyManifest manifest = expanded("[0.0, 0.1]");
  EXPECT_EQ(run_all(manifest, [](const path&, const path&) { return fast::interrupted; }), fast::interrupted);
  EXPECT_THAT(states(manifest), ElementsAre("interrupted", "waiting"));
  EXPECT_THAT(collect(manifest).text, HasSubstr("interrupted: begun "));
}

TEST_F(StudyFolderTest, WorkersThatRaceRunEveryCaseOnce) {
  const StudyManifest manifest = expanded("[0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35]");
  std::vector<pid_t> workers;
  for (int worker = 0; worker < 3; ++worker) {
    workers.push_back(::fork());
    if (workers.back() == 0) ::_exit(run_all(manifest, counting_run(std::chrono::milliseconds(10))));
  }
  for (const pid_t worker : workers) {
    int status = -1;
    ::waitpid(worker, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(ledger().size(), 8u);
  for (const auto& [id, times] : ledger()) EXPECT_EQ(times, 1) << id;
  EXPECT_EQ(collect(manifest).done, 8);
}

TEST_F(StudyFolderTest, AFailureIsNotRepeatedByEveryWorkerOfOneRace) {
  const StudyManifest manifest = expanded("[0.0]");
  // Neither fails before both have started.
  int both_there[2];
  ASSERT_EQ(::pipe(both_there), 0);
  const auto fails = [&](const path& scene_file, const path& result) -> int {
    char there[2];
    for (ssize_t count = 0; count < 2; count += std::max<ssize_t>(0, ::read(both_there[0], there, 2 - count))) continue;
    EXPECT_EQ(::write(both_there[1], there, 2), 2);
    (void)counting_run(std::chrono::milliseconds(300))(scene_file, result);
    return fast::not_converged;
  };
  std::vector<pid_t> workers;
  for (int worker = 0; worker < 2; ++worker) {
    workers.push_back(::fork());
    if (workers.back() == 0) ::_exit(::write(both_there[1], "+", 1) == 1 ? run_all(manifest, fails) : 0);
  }
  for (const pid_t worker : workers) {
    int status = 0;
    ::waitpid(worker, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), fast::not_converged);
  }
  EXPECT_EQ(ledger().begin()->second, 1);
}

TEST_F(StudyFolderTest, KilledWorkersLoseNothingThatWasDone) {
  const StudyManifest manifest = expanded("[0.0, 0.05, 0.1, 0.15, 0.2]");
  std::mt19937 random(std::random_device{}());
  std::map<std::string, bool> was_done;
  for (int kill = 0; kill < 25; ++kill) {
    const pid_t worker = ::fork();
    if (worker == 0) ::_exit(run_all(manifest, counting_run(std::chrono::milliseconds(15))));
    std::this_thread::sleep_for(std::chrono::microseconds(std::uniform_int_distribution<int>(0, 60'000)(random)));
    ::kill(worker, SIGKILL);
    ::waitpid(worker, nullptr, 0);
    for (const ManifestCase& one : manifest.cases) {
      const CaseState state = case_status(manifest, one).state;
      EXPECT_NE(state, CaseState::running);
      EXPECT_NE(state, CaseState::failed);
      EXPECT_TRUE(state == CaseState::done || !was_done[one.id]);
      was_done[one.id] = state == CaseState::done;
    }
  }
  EXPECT_EQ(run_all(manifest, counting_run()), fast::done);
  EXPECT_EQ(collect(manifest).done, 5);
  for (const ManifestCase& one : manifest.cases) {
    for (const auto& entry : std::filesystem::directory_iterator(manifest.result_folder(one))) {
      EXPECT_THAT(entry.path().string(), Not(HasSubstr(".touchstone-part-")));
    }
  }
}

TEST_F(StudyFolderTest, TheTableHoldsEveryFigureOfEveryCase) {
  const StudyManifest manifest = expanded("[0.0, 0.1, 0.2]");
  (void)run_cases(manifest, {1, 2}, counting_run(), [](const std::string&) {});
  const StudyTable table = collect(manifest);
  EXPECT_EQ(table.cases, 3);
  EXPECT_EQ(table.done, 2);
  EXPECT_EQ(table.text, "case 2 (fast.C_n = 0.1): waiting\nTo run again: 2\n");

  const std::string csv = *scene::read_file(study() / "summary.csv");
  EXPECT_THAT(csv, ::testing::StartsWith("index,id,name,state,why,version,wall_s,fast.C_n,force.nrmse,reference.model,"
                                         "force.slip_onset_error_m\n1," +
                                         manifest.cases[0].id + ",fast.C_n = 0.0,done,,"));
  EXPECT_THAT(csv, HasSubstr(",0.2,0.2,\"a, \"\"quoted\"\" model\",0.001\n"));
  EXPECT_THAT(csv, HasSubstr(",waiting,,,,0.1,,,\n"));

  const Json json = Json::parse(*scene::read_file(study() / "summary.json"));
  ASSERT_EQ(json["cases"].size(), 3u);
  EXPECT_EQ(json["cases"][2]["figures"]["force.nrmse"], 0.2);
  EXPECT_EQ(json["cases"][2]["set"]["fast.C_n"], "0.2");
  EXPECT_EQ(json["cases"][1]["state"], "waiting");
  EXPECT_FALSE(json["cases"][1].contains("figures"));
  EXPECT_EQ(json["units"]["force.slip_onset_error_m"], "m");

  EXPECT_THAT(*scene::read_file(study() / "summary.md"),
              HasSubstr("| case | fast.C_n | state | force.nrmse |\n|---|---|---|---:|\n| 1 | 0.0 | done | 0"));
}

TEST_F(StudyFolderTest, TheBatchScriptRunsEveryCaseOnceAndIsShell) {
  const StudyManifest manifest = expanded("[0.0, 0.1, 0.2]");
  const std::string script = *scene::read_file(study() / "array.sbatch");
  EXPECT_THAT(script, HasSubstr("#SBATCH --array=1-3\n"));
  EXPECT_TRUE(std::filesystem::is_directory(study() / "logs"));
  // A program in place of the real one records its arguments.
  const path program = folder_.path() / "it's a program";
  std::ofstream(program) << "#!/bin/sh\necho \"$@\" >> '" << (folder_.path() / "asked").string() << "'\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  (void)expand(load_study(folder_.path() / "study.toml"), study(), program, "store");
  for (const char* task : {"1", "3"}) {
    ASSERT_EQ(
        std::system(("SLURM_ARRAY_TASK_ID=" + std::string(task) + " bash '" + (study() / "array.sbatch").string() + "'")
                        .c_str()),
        0);
  }
  const std::string rest = " --step 3 --store " + std::filesystem::absolute("store").string() + "\n";
  EXPECT_EQ(*scene::read_file(folder_.path() / "asked"), "study run " + study().string() + " --index 1" + rest +
                                                             "study run " + study().string() + " --index 3" + rest);
}

TEST_F(StudyFolderTest, NoStudyIsSaidInOneLine) {
  for (const char* text : {"", "{", "{\"format\": 2}", "{\"format\": 1, \"kind\": \"sweep\", \"cases\": []}"}) {
    std::filesystem::create_directories(study());
    std::ofstream(study() / "manifest.json") << text;
    try {
      (void)read_manifest(study());
      ADD_FAILURE() << text << " accepted";
    } catch (const scene::InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("manifest.json: "));
      EXPECT_THAT(error.what(), HasSubstr("expected what \"touchstone study expand\" writes"));
    }
  }
}

TEST(Ranges, AreWhatABatchSystemTakes) {
  EXPECT_EQ(ranges_text({1, 2, 3, 5, 7, 8}), "1-3,5,7-8");
  EXPECT_EQ(ranges_text({4}), "4");
  EXPECT_EQ(ranges_text({}), "");
}

}  // namespace
}  // namespace touchstone::compare
