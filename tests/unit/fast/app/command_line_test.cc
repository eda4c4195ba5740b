// Every command that writes results, as a user sees it: exit codes, one clear message, no partial files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/source_folder.h"

namespace {

using testing::HasSubstr;

struct Answer {
  int exit_code;
  std::string output;  ///< stdout and stderr
};

Answer run(const std::string& command) {
  Answer answer{-1, ""};
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) answer.output += buffer.data();
  answer.exit_code = WEXITSTATUS(pclose(pipe));
  return answer;
}

std::vector<std::string> verbs() {
  std::vector<std::string> list;
  std::istringstream in(TOUCHSTONE_VERBS);
  for (std::string verb; std::getline(in, verb, '|');) list.push_back(verb);
  return list;
}

/// Without "fast" and "live" of the full program: touchstone-fast has the same code and starts faster.
std::vector<std::string> verbs_once() {
  std::vector<std::string> list = verbs();
  std::erase_if(list, [](const std::string& verb) {
    return verb.ends_with("touchstone fast") || verb.ends_with("touchstone live");
  });
  return list;
}

const std::string scene = touchstone::source_folder() + "/meshes/scenes/ball-on-cube-press.toml";

class Verb : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    for (char& c : name) {
      if (c == '/') c = '-';
    }
    dir_ = std::filesystem::path(testing::TempDir()) / ("verb-" + std::to_string(getpid()) + name);
    std::filesystem::remove_all(dir_);
    std::filesystem::create_directories(dir_);
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }

  /// The shipped scene with one text replaced, in a new file.
  std::string edited(const std::string& from, const std::string& to) {
    std::ifstream in(scene);
    std::stringstream text;
    text << in.rdbuf();
    std::string content = text.str();
    const std::size_t at = content.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    content.replace(at, from.size(), to);
    const std::filesystem::path file = dir_ / "edited.toml";
    std::ofstream(file) << content;
    return file.string();
  }

  void expect_refused(const std::string& file, const std::string& message) {
    const Answer answer = run(GetParam() + " " + file + " --out " + (dir_ / "out").string());
    EXPECT_EQ(answer.exit_code, 2) << answer.output;
    EXPECT_THAT(answer.output, HasSubstr(message));
    EXPECT_EQ(std::count(answer.output.begin(), answer.output.end(), '\n'), 1) << answer.output;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
  }
  std::filesystem::path dir_;
};

INSTANTIATE_TEST_SUITE_P(Verbs, Verb, testing::ValuesIn(verbs_once()), [](const auto& verb) {
  const std::string path = verb.param.substr(0, verb.param.find(' '));
  std::string name = path.substr(path.rfind('/') + 1) + "_" + verb.param.substr(verb.param.find(' ') + 1);
  for (char& c : name) {
    if (c == '-') c = '_';
  }
  return name;
});

TEST_P(Verb, RefusesAMisspeltKey) {
  expect_refused(edited("triangles =", "triangels ="), "did you mean \"fast.triangles\"?");
}
TEST_P(Verb, RefusesAValueOutsideItsRange) {
  expect_refused(edited("poissons_ratio = 0.5", "poissons_ratio = 0.6"), "expected a number in [0, 0.5]");
}
TEST_P(Verb, RefusesANaN) { expect_refused(edited("3.0e6", "nan"), "youngs_modulus_pa = nan; expected"); }
TEST_P(Verb, RefusesAToolThatStartsInside) {
  expect_refused(edited("0.0705", "0.0650"), "the tool starts 5 mm inside the body");
}
TEST_P(Verb, RefusesATrackWhoseTimeRunsBackwards) {
  expect_refused(edited("time_s = 1.1", "time_s = -1.1"), "time runs backwards");
}
TEST_P(Verb, RefusesAnUnreadableTrackFile) {
  std::string file = edited("title", "track = { file = \"none.csv\" }\ntitle");
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  std::string content = text.str();
  content.erase(content.find("[[track]]"), content.rfind("0.0650]") + 7 - content.find("[[track]]"));
  std::ofstream(file) << content;
  expect_refused(file, "none.csv: there is no such file; expected a CSV file");
}
TEST_P(Verb, RefusesAMissingScene) { expect_refused((dir_ / "none.toml").string(), "cannot read the scene"); }

