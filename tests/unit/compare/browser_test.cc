// The report as a reader sees it, in headless Chromium: with WebGL by software, and without any.
#include "compare/report.h"

#include "compare/figures.h"
#include "synthetic.h"
#include "temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>
#include <cstdio>

namespace touchstone::compare {
namespace {

using Json = nlohmann::json;

/// Looks at the page once it is loaded and leaves what it saw in an element.
constexpr const char* probe = R"(<script>//<![CDATA[
addEventListener('load', () => {
  const seen = { errors: [] };
  try {
    const viewer = document.getElementById('viewer');
    const part = (name) => viewer.querySelector(`[data-part="${name}"]`);
    seen.viewer = !viewer.hidden;
    seen.sentence = !document.getElementById('viewer-still').hidden;
    seen.stills = [...document.querySelectorAll('figure svg title')].map((title) => title.textContent);
    const look = () => {
      const canvas = part('canvas').querySelector('canvas');
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [canvas.width, canvas.height];
      const context = copy.getContext('2d');
      context.drawImage(canvas, 0, 0);
      const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
      const cursor = part('chart').querySelector('line.cursor');
      return { colours: new Set(pixels).size, sum: pixels.reduce((a, b) => (a * 31 + b) % 4294967291, 7),
               words: part('words').textContent, bar: part('bar-name').textContent, cursor: cursor.getAttribute('x1'),
               most: part('bar-numbers').lastElementChild.textContent,
               points: Array.from(viewer.bodies.fast.getPoints().getData()),
               colours_of_points: Array.from(viewer.bodies.fast.getPointData().getScalars().getData()) };
    };
    const set = (name, value, event) => {
      part(name).value = value;
      part(name).dispatchEvent(new Event(event));
      return look();
    };
    if (seen.viewer) {
      seen.looks = { first: set('instant', 0, 'input'), last: set('instant', 4, 'input'), again: set('instant', 4, 'input'),
                     error: set('colour', 'error', 'change'), fast: set('side', 'fast', 'change') };
      const box = part('chart').querySelector('svg').getBoundingClientRect();
      part('chart').dispatchEvent(new PointerEvent('pointerdown', { clientX: box.left + 1 }));
      seen.looks.clicked = look();
    }
  } catch (error) {
    seen.errors.push(String(error));
  }
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
});
//]]></script>)";

std::string output_of(const std::string& command) {
  std::string out;
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[65536];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  EXPECT_EQ(WEXITSTATUS(pclose(pipe)), 0) << command;
  return out;
}

/// What the probe saw of the report, which must show no error and say nothing on the console.
Json visit(const std::string& webgl) {
  const testing::Sides sides = testing::pressed(5, 600);
  const Errors errors = compute_errors(sides.scene, sides.run, sides.result);
  const scene::Figures figures = make_figures(errors, sides.run, sides.result);
  std::string html = report_html({sides.scene, sides.run, sides.result, errors, figures, sides.plans, sides.manifest});
  html.insert(html.rfind("</body>"), probe);
  const testing::TemporaryFolder folder;
  const std::string at = folder.path().string();
  scene::write_file(folder.path() / "report.html", html);
  const std::string dom = output_of("HOME='" + at +
                                    "' chromium --headless=new --no-sandbox --disable-dev-shm-usage "
                                    "--enable-logging=stderr --window-size=1200,1000 --virtual-time-budget=20000 " +
                                    webgl + " --user-data-dir='" + at + "/profile' --dump-dom 'file://" + at +
                                    "/report.html' 2>'" + at + "/log'");
  const std::string log = scene::read_file(folder.path() / "log").value_or("");
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(line.find("CONSOLE"), std::string::npos) << line;
  }
  const std::string opening = "<pre id=\"seen\">";
  const std::size_t from = dom.rfind(opening);
  if (from == std::string::npos) {
    ADD_FAILURE() << "the page did not get to its end\n" << log;
    return {};
  }
  const std::size_t begin = from + opening.size();
  const Json seen = Json::parse(dom.substr(begin, dom.find("</pre>", begin) - begin));
  EXPECT_EQ(seen["errors"], Json::array());
  return seen;
}

TEST(ReportInChromium, ShowsBothBodiesAndFollowsTheSlider) {
  const Json page = visit("--use-angle=swiftshader --enable-unsafe-swiftshader");
  ASSERT_TRUE(page["viewer"]);
  EXPECT_FALSE(page["sentence"]);
  const Json& looks = page["looks"];
  for (const auto& [name, look] : looks.items()) EXPECT_GT(look["colours"], 50) << name << " is nearly blank";
  EXPECT_NE(looks["first"]["sum"], looks["last"]["sum"]);
  EXPECT_EQ(looks["again"]["sum"], looks["last"]["sum"]) << "the same instant is not the same picture";
  EXPECT_NE(looks["error"]["sum"], looks["last"]["sum"]);
  EXPECT_NE(looks["fast"]["sum"], looks["error"]["sum"]);
  EXPECT_NE(looks["first"]["words"], looks["last"]["words"]);
  EXPECT_LT(std::stod(looks["first"]["cursor"].get<std::string>()),
            std::stod(looks["last"]["cursor"].get<std::string>()));
  // A press on the curve's left end goes to the first instant.
  EXPECT_EQ(looks["clicked"]["cursor"], looks["first"]["cursor"]);
  EXPECT_THAT(looks["last"]["bar"].get<std::string>(), ::testing::StartsWith("displacement [mm]"));
  EXPECT_THAT(looks["error"]["bar"].get<std::string>(), ::testing::HasSubstr("points [mm]"));
  const testing::Sides sides = testing::pressed(5, 600);
  const double most_mm = 1e3 * sides.result.instants[4].displacement_m.colwise().norm().maxCoeff();
  EXPECT_NEAR(std::stod(looks["last"]["most"].get<std::string>()), most_mm, 0.005 * most_mm);
}

/// Of one vertex.
Eigen::Vector3d column(const Json& values, Eigen::Index vertex) {
  const auto first = static_cast<std::size_t>(3 * vertex);
  const auto at = [&](std::size_t axis) { return values.at(first + axis).get<double>(); };
  return {at(0), at(1), at(2)};
}

TEST(ReportInChromium, MovesAndColoursEveryVertex) {
  const Json page = visit("--use-angle=swiftshader --enable-unsafe-swiftshader");
  const testing::Sides sides = testing::pressed(5, 600);
  const Eigen::Matrix3Xd& fast_m = sides.run.instants[4].displacement_m;
  const Eigen::VectorXd error_m = (fast_m - sides.result.instants[4].displacement_m).colwise().norm().transpose();
  const Json &last = page["looks"]["last"], &error = page["looks"]["error"];
  ASSERT_EQ(last["points"].size(), static_cast<std::size_t>(fast_m.size()));
  Eigen::Index most = 0, least = 0;
  error_m.maxCoeff(&most);
  error_m.minCoeff(&least);
  ASSERT_LT(error_m[least], 0.01 * error_m[most]);
  for (Eigen::Index i = 0; i < fast_m.cols(); ++i) {
    EXPECT_LT((column(last["points"], i) - sides.run.surface.points_m.col(i) - fast_m.col(i)).norm(), 1e-7) << i;
    EXPECT_EQ(column(error["points"], i), column(last["points"], i)) << i;
    // Magma backwards: light where there is no error, ever darker from there.
    const double brightness = column(error["colours_of_points"], i).sum();
    EXPECT_LE(brightness, column(error["colours_of_points"], least).sum()) << i;
    EXPECT_GE(brightness, column(error["colours_of_points"], most).sum()) << i;
    for (Eigen::Index k = 0; k < i; ++k) {
      if (error_m[k] < error_m[i] - 0.02 * error_m[most]) {
        EXPECT_GT(column(error["colours_of_points"], k).sum(), brightness) << k << ' ' << i;
      }
    }
  }
}

TEST(ReportInChromium, LeavesTheStillPictureWithoutWebGl) {
  const Json page = visit("--disable-3d-apis --disable-gpu");
  EXPECT_FALSE(page["viewer"]);
  EXPECT_TRUE(page["sentence"]);
  EXPECT_THAT(page["stills"].get<std::vector<std::string>>(),
              ::testing::Contains("Both deformed bodies, cut in half, and the error between them"));
}

}  // namespace
}  // namespace touchstone::compare
