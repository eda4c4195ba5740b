// Input: files that are no regular files, texts with control characters, thousands of faults.
#include "scene/base/input.h"

#include "scene/base/error.h"
#include "scene/base/json_text.h"
#include "scene/base/text.h"
#include "scene/input/fields.h"
#include "scene/input/scene_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <random>

namespace touchstone::scene {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string body =
    "[body]\nshape = \"box\"\nsize_m = [0.06, 0.06, 0.06]\n"
    "material = { youngs_modulus_pa = 3.0e6, poissons_ratio = 0.5 }\n";
const std::string ball = "[tool]\nshape = \"sphere\"\nradius_m = 0.010\n";
const std::string law = "[contact]\nk1_n_per_m = 40.0\nk3_n_per_m3 = 3.0e8\n";

std::string row(const std::string& time_s, const std::string& rest = "position_m = [0.0, 0.0, 0.08]") {
  return "[[track]]\ntime_s = " + time_s + "\n" + rest + "\n";
}
const std::string good = body + ball + law + row("0.0") + row("1.0");

/// The message with which a scene is refused, in at most twenty seconds, under sanitizers too.
std::string refusal(const std::string& text, const std::filesystem::path& file = "a.toml",
                    const std::vector<std::string>& overrides = {}) {
  const std::clock_t begin = std::clock();  // of the processor: the machine may be busy
  std::string told = "accepted";
  try {
    (void)parse_scene(text, file, overrides);
  } catch (const InputError& error) {
    told = error.what();
  }
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 20.0);
  EXPECT_LT(told.size(), 100'000u);
  return told;
}

class InputFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("touchstone-input-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  std::filesystem::path folder_;
};

TEST_F(InputFile, IsReadWhole) {
  const std::string bytes("a\0b\r\n\xff", 6);
  const Input input = read_input(write("f", bytes), toml_input);
  EXPECT_EQ(input.fault, "");
  EXPECT_EQ(input.bytes, bytes);
  EXPECT_EQ(read_input(write("empty", ""), toml_input).fault, "");
}

TEST_F(InputFile, IsRefusedUnlessOrdinary) {
  const auto fault = [](const std::filesystem::path& path) { return read_input(path, toml_input).fault; };
  const std::string expected = "; expected a TOML file of at most 4 MiB";
  EXPECT_EQ(fault(folder_), "it is a folder" + expected);
  EXPECT_EQ(fault(""), "there is no such file" + expected);
  // A pipe without a writer: waiting for it would hang.
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(fault(folder_ / "pipe"), "it is a pipe" + expected);
  EXPECT_EQ(fault("/dev/zero"), "it is a device" + expected);
  EXPECT_EQ(fault("/proc/self/environ"), "it is not a regular file" + expected);
  EXPECT_EQ(fault("/proc/self/mem"), "it is not a regular file" + expected);
  const int listening = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{AF_UNIX, {}};
  (folder_ / "socket").string().copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_THAT(fault(folder_ / "socket"), EndsWith(expected));
  ::close(listening);
  EXPECT_EQ(fault(write("named", "") + std::string("\0.toml", 6)), "its name holds a zero byte" + expected);
  write("scene.toml", "");
  EXPECT_THAT(fault(folder_ / "scenes.toml"), AllOf(StartsWith("there is no such file"), EndsWith("scene.toml\"?")));
  std::filesystem::create_symlink("loop", folder_ / "loop");
  EXPECT_THAT(fault(folder_ / "loop"), EndsWith(expected));
}

TEST_F(InputFile, IsRefusedWhenItIsTooLarge) {
  write("large", "");
  std::filesystem::resize_file(folder_ / "large", toml_input.bytes_max + 1);
  EXPECT_EQ(read_input(folder_ / "large", toml_input).fault,
            "it has 4194305 bytes; expected a TOML file of at most 4 MiB");
  EXPECT_EQ(read_input(folder_ / "large", table_input).fault, "");
}

TEST_F(InputFile, OfEveryKindIsOpenedTheSameWay) {
  const std::string folder = folder_.string();
  const auto told = [](const auto& load) {
    try {
      (void)load();
      return std::string("accepted");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(told([&] { return load_scene(folder_); }),
            folder + ": cannot read the scene: it is a folder; expected a TOML file of at most 4 MiB");
  const std::string file = (folder_ / "a.toml").string();
  for (const std::string included : {".", "/dev/zero", "/proc/self/environ"}) {
    EXPECT_THAT(refusal("include = \"" + included + "\"\n" + good, file),
                AllOf(StartsWith(file + ":1:11: include: cannot read "), HasSubstr("expected a TOML file")));
  }
  for (const std::string nothing : {"\"\"", "7", "[]"}) {
    EXPECT_THAT(refusal("include = " + nothing + "\n" + good, file),
                HasSubstr(":1:11: include = " + nothing + "; expected the path of a TOML file"));
  }
  const std::string mesh = "[tool]\nshape = \"mesh\"\nunit = \"mm\"\n";
  for (const std::string name : {".", "none.obj", "/proc/self/mem", "/dev/zero"}) {
    EXPECT_THAT(
        refusal(body + mesh + "file = \"" + name + "\"\n" + law + row("0.0") + row("1.0"), file),
        AllOf(StartsWith(file + ":8:8: tool.file: cannot read "), HasSubstr("STL, OBJ or PLY file of at most")));
  }
  EXPECT_THAT(refusal(body + ball + law + "[track]\nfile = \"none.csv\"\n", file),
              AllOf(StartsWith(file + ":12:8: track.file: cannot read "), HasSubstr("a CSV file of at most 256 MiB")));
}

TEST_F(InputFile, OfTheWrongKindIsNotShown) {
  write("secret", "root:$6$salt$hash:19000:0:99999:7:::\n");
  const std::string told = refusal(body + ball + law + "[track]\nfile = \"secret\"\n", folder_ / "a.toml");
  EXPECT_THAT(told, AllOf(HasSubstr("unknown or repeated column that is not a plain name"), Not(HasSubstr("salt"))));
  write("named", "time_s,x_m,y_m,height\n");
  EXPECT_THAT(refusal(body + ball + law + "[track]\nfile = \"named\"\n", folder_ / "a.toml"),
              HasSubstr("unknown or repeated column \"height\""));
}

TEST(Text, IsShownWithoutWhatATerminalActsOn) {
  EXPECT_EQ(visible("a\x1b[31m\n\t\r\x7f"), "a\\u001b[31m\\n\\t\\r\\u007f");
  EXPECT_EQ(visible(std::string("\0", 1)), "\\u0000");
  EXPECT_EQ(visible("\xc2\x9b"
                    "31m"),
            "\\u009b31m");  // a control sequence in one character
  EXPECT_EQ(visible("l\xff.csv \xc3"), "l\\xff.csv \\xc3");
  EXPECT_EQ(visible("\xc0\x80 \xed\xa0\x80 \xf4\x90\x80\x80"), "\\xc0\\x80 \\xed\\xa0\\x80 \\xf4\\x90\\x80\\x80");
  EXPECT_EQ(visible("größe 接触 🙂"), "größe 接触 🙂");
  EXPECT_EQ(Fault({"a\x1b.toml", 1, 2, "unknown key \"\x1b[2J\""}).text(),
            "a\\u001b.toml:1:2: unknown key \"\\u001b[2J\"");
}

TEST(Text, IsCutWhereItIsLong) {
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "abc... (4 bytes)");
  EXPECT_EQ(shortened("aß", 2), "a... (3 bytes)");
  EXPECT_LT(Fault({"", 0, 0, std::string(100'000, 'x')}).text().size(), 2100u);
}

TEST(Text, JsonTakesAnyBytes) {
  EXPECT_EQ(json_text(nlohmann::ordered_json{{"log", "l\xff.csv"}}), "{\n  \"log\": \"l\xef\xbf\xbd.csv\"\n}\n");
}

TEST(ManyFaults, AreShownUpToANumber) {
  std::vector<Fault> faults;
  for (int i = 0; i < 1000; ++i) faults.push_back({"a.toml", i + 1, 0, "wrong"});
  const InputError error(faults);
  const std::string told = error.what();
  EXPECT_EQ(error.faults().size(), 1000u);
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 40);
  EXPECT_THAT(told, EndsWith("a.toml:40: wrong\nand 960 more faults"));
}

TEST(ManyFaults, TakeNoTime) {
  std::string keys;
  for (int i = 0; i < 200'000; ++i) keys += "k" + std::to_string(i) + " = 1\n";
  EXPECT_THAT(refusal(keys + good), AllOf(HasSubstr("did you mean"), EndsWith("and 199960 more faults")));
  EXPECT_THAT(refusal(std::string(100'000, 'k') + " = 1\n" + good),
              AllOf(HasSubstr("kkk... (100000 bytes)\"; no key is that long"), Not(HasSubstr("did you mean"))));
  std::string inclusions;
  for (int i = 0; i < 1000; ++i) {
    inclusions +=
        "[[body.inclusion]]\nshape = \"sphere\"\nradius_m = 0.01\ncenter_m = [0.0, 0.0, 0.03]\n"
        "material = { youngs_modulus_pa = 1.0e6, poissons_ratio = 0.5 }\n";
  }
  EXPECT_THAT(refusal(good + inclusions), AllOf(HasSubstr("at most 16 inclusions, found 1000"), Not(HasSubstr("\n"))));
  std::string list = "[0.0";
  for (int i = 0; i < 100'000; ++i) list += ", 0.0";
  EXPECT_LT(refusal(good + "[live]\nrelease_s = " + list + "]\n").size(), 500u);
}

TEST(TomlText, IsRefusedBeforeTheParserWhereItWouldFail) {
  EXPECT_EQ(refusal(std::string("[\0", 2)), "a.toml:1:2: not valid TOML: a zero byte");
  EXPECT_EQ(refusal("a = 1\xca\xa2"),
            "a.toml:1:6: not valid TOML: a character that is not ASCII, outside of quotes and "
            "comments");
  EXPECT_EQ(refusal("a = 1\n# \xff"), "a.toml:2:3: not valid TOML: a byte that is not UTF-8");
  std::string deep = "a";
  for (int i = 0; i < 500'000; ++i) deep += ".a";
  EXPECT_THAT(refusal(deep + " = 1"), HasSubstr("a key of more than 16 parts"));
  EXPECT_THAT(refusal("[" + deep + "]"), HasSubstr("a key of more than 16 parts"));
  EXPECT_THAT(refusal(std::string(100'000, '[')), HasSubstr("not valid TOML"));
  EXPECT_THAT(refusal(good, "a.toml", {std::string("fast.C_n=\0", 10)}), HasSubstr("a zero byte"));
}

TEST(TomlText, MayHoldAnyCharacterInQuotesAndComments) {
  for (const std::string title :
       {"\"größe \\\" ß\"", "'ß\\'", "\"\"\"ß\"\" \\\"\"\" ß\"\"\"\"\"", "'''ß'' ß'''", "\"\" # ß"}) {
    EXPECT_EQ(refusal("\xef\xbb\xbf"
                      "title = " +
                      title + " # ß ' \"\n" + good),
              "accepted")
        << title;
  }
  EXPECT_EQ(parse_scene(good, "a.toml", {"title=Größe"}).title, "Größe");
}

TEST(SceneText, WithControlCharactersIsRefused) {
  for (const std::string escape : {"\\u0000", "\\u001b", "\\u007f", "\\u009b", "\\r"}) {
    EXPECT_THAT(refusal("title = \"a" + escape + "b\"\n" + good),
                AllOf(StartsWith("a.toml:1:9: title = "), HasSubstr("expected a text without control characters")));
  }
  const std::string mesh = "[tool]\nshape = \"mesh\"\nunit = \"mm\"\nfile = \"\"\n";
  EXPECT_EQ(refusal(body + mesh + law + row("0.0") + row("1.0")),
            "a.toml:8:8: tool.file = \"\"; expected a text, not empty, without control characters");
}

/// Any plain text: letters, quotes, backslashes, line feeds, characters from all of Unicode.
std::string any_text(std::mt19937& random) {
  std::string text;
  const int length = std::uniform_int_distribution(0, 20)(random);
  while (static_cast<int>(text.size()) < length) {
    const unsigned kind = random() % 4;
    const unsigned point = kind == 0   ? 0x20 + random() % 0x5f
                           : kind == 1 ? static_cast<unsigned>("\n\t\"\\'#"[random() % 6])
                           : kind == 2 ? 0xa0 + random() % 0x700
                                       : 0x10000 + random() % 0x1000;
    if (point < 0x80) {
      text += static_cast<char>(point);
    } else if (point < 0x800) {
      text += {static_cast<char>(0xc0 | point >> 6), static_cast<char>(0x80 | (point & 0x3f))};
    } else {
      text += {static_cast<char>(0xf0 | point >> 18), static_cast<char>(0x80 | (point >> 12 & 0x3f)),
               static_cast<char>(0x80 | (point >> 6 & 0x3f)), static_cast<char>(0x80 | (point & 0x3f))};
    }
  }
  return text;
}

TEST(ResolvedScene, OfRandomScenesLoadsToTheSameScene) {
  std::mt19937 random(7);
  const auto number = [&](double low, double high) {
    return number_text(std::uniform_real_distribution(low, high)(random));
  };
  const auto pick = [&](const std::vector<std::string>& all) { return all[random() % all.size()]; };
  for (int trial = 0; trial < 300; ++trial) {
    std::string text = "title = " + toml_quoted(any_text(random)) + "\n[body]\n";
    text += pick(
        {"shape = \"box\"\nsize_m = [0.06, " + number(0.05, 0.07) + ", 0.06]\n",
         "shape = \"sphere\"\nradius_m = " + number(0.03, 0.04) + "\nsupport_height_m = 0.002\n",
         "shape = \"ellipsoid\"\nsemi_axes_m = [0.03, 0.04, " + number(0.03, 0.04) + "]\nsupport_height_m = 0.002\n"});
    text += "material = { youngs_modulus_pa = " + number(1e5, 1e7) + ", poissons_ratio = " + number(0.0, 0.5) + " }\n";
    if (random() % 2 == 0) {
      text += "[[body.inclusion]]\nshape = \"sphere\"\nradius_m = " + number(0.001, 0.005) +
              "\ncenter_m = [0.0, 0.0, 0.03]\nmaterial = { youngs_modulus_pa = 1e5, poissons_ratio = 0.3 }\n";
    }
    text += "[tool]\n" + pick({"shape = \"sphere\"\n", "shape = \"capsule\"\nlength_m = 0.01\n",
                               "shape = \"cylinder\"\nlength_m = 0.02\nedge_radius_m = 0.001\n"});
    text += "radius_m = " + number(0.002, 0.01) + "\n";
    if (random() % 2 == 0) text += "mass_center_m = [0.0, " + number(-0.001, 0.001) + ", 0.0]\n";
    text += "[contact]\n" + pick({"k1_n_per_m = " + number(1.0, 100.0),
                                  "law = \"area_aware\"\nk1_per_radius_n_per_m2 = " + number(1.0, 1e6)});
    text += "\nk3_n_per_m3 = " + number(1.0, 1e9) + "\n";
    if (random() % 2 == 0) text += "friction = { K = 0.5, beta = " + number(0.67, 1.0) + ", mu_D = 0.1 }\n";
    for (int i = 0; i < 3; ++i) {
      text += row(std::to_string(i) + ".5", "orientation_wxyz = [1.0, " + number(-1.0, 1.0) + ", " + number(-1.0, 1.0) +
                                                ", " + number(-0.5, 0.5) + "]\n" +
                                                pick({"position_m = [0.0, 0.001, " + number(0.15, 0.2) + "]",
                                                      "position_m = [0.0, 0.001]\ndepth_m = " + number(-0.01, 0.0)}));
    }
    const Scene scene = parse_scene(text, "a.toml");
    const std::string resolved = resolved_toml(scene);
    const Scene again = parse_scene(resolved, "a.toml");
    EXPECT_EQ(again.title, scene.title);
    EXPECT_EQ(scene_hash(again), scene_hash(scene));
    EXPECT_EQ(resolved_toml(again), resolved);
    EXPECT_EQ(parse_scene(explained_toml(scene), "a.toml").title, scene.title);
  }
}

TEST_F(InputFile, GivesPosesInTheSameRangesFromRowsAndTables) {
  struct Case {
    std::string time_s, z_m, q, fault;
  };
  const std::string norm = "expected four numbers of a norm in [0.5, 2], each in [-2, 2]";
  for (const Case& one : std::vector<Case>{{"1e300", "0.07", "1,0,0,0", "expected a number in [-100000, 100000] s"},
                                           {"1e6", "0.07", "1,0,0,0", "expected a number in [-100000, 100000] s"},
                                           {"1", "1e300", "1,0,0,0", "each in [-1000, 1000] m"},
                                           {"1", "1e4", "1,0,0,0", "each in [-1000, 1000] m"},
                                           {"1", "nan", "1,0,0,0", "each in [-1000, 1000] m"},
                                           {"1", "0.07", "1e200,0,0,0", norm},
                                           {"1", "0.07", "2e-162,1e-162,0,0", norm},
                                           {"1", "0.07", "0.4,0,0,0", norm},
                                           {"1", "0.07", "2,2,0,0", norm},
                                           {"1", "0.07", "0,0,0,0", norm},
                                           {"1", "0.07", "0.5,0,0,0", "accepted"}}) {
    std::string list = one.q;
    for (std::size_t at = 0; (at = list.find(',', at)) != std::string::npos; at += 2) list.replace(at, 1, ", ");
    EXPECT_THAT(refusal(body + ball + law + row("0.0") +
                        row(one.time_s, "position_m = [0.0, 0.0, " + one.z_m + "]\norientation_wxyz = [" + list + "]")),
                HasSubstr(one.fault))
        << one.q;
    write("t.csv",
          "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.08,1,0,0,0\n" + one.time_s + ",0,0," + one.z_m + "," + one.q + "\n");
    const std::string told = refusal(body + ball + law + "[track]\nfile = \"t.csv\"\n", (folder_ / "a.toml").string());
    if (one.fault == "accepted") {
      EXPECT_EQ(told, one.fault);
    } else {
      EXPECT_THAT(told, AllOf(StartsWith((folder_ / "t.csv").string() + ":3:"), HasSubstr("expected")));
      EXPECT_THAT(told, HasSubstr(one.fault == norm && one.q[0] != '1' ? "norm in [0.5, 2]" : "number"));
    }
  }
  EXPECT_THAT(refusal(body + ball + law + row("0.0") + row("1.0", "position_m = [0.0, 0.0]\ndepth_m = -1000.0")),
              AllOf(HasSubstr("a.toml:17:11: track[1].depth_m: leads to a position"), HasSubstr("[-1000, 1000] m")));
}

TEST(Records, OfTooManyTrianglesAreRefused) {
  const std::string track = row("0.0") + row("1.0"), records = "[compare]\ninstants = ";
  EXPECT_EQ(refusal(body + ball + law + track + records + "100\n[fast]\ntriangles = 100000\n"), "accepted");
  EXPECT_THAT(refusal(body + ball + law + track + records + "101\n[fast]\ntriangles = 100000\n"),
              HasSubstr("compare.instants: 101 records of 100000 triangles (fast.triangles); expected at most 100 "
                        "records of as many"));
  EXPECT_THAT(refusal(body + ball + law + track + "[fast]\ntriangles = 100001\n"),
              HasSubstr("fast.triangles = 100001; expected a whole number in [12, 100000]"));
}

TEST(Track, OfTooManyTicksIsRefused) {
  EXPECT_EQ(refusal(body + ball + law + row("0.0") + row("1e5")), "accepted");
  EXPECT_THAT(refusal(body + ball + law + row("-10.0") + row("1e5")),
              HasSubstr("track: takes 1e+08 ticks at fast.rate_hz = 1000 Hz; expected at most 1e+08"));
}

}  // namespace
}  // namespace touchstone::scene