TEST_P(Verb, WarnsOfATrackThatNeverTouches) {
  const bool solves = GetParam().ends_with(" compare") || GetParam().ends_with(" reference");
  const Answer answer =
      run(GetParam() + " " + edited("0.0650]", "0.0702]") + " --quiet --out " + (dir_ / "out").string() +
          (solves ? " --level 1 --store " + (dir_ / "store").string() : ""));
  EXPECT_EQ(answer.exit_code, 0) << answer.output;
  EXPECT_THAT(answer.output, HasSubstr("warning: " + (dir_ / "edited.toml").string() +
                                       ": the tool never touches the body on this track; the least gap is 0.2 mm"));
  std::ifstream file(dir_ / "out" / "manifest.json");
  EXPECT_THAT(nlohmann::json::parse(file).value("warning", ""), HasSubstr("the least gap is 0.2 mm"));
}

TEST_P(Verb, RefusesAFolderItCannotWriteTo) {
  std::ofstream(dir_ / "file") << "x";
  const Answer answer = run(GetParam() + " " + scene + " --out " + (dir_ / "file" / "out").string());
  EXPECT_EQ(answer.exit_code, 2) << answer.output;
  EXPECT_THAT(answer.output, HasSubstr("expected a folder that can be written to"));
  EXPECT_EQ(std::count(answer.output.begin(), answer.output.end(), '\n'), 1) << answer.output;
}

TEST_P(Verb, HelpHasAnExample) {
  const Answer answer = run(GetParam() + " --help");
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_THAT(answer.output, HasSubstr("Example:"));
}

TEST_P(Verb, UnknownOptionIsBadInput) { EXPECT_EQ(run(GetParam() + " " + scene + " --nonsense").exit_code, 2); }

/// Every executable that is tested.
std::set<std::string> programs() {
  std::set<std::string> list;
  for (const std::string& verb : verbs()) list.insert(verb.substr(0, verb.rfind(' ')));
  return list;
}

TEST(PlanVerb, WarnsOfATrackThatNeverTouches) {
  for (const std::string& program : programs()) {
    const Answer touching = run(program + " plan " + scene);
    EXPECT_EQ(touching.exit_code, 0);
    EXPECT_THAT(touching.output, testing::Not(HasSubstr("never touches")));
    const Answer apart = run(program + " plan " + scene + " --set track[1].position_m[2]=0.0702");
    EXPECT_EQ(apart.exit_code, 0);
    EXPECT_THAT(apart.output, HasSubstr("the tool never touches the body on this track; the least gap is 0.2 mm"));
  }
}

TEST(LiveVerb, AnUnknownDeviceIsRefusedWithThoseThereAre) {
  for (const std::string& verb : verbs()) {
    if (!verb.ends_with(" live")) continue;
    const Answer answer = run(verb + " " + scene + " --device scriptd");
    EXPECT_EQ(answer.exit_code, 2);
    EXPECT_THAT(answer.output, HasSubstr("expected scripted, replay or hand, found \"scriptd\"; did you mean "
                                         "\"scripted\"?"));
  }
}

TEST(LiveVerb, TheFullProgramLeavesAPageAndSaysWhere) {
  for (const std::string& verb : verbs()) {
    if (!verb.ends_with(" live")) continue;
    const std::filesystem::path out = std::filesystem::path(testing::TempDir()) / "live-verb-out";
    std::filesystem::remove_all(out);
    const Answer answer = run(verb + " " + scene +
                              " --device hand --seconds 0.3 --set 'live.force_max_n=2' --quiet --out " + out.string());
    EXPECT_EQ(answer.exit_code, 0) << answer.output;
    const bool full = verb.find("touchstone-fast") == std::string::npos;
    EXPECT_EQ(std::filesystem::exists(out / "report.html"), full) << verb;
    EXPECT_THAT(answer.output, HasSubstr(full ? "Report: " + (out / "report.html").string() + "\n"
                                              : "Results: " + out.string() + "\n"));
    const nlohmann::json manifest = nlohmann::json::parse(std::ifstream(out / "manifest.json"));
    const std::string command = manifest["command_line"];
    EXPECT_THAT(command, HasSubstr("ball-on-cube-press.toml --device hand --set live.force_max_n=2 --seconds 0.3"));
    if (full) {
      std::stringstream page;
      page << std::ifstream(out / "report.html").rdbuf();
      EXPECT_THAT(page.str(), HasSubstr("300 due, 1000 a second"));
      EXPECT_THAT(page.str(), HasSubstr(command));
    }
    std::filesystem::remove_all(out);
  }
}

