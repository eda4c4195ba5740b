// The report in headless Chromium: with WebGL in software, and without WebGL.
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace touchstone::compare {
namespace {

using Json = nlohmann::json;

/// Inspects the loaded page, uses it as a reader would, and writes what it found to an element.
constexpr const char* probe = R"(<script>//<![CDATA[
const seen = { errors: [] };
const viewer = document.getElementById('viewer');
const part = (name) => viewer.querySelector(`[data-part="${name}"]`);
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
Element.prototype.setPointerCapture = Element.prototype.releasePointerCapture = () => {};  // no real pointer
addEventListener('error', (event) => seen.errors.push(event.message));

const rgb = (element, property) => getComputedStyle(element).getPropertyValue(property).match(/[\d.]+/g).map(Number);
const pixels = (canvas) => {
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  return context.getImageData(0, 0, copy.width, copy.height);
};
const sum = (numbers) => new Uint32Array(numbers.buffer).reduce((a, b) => (a * 31 + b) % 4294967291, 7);
const shown = ['reference', 'fast'];

/// For each side's picture: the body's box in it, from 0 to 1, and a number that changes with the picture.
const sides = () => {
  const image = pixels(part('canvas').querySelector('canvas'));
  const names = shown.map((name) => part(`name-${name}`)).filter((label) => !label.hidden);
  const corners = names.map((label) => [parseFloat(label.style.left) / 100, parseFloat(label.style.top) / 100]);
  const share = [0, 1].map((axis) => (corners.some((corner) => corner[axis] > 0) ? 0.5 : 1));
  const back = rgb(part('stage'), 'background-color');
  return corners.map((corner) => {
    const size = [image.width, image.height].map((all, axis) => Math.floor(all * share[axis]));
    const from = [Math.ceil(corner[0] * image.width), Math.ceil(corner[1] * image.height)];
    const box = { left: 1, right: 0, top: 1, bottom: 0 };
    let mark = 7;
    for (let y = 0; y < size[1]; ++y) {
      for (let x = 0; x < size[0]; ++x) {
        const at = 4 * ((from[1] + y) * image.width + from[0] + x);
        const away = [0, 1, 2].map((i) => Math.abs(image.data[at + i] - back[i]));
        mark = (mark * 31 + away[0] + 256 * away[1] + 65536 * away[2]) % 4294967291;
        if (Math.max(...away) <= 2) continue;
        box.left = Math.min(box.left, x / size[0]);
        box.right = Math.max(box.right, (x + 1) / size[0]);
        box.top = Math.min(box.top, y / size[1]);
        box.bottom = Math.max(box.bottom, (y + 1) / size[1]);
      }
    }
    return { ...box, mark, size };
  });
};
const look = () => {
  const image = pixels(part('canvas').querySelector('canvas'));
  const cursor = part('chart').querySelector('line.cursor');
  return { colours: new Set(new Uint32Array(image.data.buffer)).size, sum: sum(image.data),
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
const key = (target, name) => target.dispatchEvent(
  new KeyboardEvent('keydown', { key: name, bubbles: true, cancelable: true }));
const rollWheel = () => {
  const event = new WheelEvent('wheel', { deltaY: 100, bubbles: true, cancelable: true });
  part('canvas').querySelector('canvas').dispatchEvent(event);
  return { taken: event.defaultPrevented, zoom: viewer.camera.getParallelScale(),
           touch: getComputedStyle(part('canvas')).touchAction };
};
const place = () => [...viewer.camera.getPosition()];
const playing = () => ({ button: part('play').textContent, instant: Number(part('instant').value) });

const keys = () => {
  set('instant', 4, 'input');
  const canvas = part('canvas');
  const pressed = {};
  const press = (name) => {
    const taken = !key(canvas, name);
    pressed[name] = { taken, place: place(), zoom: viewer.camera.getParallelScale(), sides: sides() };
  };
  pressed.before = { place: place(), zoom: viewer.camera.getParallelScale(), sides: sides() };
  pressed.elsewhere = { taken: !key(document.body, 'ArrowLeft') || !key(part('instant'), 'ArrowLeft'), place: place() };
  canvas.focus();
  for (const name of ['ArrowLeft', 'Home', 'ArrowRight', 'ArrowUp', 'ArrowDown', '+', '-', 'x']) press(name);
  const before = sum(pixels(canvas.querySelector('canvas')).data);
  canvas.dispatchEvent(new KeyboardEvent('keypress', { key: 'w', bubbles: true, cancelable: true }));
  pressed.letter = before === sum(pixels(canvas.querySelector('canvas')).data);
  press('Home');
  press('Escape');
  pressed.left = document.activeElement !== canvas;
  return pressed;
};

const play = async () => {
  set('instant', 0, 'input');
  const seen = { first: playing() };
  key(part('canvas'), ' ');
  seen.started = playing();
  await wait(700);
  seen.going = playing();
  part('play').click();
  seen.paused = playing();
  await wait(1500);
  seen.still = playing();
  part('play').click();
  await wait(9000);
  seen.ended = playing();
  part('play').click();
  seen.again = playing();
  part('play').click();
  return seen;
};

const save = async () => {
  const seen = {};
  const click = HTMLAnchorElement.prototype.click;
  HTMLAnchorElement.prototype.click = function () { seen.name = this.download, seen.type = this.href.slice(0, 22),
                                                    seen.href = this.href; };
  set('instant', 2, 'input');
  const before = sides();
  part('save').click();
  HTMLAnchorElement.prototype.click = click;
  seen.unchanged = JSON.stringify(before) === JSON.stringify(sides());
  const image = new Image();
  image.src = seen.href;
  delete seen.href;
  await new Promise((done) => image.addEventListener('load', done));
  seen.size = [image.width, image.height];
  seen.canvas = [part('canvas').clientWidth, part('canvas').clientHeight];
  const data = pixels(image);
  // Rows of the colour bar, below the picture, and of the picture itself.
  const row = Math.round(image.width / seen.canvas[0] * (seen.canvas[1] + 18));
  const colours = (from, to) => new Set(new Uint32Array(data.data.buffer).slice(from * image.width, to * image.width));
  seen.bar_colours = colours(row, row + 1).size;
  seen.picture_colours = colours(0, 2 * seen.canvas[1]).size;
  return seen;
};

/// The drawn scale: its text and its length in pixels of the picture; and the body's width.
const scale = () => {
  set('instant', 0, 'input');
  part('tool').checked = false;
  set('side', 'fast', 'change');
  const image = pixels(part('marks'));
  let longest = 0;
  for (let y = Math.floor(0.5 * image.height); y < image.height; ++y) {
    let length = 0;
    for (let x = 0; x < image.width; ++x) {
      length = image.data[4 * (y * image.width + x) + 3] > 200 ? length + 1 : 0;
      longest = Math.max(longest, length);
    }
  }
  const [side] = sides();
  const found = { text: part('marks').getAttribute('aria-label'), length_px: longest,
                  body_px: (side.right - side.left) * side.size[0] };
  part('tool').checked = true;
  set('side', 'both', 'change');
  return found;
};

const colours = () => {
  const ink = pixels(part('marks')).data;
  const darkest = [255, 255, 255];
  for (let i = 0; i < ink.length; i += 4) {
    if (ink[i + 3] === 255) for (let k = 0; k < 3; ++k) darkest[k] = Math.min(darkest[k], ink[i + k]);
  }
  const ends = JSON.parse(document.getElementById('viewer-data').textContent).colours;
  return { dark: matchMedia('(prefers-color-scheme: dark)').matches, page: rgb(document.body, 'background-color'),
           stage: rgb(part('stage'), 'background-color'), marks: darkest, panel: rgb(viewer, 'background-color'),
           words: rgb(part('words'), 'color'), bar: rgb(part('bar-name'), 'color'), keys: rgb(part('keys'), 'color'),
           numbers: rgb(part('bar-numbers'), 'color'),
           names: shown.map((name) => rgb(part(`name-${name}`), 'color')),
           maps: Object.values(ends).map((table) => [table[0], table[table.length - 1]]) };
};

/// In print: which texts about the three-dimensional view, and which pictures, are present.
const print = () => {
  for (const sheet of document.styleSheets) {
    for (const rule of sheet.cssRules) if (rule.media && rule.media.mediaText === 'print') rule.media.mediaText = 'all';
  }
  const there = (element) => element.getClientRects().length > 0;
  return { headings: [...document.querySelectorAll('h1, h2, h3')].filter(there).map((h) => h.textContent),
           sentence: there(document.getElementById('viewer-still')), viewer: there(viewer),
           stills: [...document.querySelectorAll('figure > svg > title, .bodies > svg > title')].filter((title) => there(title.parentElement))
             .map((title) => title.textContent) };
};

const wheel = () => {
  const found = { before: rollWheel() };
  part('canvas').focus();
  found.focused = rollWheel();
  part('canvas').blur();
  found.after = rollWheel();
  return found;
};

const fits = () => {
  set('side', 'reference', 'change');
  const alone = sides();
  set('side', 'both', 'change');
  return { alone, both: sides() };
};

const looks = () => {
  const found = { first: set('instant', 0, 'input'), last: set('instant', 4, 'input'), again: set('instant', 4, 'input'),
                  error: set('colour', 'error', 'change'), fast: set('side', 'fast', 'change') };
  const box = part('chart').querySelector('svg').getBoundingClientRect();
  part('chart').dispatchEvent(new PointerEvent('pointerdown', { clientX: box.left + 1 }));
  return { ...found, clicked: look() };
};

/// Values beside the pointer, without delay.
const tips = () => {
  const mark = document.querySelector('figure circle[aria-label]');
  const at = mark.getBoundingClientRect(), figure = mark.closest('figure');
  const point = (x, y) => {
    figure.dispatchEvent(new PointerEvent('pointermove', { clientX: x, clientY: y, bubbles: true }));
    const tip = figure.querySelector('.tip');
    return { hidden: tip.hidden, text: tip.textContent };
  };
  return { on: point(at.x + 4, at.y + 4), off: point(at.x + 200, at.y - 300) };
};

const tasks = { tips, looks, fits, keys, wheel, play, save, scale, colours, print };
addEventListener('load', async () => {
  try {
    seen.viewer = !viewer.hidden;
    seen.sentence = !document.getElementById('viewer-still').hidden;
    if (narrow) document.body.style.width = '352px';
    await wait(100);
    seen.found = await tasks[task]();
  } catch (error) {
    seen.errors.push(error.stack);
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

const std::string with_webgl = "--use-angle=swiftshader --enable-unsafe-swiftshader ";

/// The probe's findings for a task on the report, which must show no error and write nothing to the console.
/// @param narrow  the page is as wide as a telephone's, which a window of Chromium cannot be
Json visit(const std::string& task, const std::string& flags, bool narrow = false) {
  const testing::Sides sides = testing::pressed(5, 600);
  std::string html = testing::report_of(sides);
  const std::string asked = "const task = '" + task + "', narrow = " + (narrow ? "true" : "false");
  html.insert(html.rfind("</body>"), "<script>" + asked + ";</script>\n" + probe);
  const testing::TemporaryFolder folder;
  const std::string at = folder.path().string();
  scene::write_file(folder.path() / "report.html", html);
  const std::string dom = output_of("HOME='" + at +
                                    "' chromium --headless=new --no-sandbox --disable-dev-shm-usage "
                                    "--enable-logging=stderr --window-size=1400,1000 --virtual-time-budget=60000 " +
                                    flags + "--user-data-dir='" + at + "/profile' --dump-dom 'file://" + at +
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

constexpr const char* still = "Error, on the reference's shape";

/// With the three-dimensional view, drawn in software.
Json in_space(const std::string& task, bool narrow = false, const std::string& flags = "") {
  const Json page = visit(task, with_webgl + flags, narrow);
  EXPECT_EQ(page["viewer"], true);
  EXPECT_EQ(page["sentence"], false);
  return page["found"];
}

TEST(ReportInChromium, ShowsBothBodiesAndFollowsTheSlider) {
  const Json looks = in_space("looks");
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

/// Values of one vertex.
Eigen::Vector3d column(const Json& values, Eigen::Index vertex) {
  const auto first = static_cast<std::size_t>(3 * vertex);
  const auto at = [&](std::size_t axis) { return values.at(first + axis).get<double>(); };
  return {at(0), at(1), at(2)};
}

TEST(ReportInChromium, MovesAndColoursEveryVertex) {
  const Json looks = in_space("looks");
  const testing::Sides sides = testing::pressed(5, 600);
  const Eigen::Matrix3Xd& fast_m = sides.run.instants[4].displacement_m;
  const Eigen::VectorXd error_m = (fast_m - sides.result.instants[4].displacement_m).colwise().norm().transpose();
  const Json &last = looks["last"], &error = looks["error"];
  ASSERT_EQ(last["points"].size(), static_cast<std::size_t>(fast_m.size()));
  Eigen::Index most = 0, least = 0;
  error_m.maxCoeff(&most);
  error_m.minCoeff(&least);
  ASSERT_LT(error_m[least], 0.01 * error_m[most]);
  for (Eigen::Index i = 0; i < fast_m.cols(); ++i) {
    EXPECT_LT((column(last["points"], i) - sides.run.surface.points_m.col(i) - fast_m.col(i)).norm(), 1e-7) << i;
    EXPECT_EQ(column(error["points"], i), column(last["points"], i)) << i;
    // Magma reversed: light without error, darker for larger errors.
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

/// Inside its picture, not at the edge, and not small.
void expect_fits(const Json& side, const std::string& what) {
  const double left = side["left"], right = side["right"], top = side["top"], bottom = side["bottom"];
  EXPECT_GT(left, 0.01) << what;
  EXPECT_LT(right, 0.99) << what;
  EXPECT_GT(top, 0.01) << what;
  EXPECT_LT(bottom, 0.99) << what;
  EXPECT_GT(std::max(right - left, bottom - top), 0.65) << what;
}

TEST(ReportInChromium, FitsTheBodiesAtEveryWidth) {
  for (const bool narrow : {false, true}) {
    const Json fits = in_space("fits", narrow);
    ASSERT_EQ(fits["both"].size(), 2u);
    ASSERT_EQ(fits["alone"].size(), 1u);
    for (const Json& side : fits["both"]) expect_fits(side, narrow ? "narrow" : "wide");
    expect_fits(fits["alone"][0], narrow ? "narrow, alone" : "wide, alone");
    // One above the other if there is no space side by side.
    EXPECT_EQ(fits["both"][0]["size"][0] == fits["alone"][0]["size"][0], narrow);
  }
}

double distance(const Json& a, const Json& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) sum += std::pow(a.at(i).get<double>() - b.at(i).get<double>(), 2);
  return std::sqrt(sum);
}

TEST(ReportInChromium, KeysTurnBothBodiesWhileThePictureHasTheFocus) {
  const Json keys = in_space("keys");
  const Json& before = keys["before"];
  EXPECT_FALSE(keys["elsewhere"]["taken"]);
  EXPECT_EQ(keys["elsewhere"]["place"], before["place"]);
  for (const char* name : {"ArrowLeft", "ArrowRight", "ArrowUp"}) {
    EXPECT_TRUE(keys[name]["taken"]) << name;
    EXPECT_GT(distance(keys[name]["place"], before["place"]), 0.05) << name;
    for (const std::size_t side : {0u, 1u}) {
      EXPECT_NE(keys[name]["sides"][side]["mark"], before["sides"][side]["mark"]) << name << " side " << side;
    }
  }
  // Right and left of the start; up and down cancel.
  EXPECT_GT(distance(keys["ArrowLeft"]["place"], keys["ArrowRight"]["place"]),
            1.5 * distance(keys["ArrowLeft"]["place"], before["place"]));
  EXPECT_LT(distance(keys["ArrowDown"]["place"], keys["ArrowRight"]["place"]), 1e-6);
  EXPECT_LT(keys["+"]["zoom"].get<double>(), 0.95 * before["zoom"].get<double>());
  EXPECT_NEAR(keys["-"]["zoom"].get<double>(), before["zoom"].get<double>(), 1e-9);
  EXPECT_FALSE(keys["x"]["taken"]) << "a key without a meaning is the page's";
  EXPECT_TRUE(keys["letter"]) << "a letter of vtk.js changed the picture";
  EXPECT_LT(distance(keys["Home"]["place"], before["place"]), 1e-9);
  EXPECT_EQ(keys["Home"]["sides"], before["sides"]);
  EXPECT_TRUE(keys["left"]) << "Esc does not leave the picture";
}

TEST(ReportInChromium, WheelZoomsOnlyWhileThePictureHasTheFocus) {
  const Json wheel = in_space("wheel");
  for (const char* when : {"before", "after"}) {
    EXPECT_FALSE(wheel[when]["taken"]) << when << ": the page cannot be scrolled past the picture";
    EXPECT_EQ(wheel[when]["touch"], "pan-y") << when;
  }
  EXPECT_TRUE(wheel["focused"]["taken"]);
  EXPECT_EQ(wheel["focused"]["touch"], "none");
  EXPECT_NE(wheel["focused"]["zoom"], wheel["before"]["zoom"]);
  EXPECT_EQ(wheel["after"]["zoom"], wheel["focused"]["zoom"]);
}

TEST(ReportInChromium, PlaysPausesAndStopsAtTheEnd) {
  const Json play = in_space("play");
  EXPECT_EQ(play["first"], Json({{"button", "Play"}, {"instant", 0}}));
  EXPECT_EQ(play["started"], Json({{"button", "Pause"}, {"instant", 0}})) << "the space bar does not play";
  EXPECT_EQ(play["going"]["button"], "Pause");
  EXPECT_GT(play["going"]["instant"], 0);
  EXPECT_LT(play["going"]["instant"], 4);
  EXPECT_EQ(play["paused"], Json({{"button", "Play"}, {"instant", play["going"]["instant"]}}));
  EXPECT_EQ(play["still"], play["paused"]);
  EXPECT_EQ(play["ended"], Json({{"button", "Play"}, {"instant", 4}}));
  EXPECT_EQ(play["again"], Json({{"button", "Pause"}, {"instant", 0}}));
}

TEST(ReportInChromium, SavesThePictureWithItsColourBar) {
  const Json saved = in_space("save");
  EXPECT_EQ(saved["type"], "data:image/png;base64,");
  EXPECT_THAT(saved["name"].get<std::string>(), ::testing::MatchesRegex("bodies-at-.*s\\.png"));
  // The canvas may be a fraction of a pixel wider than the number it reports.
  EXPECT_NEAR(saved["size"][0].get<int>(), 2 * saved["canvas"][0].get<int>(), 1);
  EXPECT_GT(saved["size"][1], 2 * saved["canvas"][1].get<int>());
  EXPECT_GT(saved["picture_colours"], 50);
  EXPECT_GT(saved["bar_colours"], 50);
  EXPECT_TRUE(saved["unchanged"]) << "the page shows another picture after saving";
}

TEST(ReportInChromium, DrawsAScaleThatIsTrue) {
  const Json scale = in_space("scale");
  const std::string text = scale["text"];
  const double length_mm = std::stod(text.substr(text.rfind(" of ") + 4));
  EXPECT_THAT(text, ::testing::EndsWith(" mm")) << text;
  // The cube's width as seen from 24 degrees beside its front.
  const double angle = 24.0 * std::numbers::pi / 180.0, width_mm = 60.0 * (std::cos(angle) + std::sin(angle));
  EXPECT_NEAR(scale["body_px"].get<double>() / scale["length_px"].get<double>() * length_mm, width_mm, 0.03 * width_mm);
}

/// Contrast ratio of two colours as WCAG defines it, 1 to 21.
double contrast(const Json& a, const Json& b) {
  const auto luminance = [](const Json& colour) {
    constexpr double weights[] = {0.2126, 0.7152, 0.0722};
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = colour.at(i).get<double>() / 255.0;
      sum += weights[i] * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    return sum + 0.05;
  };
  return std::max(luminance(a) / luminance(b), luminance(b) / luminance(a));
}

TEST(ReportInChromium, IsLegibleOnLightAndDarkPages) {
  for (const bool dark : {false, true}) {
    const Json colours = in_space("colours", false, dark ? "--force-dark-mode " : "");
    ASSERT_EQ(colours["dark"], dark);
    for (const char* text : {"words", "bar", "keys", "numbers"}) {
      EXPECT_GT(contrast(colours[text], colours["panel"]), 4.5) << text << (dark ? " dark" : " light");
    }
    EXPECT_GT(contrast(colours["marks"], colours["stage"]), 4.5) << (dark ? " dark" : " light");
    for (const Json& name : colours["names"]) EXPECT_GT(contrast(name, colours["panel"]), 3.0);
    // A body in the colour of either end of a scale contrasts with the background, the dark end above all.
    for (const Json& ends : colours["maps"]) {
      for (const Json& end : ends) EXPECT_GT(contrast(end, colours["stage"]), 1.25) << end << colours["stage"];
      EXPECT_GT(std::max(contrast(ends[0], colours["stage"]), contrast(ends[1], colours["stage"])), 4.5);
    }
  }
}

TEST(ReportInChromium, LeavesPaperToTheStillPicture) {
  const Json print = in_space("print");
  EXPECT_FALSE(print["viewer"]);
  EXPECT_FALSE(print["sentence"]);
  EXPECT_THAT(print["headings"].get<std::vector<std::string>>(),
              ::testing::Not(::testing::Contains("Both bodies in space")));
  // A folded section would be a heading without content.
  EXPECT_THAT(print["headings"].get<std::vector<std::string>>(),
              ::testing::AllOf(::testing::Contains("Why"), ::testing::Not(::testing::Contains("All figures"))));
  EXPECT_THAT(print["stills"].get<std::vector<std::string>>(), ::testing::Contains(still));
}

TEST(ReportInChromium, LeavesTheStillPictureWithoutWebGl) {
  const Json page = visit("print", "--disable-3d-apis --disable-gpu ");
  EXPECT_FALSE(page["viewer"]);
  EXPECT_TRUE(page["sentence"]);
  EXPECT_THAT(page["found"]["stills"].get<std::vector<std::string>>(), ::testing::Contains(still));
}

TEST(ReportInChromium, ShowsValuesBesideThePointer) {
  const Json tips = in_space("tips");
  EXPECT_FALSE(tips["on"]["hidden"]);
  EXPECT_THAT(tips["on"]["text"].get<std::string>(),
              ::testing::AllOf(::testing::HasSubstr("reference | depth [mm]: 0; force on the tool [N]: 0"),
                               ::testing::HasSubstr("fast model | depth [mm]: 0; force on the tool [N]: 0")));
  EXPECT_TRUE(tips["off"]["hidden"]);
}

}  // namespace
}  // namespace touchstone::compare