TEST(FastVerb, LeavesTheResultFolderOfTheContract) {
  for (const std::string& verb : verbs()) {
    if (!verb.ends_with(" fast")) continue;
    const std::filesystem::path out = std::filesystem::path(testing::TempDir()) / "fast-verb-out";
    std::filesystem::remove_all(out);
    const Answer answer = run(verb + " " + scene + " --quiet --out " + out.string());
    EXPECT_EQ(answer.exit_code, 0) << answer.output;
    std::vector<std::string> files = {"manifest.json", "curve.csv", "beams.csv", "summary.json"};
    // Surfaces need VTK, which touchstone-fast does without.
    if (verb.find("touchstone-fast") == std::string::npos)
      files.insert(files.end(), {"surface.pvd", "surface_0022.vtp"});
    for (const std::string& name : files) EXPECT_TRUE(std::filesystem::exists(out / name)) << verb << ": " << name;
    std::filesystem::remove_all(out);
  }
}

TEST(FastVerb, AFullDiskIsOneMessageAndTheNextRunGoesOn) {
  for (const std::string& verb : verbs()) {
    if (!verb.ends_with(" fast")) continue;
    const std::filesystem::path out = std::filesystem::path(testing::TempDir()) / "fast-verb-full";
    std::filesystem::remove_all(out);
    const std::string command = verb + " " + scene + " --quiet --out " + out.string();
    // Files of more than 4 KiB cannot be written.
    const Answer full = run("trap '' XFSZ; ulimit -f 8; " + command);
    EXPECT_EQ(full.exit_code, 2) << full.output;
    EXPECT_THAT(full.output, HasSubstr("cannot write: File too large [" + out.string()));
    EXPECT_EQ(std::count(full.output.begin(), full.output.end(), '\n'), 1) << full.output;
    for (const auto& entry : std::filesystem::directory_iterator(out)) {
      EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".touchstone-part-")));
    }
    EXPECT_FALSE(std::filesystem::exists(out / "curve.csv"));
    EXPECT_EQ(run(command).exit_code, 0);
    EXPECT_TRUE(std::filesystem::exists(out / "curve.csv"));
    std::filesystem::remove_all(out);
  }
}

/// The executable that solves references, or nothing in a build without it.
std::string full_program() {
  for (const std::string& verb : verbs()) {
    if (verb.ends_with(" compare")) return verb.substr(0, verb.rfind(' '));
  }
  return "";
}

class NewVerb : public testing::Test {
 protected:
  NewVerb() { std::filesystem::create_directories(dir_); }
  ~NewVerb() override { std::filesystem::remove_all(dir_); }
  /// The command in the test's folder.
  [[nodiscard]] Answer make(const std::string& program, const std::string& options) const {
    return run("cd " + dir_.string() + " && " + program + " new " + options);
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    std::ifstream in(dir_ / name);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  const std::string block = "--body box 60x60x40mm --youngs-modulus 3MPa --poissons-ratio 0.45 --depth 2mm ";
  const std::filesystem::path dir_ =
      std::filesystem::path(testing::TempDir()) / ("new-verb-" + std::to_string(getpid()));
};

TEST_F(NewVerb, TheWrittenSceneRunsAndItsForceIsThatOfTheHalfSpace) {
  for (const std::string& program : programs()) {
    std::filesystem::remove(dir_ / "block.toml");
    const Answer made = make(program, "block.toml " + block + "--tool sphere 10mm");
    EXPECT_EQ(made.exit_code, 0) << made.output;
    EXPECT_THAT(made.output, HasSubstr("Scene: block.toml\nNext:\n  "));
    const std::string file = (dir_ / "block.toml").string();
    EXPECT_EQ(run(program + " plan " + file).exit_code, 0);
    const Answer ran = run(program + " fast " + file + " --quiet --out " + (dir_ / "out").string());
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    EXPECT_THAT(ran.output, HasSubstr("Status: ok")) << "the defaults do not suit a first scene";
    const std::size_t at = ran.output.find("mm): ");
    ASSERT_NE(at, std::string::npos) << ran.output;
    const double force_n = std::stod(ran.output.substr(at + 5));
    // Hertz: 4/3 E* sqrt(R) d^1.5; the law is within some percent of it at this depth.
    const double hertz_n = 4.0 / 3.0 * 3.0e6 / (1.0 - 0.45 * 0.45) * std::sqrt(0.01) * std::pow(0.002, 1.5);
    EXPECT_NEAR(force_n, hertz_n, 0.1 * hertz_n);
  }
}

TEST_F(NewVerb, TakesAMeshOffCentreWithFriction) {
  const std::string stl = touchstone::source_folder() + "/meshes/tools/mallet.stl";
  for (const std::string& program : programs()) {
    std::filesystem::remove_all(dir_ / "in");
    std::filesystem::create_directories(dir_ / "in/a");
    const Answer made = make(program, "in/a/mallet.toml " + block + "--tool mesh " + stl +
                                          " --unit mm --at -10x5mm --friction 0.3 --slide 3mm");
    EXPECT_EQ(made.exit_code, 0) << made.output;
    EXPECT_THAT(text("in/a/mallet.toml"), HasSubstr("\nK = 0.3 "));
    EXPECT_THAT(text("in/a/mallet.toml"), HasSubstr("position_m = [-0.01, 0.005]"));
    EXPECT_EQ(run(program + " plan " + (dir_ / "in/a/mallet.toml").string()).exit_code, 0);
  }
}

TEST_F(NewVerb, RefusesInOneLineAndWritesNothing) {
  const std::string program = *programs().begin();
  const auto refused = [&](const std::string& options, const std::string& message) {
    const Answer answer = make(program, "a.toml " + options);
    EXPECT_EQ(answer.exit_code, 2) << options;
    EXPECT_THAT(answer.output, HasSubstr(message));
    EXPECT_EQ(std::count(answer.output.begin(), answer.output.end(), '\n'), 1) << answer.output;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "a.toml")) << options;
  };
  refused(block + "--tool sphere 10", "--tool sphere 10: expected a length with its unit");
  refused(block + "--tool shpere 10mm", "did you mean \"sphere\"?");
  refused(block + "--tool capsule 10mm", "expected radius and length of the straight part, such as 6x20mm");
  refused(block + "--tool mesh none.stl --unit mm", "tool.file: cannot read none.stl: there is no such file");
  refused(block + "--tool mesh none.stl", "--unit is missing: expected the unit of the mesh file's coordinates");
  refused(block + "--tool sphere 10mm --at 50x0mm", "moved straight down the tool never touches the body");
  refused("--body box 60x60x40mm --youngs-modulus 3 --poissons-ratio 0.4 --tool sphere 10mm --depth 2mm",
          "--youngs-modulus 3: expected a number with its unit");
  refused("--body box 60x60x4mm --youngs-modulus 3MPa --poissons-ratio 0.4 --tool sphere 10mm --depth 3mm",
          "--depth: more than half of the body's height");
  const std::string stl = touchstone::source_folder() + "/meshes/tools/mallet.stl";
  refused(block + "--tool mesh " + stl + " --unit m", "expected at most 10.0 m (tool.unit)");
  refused(
      "--body box 2x2x2mm --youngs-modulus 3MPa --poissons-ratio 0.4 --depth 0.2mm --tool mesh " + stl + " --unit in",
      "--unit: the mesh is");
  EXPECT_THAT(make(program, "none/a.toml " + block + "--tool sphere 10mm").output, HasSubstr("and there is no "));
  std::ofstream(dir_ / "there.toml") << "mine";
  const Answer answer = make(program, "there.toml " + block + "--tool sphere 10mm");
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.output, HasSubstr("there.toml: the file exists already"));
  EXPECT_EQ(text("there.toml"), "mine");
}

TEST(Help, WithoutArgumentsIsTheOverview) {
  for (const std::string& program : programs()) {
    const Answer alone = run(program);
    EXPECT_EQ(alone.exit_code, 0);
    EXPECT_EQ(alone.output, run(program + " --help").output);
    EXPECT_THAT(alone.output, HasSubstr("\n  new "));
    EXPECT_THAT(alone.output, HasSubstr("COMMAND --help"));
  }
}

/// All commands and subcommands, as the help lists them.
std::vector<std::string> all_verbs(const std::string& program) {
  std::vector<std::string> list;
  std::istringstream in(run(program).output);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("  ") && line.size() > 2 && std::islower(line[2]) && !line.starts_with("  touchstone"))
      list.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return list;
}

TEST(Help, EveryVerbHasAnExampleOfItsOwn) {
  for (const std::string& program : programs()) {
    const std::vector<std::string> list = all_verbs(program);
    EXPECT_GE(list.size(), program.ends_with("-fast") ? 6u : 14u);
    const std::string name = std::filesystem::path(program).filename();
    for (const std::string& verb : list) {
      if (verb == "study") continue;
      const std::string help = run(program + " " + verb + " --help").output;
      const std::size_t at = help.find("Example:\n");
      ASSERT_NE(at, std::string::npos) << verb;
      EXPECT_THAT(help.substr(at), HasSubstr(name + " " + verb)) << verb;
    }
  }
}

TEST(Misspelt, VerbsAndOptionsGetTheNearestName) {
  for (const std::string& program : programs()) {
    const std::string name = std::filesystem::path(program).filename();
    const auto refused = [&](const std::string& arguments, const std::string& message) {
      const Answer answer = run(program + " " + arguments);
      EXPECT_EQ(answer.exit_code, 2) << arguments;
      EXPECT_EQ(answer.output, name + message + "\n");
    };
    refused("paln " + scene, ": unknown command \"paln\"; did you mean \"plan\"?");
    refused("plan " + scene + " --quite", " plan: unknown option --quite; did you mean \"--quiet\"?");
    refused("plan --quite", " plan: unknown option --quite; did you mean \"--quiet\"?");
    refused("fast " + scene + " --uot=x", " fast: unknown option --uot; did you mean \"--out\"?");
    refused("fast " + scene + " --zzzzzzzz", " fast: unknown option --zzzzzzzz; see " + name + " fast --help");
    refused(scene, ": expected a command before " + scene + ", such as: " + name + " plan " + scene);
    EXPECT_THAT(run(program + " zzzzzz").output, HasSubstr("unknown command \"zzzzzz\"; expected one of new, plan, "));
  }
  if (full_program().empty()) return;
  const Answer far = run(full_program() + " view out --set");
  EXPECT_EQ(far.output, "touchstone view: unknown option --set; see touchstone view --help\n") << "--help is not meant";
  const Answer nested = run(full_program() + " study expnd x.toml");
  EXPECT_EQ(nested.exit_code, 2);
  EXPECT_EQ(nested.output, "touchstone study: unknown command \"expnd\"; did you mean \"expand\"?\n");
}

TEST(Misspelt, AFileThatIsNotThereGetsTheNearestInItsFolder) {
  const std::string folder = touchstone::source_folder() + "/meshes/";
  for (const std::string& program : programs()) {
    const Answer answer = run(program + " plan " + folder + "scenes/ball-on-cube-pres.toml");
    EXPECT_EQ(answer.exit_code, 2);
    EXPECT_THAT(answer.output, HasSubstr("; did you mean \"" + folder + "scenes/ball-on-cube-press.toml\"?"));
    EXPECT_THAT(run(program + " plan " + folder + "sceens/x.toml").output,
                HasSubstr("; there is no folder " + folder + "sceens"));
    EXPECT_THAT(run(program + " plan " + folder + "scenes/quite-another.toml").output,
                HasSubstr("expected a TOML file of at most 4 MiB\n"));
    // Another extension.
    EXPECT_THAT(run(program + " plan " + folder + "scenes/hertz-sphere.tml").output,
                HasSubstr("; did you mean \"" + folder + "scenes/hertz-sphere.toml\"?"));
  }
}

TEST(WrongFile, IsCalledWhatItIsWithTheVerbThatTakesIt) {
  if (full_program().empty()) GTEST_SKIP() << "a build without the reference";
  const std::string source = touchstone::source_folder();
  const std::string sweep = source + "/meshes/studies/ball-on-cube-depth-and-place.toml";
  const std::string tuning = source + "/meshes/studies/ball-on-cube.toml";
  const std::string gates = source + "/tests/gates/hertz.toml";
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Answer answer = run(full_program() + " " + arguments);
    EXPECT_EQ(answer.exit_code, 2) << arguments;
    EXPECT_THAT(answer.output, HasSubstr(message));
    EXPECT_EQ(std::count(answer.output.begin(), answer.output.end(), '\n'), 1) << answer.output;
  };
  const std::string for_scene = "the command for it is: touchstone compare " + scene;
  refused("tune " + scene, "this is a scene, expected a tuning study; " + for_scene);
  refused("study expand " + scene, "this is a scene, expected a study of many cases; " + for_scene);
  refused("gate " + scene, "this is a scene");
  refused("tune " + sweep,
          "this is a study of many cases, expected a tuning study; the command for it is: touchstone "
          "study expand " +
              sweep);
  refused("study expand " + tuning, "this is a tuning study");
  refused("compare " + sweep, "this is a study of many cases, expected a scene");
  refused("compare " + tuning, "expected a scene; the command for it is: touchstone tune " + tuning);
  refused("compare " + gates, "this is a gate file, expected a scene; the command for it is: touchstone gate --gates " +
                                  source + "/tests/gates");
}

/// The words that bash offers in place of the last word, with the program's script.
std::set<std::string> offered(const std::string& program, const std::vector<std::string>& words,
                              const std::string& folder = "/") {
  const std::string name = std::filesystem::path(program).filename();
  std::string function = "_" + name, list;
  std::replace(function.begin(), function.end(), '-', '_');
  for (const std::string& word : words) list += " '" + word + "'";
  const Answer answer = run("cd " + folder + " && bash -c \"source <(" + program + " completion bash); COMP_WORDS=(" +
                            name + list + "); COMP_CWORD=" + std::to_string(words.size()) + "; " + function +
                            " 2>/dev/null; printf '%s\\\\n' \\\"\\${COMPREPLY[@]}\\\"\"");
  EXPECT_EQ(answer.exit_code, 0) << answer.output;
  std::set<std::string> out;
  std::istringstream in(answer.output);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) out.insert(line);
  }
  return out;
}

TEST(Completion, BashOffersVerbsOptionsKeysAndFiles) {
  using testing::Contains;
  using testing::ElementsAre;
  for (const std::string& program : programs()) {
    EXPECT_THAT(offered(program, {"pl"}), ElementsAre("plan"));
    const std::vector<std::string> verbs = all_verbs(program);
    for (const std::string& verb : verbs) EXPECT_THAT(offered(program, {""}), Contains(verb));
    EXPECT_THAT(offered(program, {"plan", "--q"}), ElementsAre("--quiet"));
    EXPECT_THAT(offered(program, {"plan", "--"}), testing::Not(Contains("--out")));
    EXPECT_THAT(offered(program, {"fast", "--"}), Contains("--out"));
    EXPECT_THAT(offered(program, {"fast", "--set", "fast.s_"}), ElementsAre("fast.s_c_m2="));
    EXPECT_THAT(offered(program, {"live", "--device", "h"}), ElementsAre("hand"));
    EXPECT_THAT(offered(program, {"live", "--device", "=", "h"}), ElementsAre("hand"));
    EXPECT_THAT(offered(program, {"completion", "z"}), ElementsAre("zsh"));
    const std::string source = touchstone::source_folder();
    EXPECT_THAT(offered(program, {"fast", "meshes/scenes/hertz"}, source),
                ElementsAre("meshes/scenes/hertz-sphere.toml"));
    // Scenes and folders, no other files.
    const std::set<std::string> places = offered(program, {"fast", ""}, source);
    EXPECT_THAT(places, Contains("meshes"));
    EXPECT_THAT(places, testing::Not(Contains("README.md")));
    EXPECT_THAT(run(program + " completion zsh").output, HasSubstr("#compdef "));
    EXPECT_EQ(run(program + " completion fish").exit_code, 2);
  }
  if (full_program().empty()) return;
  EXPECT_THAT(offered(full_program(), {"study", ""}), ElementsAre("--help", "collect", "expand", "run"));
  EXPECT_THAT(offered(full_program(), {"study", "run", "--in"}), ElementsAre("--index"));
  EXPECT_THAT(offered(full_program(), {"compare", "--level", ""}), ElementsAre());
}

TEST(ReferenceVerb, AStoreThatCannotBeIsRefusedInOneLine) {
  if (full_program().empty()) GTEST_SKIP() << "a build without the reference";
  const std::filesystem::path dir = std::filesystem::path(testing::TempDir()) / "no-store";
  std::filesystem::create_directories(dir);
  std::ofstream(dir / "file") << "x";
  for (const std::string verb : {"reference", "compare"}) {
    const Answer answer = run(full_program() + " " + verb + " " + scene + " --out " + (dir / "out").string() +
                              " --store " + (dir / "file" / "store").string());
    EXPECT_EQ(answer.exit_code, 2) << answer.output;
    EXPECT_THAT(answer.output, HasSubstr("--store " + (dir / "file" / "store").string()));
    EXPECT_THAT(answer.output, HasSubstr("expected a folder that can be written to"));
    EXPECT_EQ(std::count(answer.output.begin(), answer.output.end(), '\n'), 1) << answer.output;
  }
  std::filesystem::remove_all(dir);
}

TEST(CompareVerb, ParametersAreTheFastSidesAlone) {
  if (full_program().empty()) GTEST_SKIP() << "a build without the reference";
  const std::filesystem::path dir = std::filesystem::path(testing::TempDir()) / "compare-parameters";
  std::filesystem::remove_all(dir);
  std::filesystem::create_directories(dir);
  std::ofstream(dir / "tuned.toml") << "[contact]\nk1_n_per_m = 3.0e4\n[contact.friction]\nmu_D = 0.1\nK = 0.1\n"
                                       "beta = 0.9\n";
  const auto compared = [&](const std::string& name, const std::string& more) {
    const Answer answer = run(full_program() + " compare " + touchstone::source_folder() +
                              "/meshes/scenes/pin-on-cylinder.toml --quiet --level 1 --set compare.instants=3 --set "
                              "contact.friction.K=0.3 --set contact.friction.beta=1 --set contact.friction.mu_D=0.3 "
                              "--store " +
                              (dir / "store").string() + " --out " + (dir / name).string() + more);
    EXPECT_EQ(answer.exit_code, 0) << answer.output;
    std::ifstream file(dir / name / "summary.json");
    return nlohmann::json::parse(file);
  };
  const auto own = compared("own", ""), tuned = compared("tuned", " --parameters " + (dir / "tuned.toml").string());
  EXPECT_EQ(own["force.peak_reference_n"], tuned["force.peak_reference_n"]);
  EXPECT_GT(tuned["force.peak_fast_n"].get<double>(), 2.0 * own["force.peak_fast_n"].get<double>());
  const auto solved = std::count_if(std::filesystem::directory_iterator(dir / "store"), {},
                                    [](const auto& entry) { return entry.path().filename() != "response"; });
  EXPECT_EQ(solved, 1) << "the reference was solved for the tuned friction, too";
  std::filesystem::remove_all(dir);
}

TEST(StudyVerb, ExpandWarnsOfCasesWithoutContact) {
  if (full_program().empty()) GTEST_SKIP() << "a build without the reference";
  const std::filesystem::path dir = std::filesystem::path(testing::TempDir()) / "study-without-contact";
  std::filesystem::remove_all(dir);
  std::filesystem::create_directories(dir);
  std::ofstream(dir / "study.toml") << "scene = \"" << scene << "\"\nrun = \"fast\"\n[[axis]]\n"
                                    << "key = \"track[1].position_m[2]\"\nvalues = [0.065, 0.0701, 0.0702, 0.0703, "
                                       "0.0704]\n";
  const Answer answer =
      run(full_program() + " study expand " + (dir / "study.toml").string() + " --out " + (dir / "out").string());
  EXPECT_EQ(answer.exit_code, 0) << answer.output;
  EXPECT_THAT(answer.output, HasSubstr("warning: case 2 (track[1].position_m[2] = 0.0701): the tool never touches the "
                                       "body on this track; the least gap is 0.1 mm"));
  EXPECT_THAT(answer.output, testing::Not(HasSubstr("warning: case 5")));
  EXPECT_THAT(answer.output, HasSubstr("warning: 4 of 5 cases are without contact"));
  std::filesystem::remove_all(dir);
}

TEST(StudyVerb, TwoWorkersOverTheSameIndicesLeaveOneTable) {
  if (full_program().empty()) GTEST_SKIP() << "a build without the reference";
  const std::string study = full_program() + " study ";
  const std::filesystem::path dir = std::filesystem::path(testing::TempDir()) / "study-verb";
  std::filesystem::remove_all(dir);
  std::filesystem::create_directories(dir);
  std::ofstream(dir / "study.toml") << "scene = \"" << scene << "\"\nrun = \"fast\"\n[set]\nfast.triangles = 500\n"
                                    << "[[axis]]\nkey = \"fast.C_n\"\nvalues = [0.0, 0.1, 0.2]\n";
  const std::string folder = (dir / "out").string();

  const Answer expanded = run(study + "expand " + (dir / "study.toml").string() + " --out " + folder);
  EXPECT_EQ(expanded.exit_code, 0) << expanded.output;
  EXPECT_THAT(expanded.output, HasSubstr("3 cases in " + folder + "/manifest.json"));
  EXPECT_THAT(expanded.output, HasSubstr("seq 3 | "));
  const Answer missing = run(study + "collect " + folder);
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.output, HasSubstr("To run again: 1-3"));

  const std::string worker =
      "for i in 1 2 3; do " + study + "run " + folder + " --quiet --index $i || echo worker failed; done";
  const Answer raced = run("( " + worker + " ) & ( " + worker + " ); wait");
  EXPECT_EQ(raced.exit_code, 0);
  EXPECT_THAT(raced.output, testing::Not(HasSubstr("failed"))) << raced.output;
  for (const char* ended : {"case 1 of 3 (fast.C_n = 0.0) done", "case 2 of 3 (fast.C_n = 0.1) done",
                            "case 3 of 3 (fast.C_n = 0.2) done"}) {
    const std::size_t first = raced.output.find(ended);
    EXPECT_NE(first, std::string::npos) << raced.output;
    EXPECT_EQ(raced.output.find(ended, first + 1), std::string::npos) << "run twice:\n" << raced.output;
  }
  const Answer collected = run(study + "collect " + folder);
  EXPECT_EQ(collected.exit_code, 0) << collected.output;
  EXPECT_THAT(collected.output, HasSubstr("3 of 3 cases are done"));
  const Answer rerun = run(study + "run " + folder);
  EXPECT_EQ(rerun.exit_code, 0);
  EXPECT_EQ(rerun.output, "");
  const Answer outside = run(study + "run " + folder + " --index 4");
  EXPECT_EQ(outside.exit_code, 2);
  EXPECT_THAT(outside.output, HasSubstr("--index 4: expected a whole number in [1, 3]"));
  std::filesystem::remove_all(dir);
}

/// The program that has a command, with its path.
std::string program_of(const std::string& ending) {
  for (const std::string& verb : verbs()) {
    if (verb.ends_with(ending)) return verb.substr(0, verb.rfind(' '));
  }
  return "";
}

class InputOfAVerb : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(dir_ / "gates" / "x.toml"); }
  void TearDown() override { std::filesystem::remove_all(dir_); }
  const std::filesystem::path dir_ =
      std::filesystem::path(testing::TempDir()) / ("input-of-a-verb-" + std::to_string(getpid()));
};

TEST_F(InputOfAVerb, ThatIsAFolderIsBadInput) {
  const std::string program = program_of("/touchstone compare"), dir = dir_.string();
  if (program.empty()) GTEST_SKIP() << "built without the reference";
  for (const std::string& verb :
       {"study expand " + dir, "tune " + dir, "fast " + dir, "gate --gates " + dir + "/gates",
        "compare " + scene + " --parameters " + dir, "live " + scene + " --device replay --log " + dir}) {
    const Answer answer = run(program + " " + verb + " --out " + dir + "/out");
    EXPECT_EQ(answer.exit_code, 2) << verb << ": " << answer.output;
    EXPECT_THAT(answer.output, HasSubstr("it is a folder; expected ")) << verb;
    EXPECT_EQ(std::count(answer.output.begin(), answer.output.end(), '\n'), 1) << answer.output;
  }
}

TEST_F(InputOfAVerb, MayHaveANameThatIsNoText) {
  const std::string program = program_of("/touchstone-fast live"), dir = dir_.string();
  EXPECT_EQ(run(program + " live " + scene + " --device scripted --seconds 0.02 --out " + dir + "/a").exit_code, 0);
  std::filesystem::copy(dir_ / "a" / "live.csv", dir_ / "l\xff.csv");
  const Answer answer =
      run(program + " live " + scene + " --device replay --log " + dir + "/l\xff.csv --out " + dir + "/b");
  EXPECT_EQ(answer.exit_code, 0) << answer.output;
  EXPECT_TRUE(nlohmann::json::accept(std::ifstream(dir_ / "b" / "manifest.json")));
}

}  // namespace
